//! Oren & Nayar 1994, *Generalization of Lambert's Reflectance Model* (SIGGRAPH 94), the qualitative model, as
//! Fujii and Portsmouth et al. 2025 quote it. Twin of `shaders/diffuse/oren_nayar.wgsl`.
//!
//! ```text
//! f = albedo/π · (A + B max(0, cos(φi − φe)) sin α tan β),   α = max(θi, θe),  β = min(θi, θe)
//! A = 1 − 0.5 σ²/(σ² + 0.33),   B = 0.45 σ²/(σ² + 0.09)
//! ```
//!
//! | parameter | range | unit | default | |
//! |---|---|---|---|---|
//! | `roughness`, or `sigma` | [0, 1]; [0, π/2] | –; rad | none | σ = π/2 · roughness, of the facets' slope angle |
//! | `albedo` | [0, 1] | – | none | of a facet, weighs A |
//!
//! σ = 0 is Lambert, bit by bit. At π/2 a full moon is nearly flat, 0.43 at the rim and 0.56 in the middle
//! where Lambert's has 0 and 1; lit from aside, it shows a ring where B's term begins.
//!
//! Kept: finite, not negative, reciprocal to the bit. f itself has no bound where both directions graze on
//! the same side (tan β), its integrals have. Broken: energy. For small σ, A
//! falls slower than B grows: where ωi grazes, ρ_dh = A + B/2, which is 1.0152 at σ = 0.200, the largest, and
//! below 1 from σ = 0.33 on. For the rest of the range it loses, up to 44 %.

use crate::base::precision::VALUE_F32;
use crate::base::tolerance::decade;
use crate::model::diffuse::retro;
use crate::model::{Component, Integral, Model, Shape, part};
use std::f64::consts::FRAC_1_PI;

pub(crate) static MODEL: Model = Model {
    name: "oren-nayar",
    summary: "rough diffuse as published: Lambertian V-cavities, without what they scatter twice",
    source: "Oren & Nayar 1994, qualitative model",
    microfacet: None,
    components: &Component::DIFFUSE,
    shape: Some(Shape::SIGMA),
    parameters: &[],
    derive: |_| {},
    rho_bound: 1.0152,
    parts: &[retro::PART, part!("diffuse/oren_nayar")],
    value_f32: VALUE_F32,
    integral: Integral::Kinked(nodes),
    lobe: |p, a, s| {
        let s2 = s.alpha * s.alpha;
        let (a_term, b_term) = (1.0 - 0.5 * s2 / (s2 + 0.33), 0.45 * s2 / (s2 + 0.09));
        [FRAC_1_PI * (a_term + b_term * retro::retro(p, a)), 0.0]
    },
};

/// Nodes in each panel of θe and of δφ for tolerances 1e-1 … 1e-10, measured (`nodes.rs`): the error of each
/// count alone, worst over θi and the roughness, is below a quarter of the tolerance.
fn nodes(tolerance: f64) -> [usize; 2] {
    const COUNTS: [[usize; 2]; 10] =
        [[3, 1], [3, 2], [4, 3], [4, 3], [5, 3], [5, 4], [6, 4], [6, 5], [7, 5], [7, 5]];
    COUNTS[decade(tolerance)]
}
