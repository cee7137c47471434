//! A reflectance that is the same at every angle.

use crate::model::parameters::Setting;
use crate::reference::fresnel::Fresnel;

/// F = F0.
pub(crate) struct Constant;

impl Fresnel for Constant {
    fn weights(&self, _cos_d: f64, _one_minus_cos_d: f64, _: &Setting) -> [f64; 2] {
        [1.0, 0.0]
    }

    fn mean(&self, _: &Setting) -> [f64; 2] {
        [1.0, 0.0]
    }
}
