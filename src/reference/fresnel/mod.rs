//! Fresnel terms F = F0 (1 − Fc) + F90 Fc.

pub(super) mod none;
pub(super) mod schlick;

use crate::setting::Setting;

/// A Fresnel term by what F0 and F90 weigh.
pub(crate) trait Fresnel: Sync {
    /// [1 − Fc, Fc] at ωi·ωm and 1 − ωi·ωm, both given.
    fn weights(&self, cos_d: f64, one_minus_cos_d: f64, setting: &Setting) -> [f64; 2];

    /// Their mean over directions, of a mirror: 2 ∫ weights(μ) μ dμ.
    fn mean(&self, setting: &Setting) -> [f64; 2];
}
