//! Beckmann: normally distributed slopes.

use crate::ndf::Ndf;
use crate::setting::Parameters;
use libm::erf;
use std::f64::consts::PI;

/// Beckmann & Spizzichino 1963; Walter et al. 2007.
pub(crate) struct Beckmann;

impl Ndf for Beckmann {
    /// Walter et al. 2007, eq. 25: D = exp(−tan²θm/α²) / (π α² cos⁴θm).
    fn d(&self, cos2_m: f64, tan2_m: f64, alpha: f64, _: &Parameters) -> f64 {
        let alpha2 = alpha * alpha;
        (-tan2_m / alpha2).exp() / (PI * alpha2 * cos2_m * cos2_m)
    }

    /// Heitz 2014, eq. 67: Λ = (erf(a) − 1)/2 + exp(−a²) / (2 a √π), a = 1 / (α tan θ).
    fn lambda(&self, tan2: f64, alpha: f64, _: &Parameters) -> f64 {
        let a = 1.0 / (alpha * tan2.sqrt());
        0.5 * (erf(a) - 1.0) + (-a * a).exp() / (2.0 * a * PI.sqrt())
    }
}
