//! A reflectance that is the same at every angle.

use crate::fresnel::Fresnel;
use crate::setting::Parameters;

/// F = F0.
pub(crate) struct Constant;

impl Fresnel for Constant {
    fn weights(&self, _cos_d: f64, _one_minus_cos_d: f64, _: &Parameters) -> [f64; 2] {
        [1.0, 0.0]
    }

    fn mean(&self, _: &Parameters) -> [f64; 2] {
        [1.0, 0.0]
    }
}
