//! Portsmouth, Kutz & Hill 2025, *EON: A Practical Energy-Preserving Rough Diffuse BRDF*, JCGT 14 (1),
//! listing 1 with the exact albedo. Twin of `shaders/diffuse/eon.wgsl`.
//!
//! ```text
//! f = weight · (ρ f₁ + ρₘ/π · (1 − E(μi)) (1 − E(μe))/(1 − Ē)),   f₁ Fujii's form with σ' = r
//! ρₘ = ρ² Ē/(1 − ρ (1 − Ē))
//! E(μ) = A (1 + (r/π) G(μ)),   Ē = A (1 + (2/3 − 28/(15π)) r),   A = 1/(1 + (1/2 − 2/(3π)) r)
//! G(μ) = S (θ − S μ) + 2/3 (S (1 − S³)/μ − S),   S = sin θ
//! ```
//!
//! | parameter | range | unit | default | |
//! |---|---|---|---|---|
//! | `roughness` | [0, 1] | – | none | r |
//! | `albedo` | [0, 1], or R, G, B | – | 1 | ρ of a facet |
//! | `weight` | [0, 1], or R, G, B | – | 1 | weighs A |
//!
//! What is scattered n times has the colour ρⁿ, so that f is not linear in ρ: it is a parameter, not a
//! weight, and a material of three different ρ is three lobes, one for each channel.
//!
//! r = 0 is Lambert, bit by bit. At 1 a full moon is nearly flat, and what lies in its middle brighter than
//! Fujii's; a coloured one is more saturated than its ρ.
//!
//! Kept: finite, not negative, reciprocal to the bit; energy: ρ_dh = ρ E + ρₘ (1 − E) ≤ 1, and exactly 1 at ρ
//! = 1. f has no bound where both directions graze on the same side, and at r = 1 it is 0 where both graze
//! ahead.

use crate::base::precision::VALUE_F32;
use crate::base::tolerance::decade;
use crate::model::diffuse::retro;
use crate::model::{Component, Integral, Model, Parameter, Shape, part};
use std::f64::consts::{FRAC_1_PI, PI};

pub(crate) static MODEL: Model = Model {
    name: "eon",
    summary: "energy-preserving Oren–Nayar: white reflects all, colours saturate",
    source: "Portsmouth, Kutz & Hill 2025, listing 1, exact albedo",
    microfacet: None,
    components: &[Component { name: "A", weight: "weight", default: Some(1.0) }],
    shape: Some(Shape::SHARE),
    parameters: &[Parameter {
        name: "albedo",
        summary: "rho of a facet, which light that is scattered n times takes n times",
        unit: "",
        range: [0.0, 1.0],
        default: Some(1.0),
        place: ALBEDO,
    }],
    derive: |_| {},
    rho_bound: 1.0,
    parts: &[retro::PART, part!("diffuse/eon")],
    value_f32: VALUE_F32,
    integral: Integral::Kinked(nodes),
    lobe: |p, a, s| {
        let (o, rho) = (Shape::SHARE.on_device(s.alpha), s.parameters[ALBEDO]);
        let n = 1.0 / (1.0 + ONE_PLUS_K1 * o);
        let lost = n * o * K1_MINUS_K2;
        let mean = n * (1.0 + ONE_PLUS_K2 * o);
        let rho_m = rho * rho * mean / (1.0 - rho * lost);
        let scale = rho_m * n * o * (FRAC_1_PI * FRAC_1_PI * FRAC_1_PI / K1_MINUS_K2);
        let more = scale * (lost_at(p.mu_i) * lost_at(p.mu_e));
        [rho * FRAC_1_PI * n * (1.0 + o * retro::one_plus_s_over_t(p, a)) + more, 0.0]
    },
};

const ALBEDO: usize = 0;

/// 1 + k₁, k₁ = 1/2 − 2/(3π), and 1 + k₂, k₂ = 2/3 − 28/(15π).
const ONE_PLUS_K1: f64 = 1.5 - 2.0 / 3.0 * FRAC_1_PI;
const ONE_PLUS_K2: f64 = 5.0 / 3.0 - 28.0 / 15.0 * FRAC_1_PI;
const K1_MINUS_K2: f64 = 1.2 * FRAC_1_PI - 1.0 / 6.0;

/// π k₁ − G(μ).
fn lost_at(mu: f64) -> f64 {
    let s = ((1.0 - mu) * (1.0 + mu)).sqrt();
    let y = mu / (1.0 + s);
    let y2 = y * y;
    let gamma = 2.0 * y.atan();
    (PI - 4.0 / 3.0) * y2 / (1.0 + y2) + s * gamma + s * s * mu - 2.0 / 3.0 * s * y * (1.0 + s + s * s)
}

/// Nodes in each panel of θe and of δφ for tolerances 1e-1 … 1e-10, measured (`nodes.rs`): the error of each
/// count alone, worst over θi and the roughness, is below a quarter of the tolerance.
fn nodes(tolerance: f64) -> [usize; 2] {
    const COUNTS: [[usize; 2]; 10] =
        [[3, 1], [4, 2], [4, 3], [5, 3], [6, 3], [6, 4], [7, 4], [8, 5], [8, 5], [9, 5]];
    COUNTS[decade(tolerance)]
}
