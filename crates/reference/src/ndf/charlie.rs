//! Charlie: fibres that stand on end.

use crate::ndf::Ndf;
use crate::setting::Parameters;
use std::f64::consts::PI;

/// Estevez & Kulla 2017, *Production Friendly Microfacet Sheen BRDF*; glTF's KHR_materials_sheen.
pub(crate) struct Charlie;

/// Renderers keep sheen roughness at 0.07 or more, that D be no spike at the horizon.
const LEAST: f64 = 1.0 / 200.0;

impl Ndf for Charlie {
    /// Eq. 2: D = (2 + 1/r) sin^(1/r) θm / 2π, with r = α.
    fn d(&self, cos2_m: f64, tan2_m: f64, alpha: f64, _: &Parameters) -> f64 {
        let inverse = 1.0 / alpha.max(LEAST);
        // sin²θm from the one that is not lost in 1.
        let log_sin2 = if tan2_m < 1.0 { (tan2_m * cos2_m).ln() } else { (-cos2_m).ln_1p() };
        (2.0 + inverse) * (0.5 * inverse * log_sin2).exp() / (2.0 * PI)
    }

    /// Eq. 3 and 4: Λ = exp(L(cos θ)) below cos θ = 0.5, exp(2 L(0.5) − L(1 − cos θ)) above, without the softer
    /// terminator of eq. 5.
    fn lambda(&self, tan2: f64, alpha: f64, _: &Parameters) -> f64 {
        let cos = 1.0 / (1.0 + tan2).sqrt();
        if cos < 0.5 {
            l(cos, alpha).exp()
        } else {
            // 1 − cos θ = sin²θ/(1 + cos θ)
            let rest = tan2 * cos * cos / (1.0 + cos);
            (2.0 * l(0.5, alpha) - l(rest, alpha)).exp()
        }
    }

    fn is_mirror_at_0(&self) -> bool {
        false
    }
}

/// L(x) = a/(1 + b x^c) + d x + e, its parameters between those of r = 0 and r = 1 (table 1) by (1 − r)².
fn l(x: f64, alpha: f64) -> f64 {
    let t = (1.0 - alpha.max(LEAST)).powi(2);
    let mix = |at_0: f64, at_1: f64| t * at_0 + (1.0 - t) * at_1;
    let a = mix(25.3245, 21.5473);
    let b = mix(3.32435, 3.82987);
    let c = mix(0.16801, 0.19823);
    let d = mix(-1.27393, -1.97760);
    let e = mix(-4.85967, -4.32054);
    a / (1.0 + b * x.powf(c)) + d * x + e
}
