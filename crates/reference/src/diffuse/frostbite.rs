//! Disney's diffuse lobe, renormalised.

use crate::directions::Pair;
use crate::measure::Measure;
use crate::setting::Setting;
use crate::{Angles, Reference, definition};
use std::f64::consts::FRAC_1_PI;

/// Lagarde & de Rousiers 2014, *Moving Frostbite to Physically Based Rendering*, the listing of
/// Fr_DisneyDiffuse: A = c (1 + (F90 − 1)(1 − μi)⁵)(1 + (F90 − 1)(1 − μe)⁵)/π, with the linear roughness r of
/// the notes c = (1 − r) + r/1.51 (energyFactor) and F90 = r/2 (energyBias) + 2 r cos² θd.
pub static FROSTBITE: &dyn Reference = &Frostbite;

struct Frostbite;

impl Reference for Frostbite {
    fn measure(&self) -> Measure {
        Measure::Roughness
    }

    fn brdf(&self, angles: &Angles, setting: &Setting) -> Option<[f64; 2]> {
        Some(value(angles, setting.alpha))
    }

    fn rho_dh(&self, mu: f64, setting: &Setting) -> [f64; 2] {
        definition::rho_dh(|angles| value(angles, setting.alpha), mu, setting)
    }
}

fn value(angles: &Angles, roughness: f64) -> [f64; 2] {
    let pair = Pair::new(angles);
    let energy_bias = 0.5 * roughness;
    let energy_factor = (1.0 - roughness) + roughness / 1.51;
    let f90 = energy_bias + 2.0 * roughness * pair.cos_d * pair.cos_d;
    [FRAC_1_PI * energy_factor * scatter(pair.mu_i, f90) * scatter(pair.mu_e, f90), 0.0]
}

/// 1 + (F90 − 1) x⁵ = (1 − x⁵) + F90 x⁵, x = 1 − μ. At roughness 0 and μ → 0 the first bracket is all there is:
/// 1 − (1 − μ)⁵ = 5μ − 10μ² + 10μ³ − 5μ⁴ + μ⁵.
fn scatter(mu: f64, f90: f64) -> f64 {
    let rest = mu * (5.0 + mu * (-10.0 + mu * (10.0 + mu * (-5.0 + mu))));
    rest + f90 * (1.0 - mu).powi(5)
}
