//! Yasuhiro Fujii's form of Oren–Nayar, *A tiny improvement of Oren-Nayar reflectance model*
//! (mimosa-pudica.net/improved-oren-nayar.html). Twin of `shaders/diffuse/fujii.wgsl`.
//!
//! ```text
//! f = albedo/π · (1 + σ' s/t)/(1 + (1/2 − 2/(3π)) σ')
//! s = ωi·ωe − μi μe,   t = 1 where s ≤ 0, else max(μi, μe)
//! ```
//!
//! Of the two pairs of A and B that the page gives this is the second, in which σ' is the share of the
//! non-diffuse term: A = 1/(π + (π/2 − 2/3) σ'), B = σ' A. The first is fitted to the full Oren–Nayar and
//! gains energy.
//!
//! | parameter | range | unit | default | |
//! |---|---|---|---|---|
//! | `roughness` | [0, 1] | – | none | σ' |
//! | `albedo` | [0, 1] | – | none | of a facet, weighs A |
//!
//! σ' = 0 is Lambert, bit by bit. At 1 a full moon is flat and 22 % darker, without the ring that
//! Oren–Nayar's has: the term goes on below 0 where ωe is ahead.
//!
//! Kept: finite, not negative, reciprocal to the bit; energy: ρ_dh ≤ 1, which it is where ωi grazes, whatever
//! σ'. f has no bound where both directions graze on the same side, and at σ' = 1 it is 0 where both graze
//! ahead.

use crate::base::precision::VALUE_F32;
use crate::base::tolerance::decade;
use crate::model::diffuse::retro;
use crate::model::{Component, Integral, Model, Shape, part};
use std::f64::consts::FRAC_1_PI;

pub(crate) static MODEL: Model = Model {
    name: "fujii",
    summary: "Fujii's form of Oren–Nayar: no dark rings, no gain",
    source: "Fujii, A tiny improvement of Oren-Nayar reflectance model, the second pair of A and B",
    microfacet: None,
    components: &Component::DIFFUSE,
    shape: Some(Shape::SHARE),
    parameters: &[],
    derive: |_| {},
    rho_bound: 1.0,
    parts: &[retro::PART, part!("diffuse/fujii")],
    value_f32: VALUE_F32,
    integral: Integral::Kinked(nodes),
    lobe: |p, a, s| {
        let o = Shape::SHARE.on_device(s.alpha);
        [FRAC_1_PI / (1.0 + ONE_PLUS_K * o) * (1.0 + o * retro::one_plus_s_over_t(p, a)), 0.0]
    },
};

/// 1 + k, k = 1/2 − 2/(3π).
const ONE_PLUS_K: f64 = 1.5 - 2.0 / 3.0 * FRAC_1_PI;

/// Nodes in each panel of θe and of δφ for tolerances 1e-1 … 1e-10, measured (`nodes.rs`): the error of each
/// count alone, worst over θi and the roughness, is below a quarter of the tolerance.
fn nodes(tolerance: f64) -> [usize; 2] {
    const COUNTS: [[usize; 2]; 10] =
        [[3, 1], [3, 2], [4, 3], [4, 3], [5, 3], [5, 4], [6, 4], [7, 5], [7, 5], [7, 5]];
    COUNTS[decade(tolerance)]
}
