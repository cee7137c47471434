//! Blinn's Phong as a distribution of normals: Blinn 1977; Walter et al. 2007, eq. 30. Twin of
//! `shaders/ndf/blinn_phong.wgsl`.
//!
//! ```text
//! D = (p + 2)/2π cos^p θm,   p = 2/α² − 2
//! ```
//!
//! | parameter | range | unit | default | |
//! |---|---|---|---|---|
//! | `alpha` | (0, 1] | – | none | or `roughness`, alpha = roughness²; 1 is D = 1/π |
//!
//! Nearly Beckmann, which it becomes as α → 0. Smith's Λ is Beckmann's with the same α, as Walter et al. take it (section
//! 5.2): there is no closed form of its own. α → 0 is the mirror.
//!
//! Kept: finite, not negative, reciprocal. Broken where rough: energy with Smith's maskings, as Λ is another's: ρ_dh reaches √π at
//! α = 1 where ωi grazes, the most there is, 1.25 at α = 0.7, 1.03 at 0.3.

use crate::base::half_angle::Half;
use crate::model::ndf::beckmann::{self, Beckmann};
use crate::model::ndf::{AlbedoBounds, Coordinate, CountRule, MappedSlope, Maps, Ndf, Rounding};
use crate::model::parameters::Setting;
use crate::model::{SlopeCounts, Term, part};
use std::f64::consts::FRAC_1_PI;

pub(crate) struct BlinnPhong;

/// The relative error of its values in f32, in units of 2⁻²⁴: the 40 of every lobe, and of the exponent eleven
/// roundings, four of its quotient, four of the logarithm, three of p; it is ≤ 128 where f is above 1e-30 sr⁻¹.
const BLINN_PHONG_F32: f64 = (40.0 + 11.0 * 128.0) / (1 << 24) as f64;

impl Ndf for BlinnPhong {
    const TERM: Term = Term {
        name: "blinn-phong",
        summary: "Blinn–Phong microfacets, Beckmann's Λ",
        source: "Walter et al. 2007, eq. 20 and 30",
        part: part!("ndf/blinn_phong", "elementary", "ndf/smith_of_beckmann", "ndf/smith"),
    };
    const F32: Rounding = Rounding { value: BLINN_PHONG_F32, ..Rounding::USUAL };
    /// √π, and measured; of α = 1 at grazing.
    const ALBEDO: AlbedoBounds = AlbedoBounds {
        bounds: &[("smith-correlated", 1.7725), ("smith-separable", 1.345), ("disney-clearcoat", 3.438)],
        ..AlbedoBounds::CONSERVED
    };
    const MAPS: Option<Maps> = Some(Maps {
        coarse: Coordinate { end: |t_max, s| end(t_max, 4.3, s), map },
        fine: Coordinate { end: |t_max, s| end(t_max, 5.5, s), map },
    });
    /// Beckmann's, and two nodes more for the tail of α near 1: measured from α = 1e-6 on, each count alone leaves less than
    /// a third of the tolerance.
    const RULE: Option<CountRule> = Some(CountRule::new(|_, _, tolerance| {
        let counts = beckmann::counts(tolerance);
        [SlopeCounts { nodes: counts.nodes + 2, ..counts }; 2]
    }));

    fn ndf(h: &Half, hz2: f64, &Setting { alpha, .. }: &Setting) -> f64 {
        let exponent = (1.0 - alpha) * (1.0 + alpha) / (alpha * alpha);
        FRAC_1_PI / (alpha * alpha) * (-exponent * (h.ht2 / hz2).ln_1p()).exp()
    }

    fn smith_root(mu: f64, s: &Setting) -> f64 {
        Beckmann::smith_root(mu, s)
    }
}

/// cos²θm = exp(−α² r²), so that D cos θm dωm = 2r e^(−r²) dr dφ/2π, as Beckmann's.
fn map(r: f64, &Setting { alpha, .. }: &Setting) -> MappedSlope {
    MappedSlope { p: (alpha * r).powi(2).exp_m1().sqrt(), m: 1.0, weight: 2.0 * r * (-r * r).exp() }
}

/// r at which tan θm reaches `t_max`, or beyond which e^(−most²) is left of the weight: of e^(−r²), which G2 and
/// (ωe·ωm)/μe may weigh with tan θm ≤ e^(α² r²/2).
fn end(t_max: f64, most: f64, &Setting { alpha, .. }: &Setting) -> f64 {
    let horizon = (t_max * t_max).ln_1p().sqrt() / alpha;
    horizon.min(most / (1.0 - 0.5 * alpha * alpha).sqrt())
}
