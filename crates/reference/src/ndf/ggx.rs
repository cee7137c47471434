//! GGX: the normals of an ellipsoid.

use crate::ndf::Ndf;
use crate::setting::Parameters;
use std::f64::consts::PI;

/// Trowbridge & Reitz 1975; Walter et al. 2007.
pub(crate) struct Ggx;

impl Ndf for Ggx {
    /// Walter et al. 2007, eq. 33: D = α² / (π cos⁴θm (α² + tan²θm)²).
    fn d(&self, cos2_m: f64, tan2_m: f64, alpha: f64, _: &Parameters) -> f64 {
        let alpha2 = alpha * alpha;
        alpha2 / (PI * (cos2_m * (alpha2 + tan2_m)).powi(2))
    }

    /// Heitz 2014, eq. 72: Λ = (−1 + √(1 + α² tan²θ)) / 2.
    fn lambda(&self, tan2: f64, alpha: f64, _: &Parameters) -> f64 {
        0.5 * ((1.0 + alpha * alpha * tan2).sqrt() - 1.0)
    }
}
