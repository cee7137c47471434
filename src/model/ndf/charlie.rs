//! Charlie, for cloth: Estevez & Kulla 2017, *Production Friendly Microfacet Sheen BRDF*, eq. 2; the lobe of glTF's
//! KHR_materials_sheen. Twin of `shaders/ndf/charlie.wgsl`.
//!
//! ```text
//! D = (2 + 1/α) sin^(1/α) θm / 2π,   Λ = exp(L(μ)) for μ < 1/2, else exp(2 L(1/2) − L(1 − μ))
//! L(x) = a/(1 + b x^c) + d x + e,   a … e between those of α = 0 and α = 1 by (1 − α)²
//! ```
//!
//! | parameter | range | unit | default | |
//! |---|---|---|---|---|
//! | `alpha` | [0, 1] | – | none | or `roughness`, alpha = roughness²; at least 1/200 |
//!
//! The normals of fibres on end: dark in the middle, a rim of light at grazing, the thinner the smaller α. Λ is the paper's
//! fit, and so is smith-correlated here, which is glTF's `V`; its softer terminator (eq. 5) is left out, as glTF does, and so
//! is glTF's clamp of V at 1.
//!
//! α → 0 is no mirror: all normals lie down, and D is a spike of (2 + 1/α)/2π at the horizon. What renderers do is done
//! here: α is taken as [`ALPHA_LEAST`] below it, which is a roughness of 0.07.
//!
//! Kept: finite, not negative, reciprocal. Broken: energy, as the fit is not Smith's Λ of D: ρ_dh at θi = 88° is 2.9
//! at α = 1/200, 1.3 at 0.03, 0.9 at 0.1 and 0.9 at 1; where ωi grazes to 2⁻²⁴ it is 9.0, 4.0, 2.8 and 5.1. Kelemen's
//! masking and v-cavity, which know nothing of Λ, keep it. Nothing bounds it with schlick-ggx, whose k vanishes with α, and
//! with none.

use crate::base::half_angle::Half;
use crate::model::ndf::{AlbedoBounds, CountRule, Directions, Ndf, Rounding, charlie_map};
use crate::model::parameters::Setting;
use crate::model::{Shape, Term, part};
use std::f64::consts::TAU;

pub(crate) struct Charlie;

/// Below it D would be a spike at the horizon; (7/100)² in three.js, and as much in others.
pub(super) const ALPHA_LEAST: f64 = 0.005;

/// The relative error of its values in f32, in units of 2⁻²⁴: the 40 of every lobe; of D's exponent, ≤ 128 where f is above
/// 1e-30 sr⁻¹, nine roundings, four of the quotient, four of the logarithm, one of 1/α; and of Λ's: x^c has 3.4 times
/// four of c ln x, which weigh a/4 = 6.3 in L, whose sum and 21 − L, of 20 to 40, round six times.
const CHARLIE_F32: f64 = (40.0 + 9.0 * 128.0 + 86.0 + 180.0) / (1 << 24) as f64;

/// Of a direction's Λ all of an integral has the same error: its exponent, from 8 to 18, is the last of six roundings of
/// 2⁻²⁰ at most.
const FIT_F32: f64 = 6.0 / (1 << 20) as f64;

impl Ndf for Charlie {
    const TERM: Term = Term {
        name: "charlie",
        summary: "Charlie's fibres, for cloth",
        source: "Estevez & Kulla 2017, eq. 2 to 4",
        part: part!("ndf/charlie", "elementary", "ndf/smith"),
    };
    const SHAPE: Shape = Shape::SHEEN;
    /// The seam is where Λ's branches meet. Bounds are measured, where ωi grazes: at α = 1/200, but of smith-separable,
    /// whose is at 1.
    const ALBEDO: AlbedoBounds = AlbedoBounds {
        is_mirror_at_0: false,
        bounds: &[
            ("smith-correlated", 8.98),
            ("smith-separable", 2.72),
            ("schlick-ggx-direct", 16.9),
            ("ashikhmin-neubelt", 5.67),
            ("disney-clearcoat", 19.22),
        ],
        seam: Some(0.5),
        ..AlbedoBounds::CONSERVED
    };
    /// |h|² sin²θm leaves f32 below 2⁻¹²⁶, sin θm below 1e-19 of |h|: at α = 1, where D is in proportion to it, that is 1e-19
    /// in f, which is within 1e-6 of values from `faint` on.
    const F32: Rounding = Rounding {
        value: CHARLIE_F32,
        integral: crate::base::precision::INTEGRAL_F32 + FIT_F32,
        faint: Some(1e-13),
        ..Rounding::USUAL
    };
    const RULE: Option<CountRule> = Some(CountRule {
        directions: Some(Directions {
            samples: |fixed, _, [counts, _], tolerance, of_normal| {
                charlie_map::samples(fixed.mu, &fixed.kinks, counts, tolerance, of_normal)
            },
            most: |[counts, _], of_normal| charlie_map::most(counts, of_normal),
        }),
        means: Some([charlie_map::mean, charlie_map::mean_with_kinks]),
        ..CountRule::new(|_, _, tolerance| charlie_map::counts(tolerance))
    });

    fn ndf(h: &Half, hz2: f64, &Setting { alpha, .. }: &Setting) -> f64 {
        let inverse = 1.0 / alpha.max(ALPHA_LEAST);
        (2.0 + inverse) / TAU * (-0.5 * inverse * (hz2 / h.ht2).ln_1p()).exp()
    }

    fn smith_root(mu: f64, &Setting { alpha, .. }: &Setting) -> f64 {
        let t = (1.0 - alpha.max(ALPHA_LEAST)).powi(2);
        let exponent = if mu < 0.5 { fit(mu, t) } else { 2.0 * fit(0.5, t) - fit(1.0 - mu, t) };
        mu + 2.0 * mu * exponent.exp()
    }
}

/// L(x), of t = (1 − α)².
fn fit(x: f64, t: f64) -> f64 {
    let a = 21.5473 + 3.7772 * t;
    let b = 3.82987 - 0.50552 * t;
    let c = 0.19823 - 0.03022 * t;
    a / (1.0 + b * x.powf(c)) + (0.70367 * t - 1.9776) * x - (4.32054 + 0.53913 * t)
}
