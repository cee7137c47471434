//! Schlick's approximation of the Fresnel reflectance.

use crate::fresnel::Fresnel;
use crate::setting::Parameters;

/// Schlick 1994, eq. 15: F = F0 + (1 − F0) Fc with Fc = (1 − ωi·ωm)⁵.
pub(crate) struct Schlick;

impl Fresnel for Schlick {
    fn weights(&self, cos_d: f64, one_minus_cos_d: f64, _: &Parameters) -> [f64; 2] {
        weights(cos_d, one_minus_cos_d)
    }

    /// 2 ∫ (1 − μ)⁵ μ dμ = 1/21.
    fn mean(&self, _: &Parameters) -> [f64; 2] {
        [20.0 / 21.0, 1.0 / 21.0]
    }
}

/// What F0 and F90 weigh: [1 − Fc, Fc].
///
/// With c = ωi·ωm and x = 1 − c, both given: 1 − x⁵ = c (1 + x + x² + x³ + x⁴), which keeps its digits where
/// the half vector grazes.
pub(crate) fn weights(cos_d: f64, one_minus_cos_d: f64) -> [f64; 2] {
    let x = one_minus_cos_d;
    [cos_d * (1.0 + x * (1.0 + x * (1.0 + x * (1.0 + x)))), x.powi(5)]
}
