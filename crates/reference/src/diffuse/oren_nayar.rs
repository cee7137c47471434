//! Lambertian V-cavities.

use crate::diffuse::sines;
use crate::directions::Pair;
use crate::measure::Measure;
use crate::setting::Setting;
use crate::{Angles, Reference, definition};
use std::f64::consts::FRAC_1_PI;

/// Oren & Nayar 1994, *Generalization of Lambert's Reflectance Model*, the qualitative model, in which what
/// facets scatter twice is left out:
///
/// A = (A₀ + B₀ max(0, cos(φe − φi)) sin α tan β)/π, α = max(θi, θe), β = min(θi, θe),
/// A₀ = 1 − 0.5 σ²/(σ² + 0.33), B₀ = 0.45 σ²/(σ² + 0.09), σ in rad.
pub static OREN_NAYAR: &dyn Reference = &OrenNayar;

struct OrenNayar;

impl Reference for OrenNayar {
    fn measure(&self) -> Measure {
        Measure::Sigma
    }

    fn brdf(&self, angles: &Angles, setting: &Setting) -> Option<[f64; 2]> {
        Some(value(angles, setting.alpha))
    }

    fn rho_dh(&self, mu: f64, setting: &Setting) -> [f64; 2] {
        definition::rho_dh_kinked(|angles| value(angles, setting.alpha), mu, setting)
    }
}

pub(super) fn value(angles: &Angles, sigma: f64) -> [f64; 2] {
    let pair = Pair::new(angles);
    let [s_i, s_e] = sines(&pair);
    let (sin_alpha, tan_beta) = (s_i.max(s_e), pair.tan2_i.min(pair.tan2_e).sqrt());
    let sigma2 = sigma * sigma;
    let a = 1.0 - 0.5 * sigma2 / (sigma2 + 0.33);
    let b = 0.45 * sigma2 / (sigma2 + 0.09);
    // φe − φi = δ + π.
    let cos_phi = -angles.delta_phi.cos();
    [FRAC_1_PI * (a + b * cos_phi.max(0.0) * sin_alpha * tan_beta), 0.0]
}
