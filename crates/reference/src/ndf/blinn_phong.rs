//! Blinn–Phong: a power of the cosine.

use crate::ndf::Ndf;
use crate::ndf::beckmann::Beckmann;
use crate::setting::Parameters;
use std::f64::consts::PI;

/// Blinn 1977; Walter et al. 2007.
pub(crate) struct BlinnPhong;

impl Ndf for BlinnPhong {
    /// Walter et al. 2007, eq. 30: D = (p + 2)/2π cos^p θm, with α = √(2/(p + 2)) (section 5.2); cos²θm = 1/(1 + tan²θm)
    /// by its logarithm, of which a large p needs all digits.
    fn d(&self, _cos2_m: f64, tan2_m: f64, alpha: f64, _: &Parameters) -> f64 {
        let p = 2.0 * (1.0 - alpha * alpha) / (alpha * alpha);
        (p + 2.0) / (2.0 * PI) * (-0.5 * p * tan2_m.ln_1p()).exp()
    }

    /// Beckmann's of the same α, as Walter et al. 2007, section 5.2, have it.
    fn lambda(&self, tan2: f64, alpha: f64, parameters: &Parameters) -> f64 {
        Beckmann.lambda(tan2, alpha, parameters)
    }
}
