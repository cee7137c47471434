//! Beckmann: D = exp(−tan²θm/α²) / (π α² cos⁴θm) (Beckmann & Spizzichino 1963; Walter et al. 2007, eq. 25).
//! Twin of `shaders/ndf/beckmann.wgsl` and its maps.
//!
//! α is the root mean square slope times √2, in (0, 1]; α → 0 is the mirror. Its tail ends where GGX's goes on:
//! highlights have an edge. It keeps energy, reciprocity and isotropy with every masking but none. Values: D is an
//! exponential, and what rounds its exponent grows with it, up to [`BECKMANN_F32`].

use crate::base::half_angle::Half;
use crate::base::tolerance::decade;
use crate::model::ndf::stretched::Stretch;
use crate::model::ndf::{AlbedoBounds, Coordinate, CountRule, MappedSlope, Maps, Ndf, Rounding};
use crate::model::parameters::Setting;
use crate::model::{SlopeCounts, Term, part};
use libm::erf;
use std::f64::consts::{FRAC_1_PI, PI};

pub(crate) struct Beckmann;

/// The relative error of its values in f32, in units of 2⁻²⁴: the 40 of every lobe, and of the exponent
/// x = tan²θm/α² five roundings, x ≤ 128 where f is above 1e-30 sr⁻¹.
const BECKMANN_F32: f64 = (40.0 + 5.0 * 128.0) / (1 << 24) as f64;

impl Ndf for Beckmann {
    const TERM: Term = Term {
        name: "beckmann",
        summary: "Beckmann microfacets",
        source: "Walter et al. 2007, eq. 20 and 25",
        part: part!("ndf/beckmann", "elementary", "ndf/smith_of_beckmann", "ndf/smith"),
    };
    const F32: Rounding = Rounding { value: BECKMANN_F32, ..Rounding::USUAL };
    /// Measured, of α = 1 where ωi grazes.
    const ALBEDO: AlbedoBounds =
        AlbedoBounds { bounds: &[("disney-clearcoat", 2.181)], ..AlbedoBounds::CONSERVED };
    const MAPS: Option<Maps> = Some(Maps {
        coarse: Coordinate { end: |t_max, s| (t_max / s.alpha).min(4.3), map },
        fine: Coordinate { end: |t_max, s| (t_max / s.alpha).min(5.5), map },
    });
    const RULE: Option<CountRule> = Some(CountRule {
        kernels: Some([part!("ndf/beckmann_coarse"), part!("ndf/beckmann_fine")]),
        ..CountRule::new(|_, _, tolerance| [counts(tolerance); 2])
    });

    fn ndf(h: &Half, hz2: f64, &Setting { alpha, .. }: &Setting) -> f64 {
        let q = (-0.5 * h.ht2 / (alpha * alpha * hz2)).exp() * (h.h2 / (alpha * hz2));
        q * q * FRAC_1_PI
    }

    /// (1 + 2Λ) μ = μ erf a + α s e^(−a²)/√π, a = μ / (α s)
    fn smith_root(mu: f64, &Setting { alpha, .. }: &Setting) -> f64 {
        let scale = alpha * ((1.0 - mu) * (1.0 + mu)).sqrt();
        let a = mu / scale;
        mu * erf(a) + scale * (-a * a).exp() / PI.sqrt()
    }
}

/// The same for all texels and both sides, worst over α ∈ [1e-12, 1] and μ ∈ [2⁻²⁴, 1]: see the tests of
/// [`microfacet`](crate::model::microfacet).
pub(crate) fn counts(tolerance: f64) -> SlopeCounts {
    const COUNTS: [[usize; 2]; 10] =
        [[4, 5], [6, 7], [9, 10], [14, 13], [20, 17], [32, 24], [54, 40], [68, 50], [84, 62], [100, 74]];
    let [azimuths, nodes] = COUNTS[decade(tolerance)];
    SlopeCounts { azimuths, nodes }
}

impl Stretch for Beckmann {
    const STRETCHED: Term = Term {
        name: "beckmann-anisotropic",
        summary: "anisotropic Beckmann microfacets",
        source: "Walter et al. 2007, eq. 20; Heitz 2014, eq. 83 and 84",
        part: Self::TERM.part,
    };
    /// The exponent x ≤ 128 has 5.7 r roundings more.
    const ROUNDINGS: [f64; 2] = [700.0, 730.0];
    /// Of cloth's visibility half of what the facets cover as seen from the side, αx/√π, where ωi grazes.
    const BOUNDS: &'static [(&'static str, f64)] =
        &[("disney-clearcoat", 18.3), ("ashikhmin-neubelt", 2.821)];
    const COUNTS: [[usize; 2]; 10] =
        [[4, 6], [6, 8], [8, 11], [12, 20], [18, 34], [28, 72], [36, 98], [36, 98], [36, 98], [36, 98]];
}

fn map(r: f64, &Setting { alpha, .. }: &Setting) -> MappedSlope {
    MappedSlope { p: alpha * r, m: 1.0, weight: 2.0 * r * (-r * r).exp() }
}
