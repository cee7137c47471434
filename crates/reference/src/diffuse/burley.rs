//! Disney's diffuse lobe.

use crate::directions::Pair;
use crate::measure::Measure;
use crate::setting::Setting;
use crate::{Angles, Reference, definition};
use std::f64::consts::FRAC_1_PI;

/// Burley 2012, *Physically-Based Shading at Disney*, section 5.3:
/// A = (1 + (F90 − 1)(1 − μi)⁵)(1 + (F90 − 1)(1 − μe)⁵)/π, F90 = 0.5 + 2 roughness cos² θd, cos θd = ωi·ωm.
pub static BURLEY: &dyn Reference = &Burley;

struct Burley;

impl Reference for Burley {
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
    let f90 = 0.5 + 2.0 * roughness * pair.cos_d * pair.cos_d;
    [FRAC_1_PI * scatter(pair.mu_i, f90) * scatter(pair.mu_e, f90), 0.0]
}

/// 1 + (F90 − 1)(1 − μ)⁵. F90 ≥ 1/2 leaves no less than a half.
fn scatter(mu: f64, f90: f64) -> f64 {
    1.0 + (f90 - 1.0) * (1.0 - mu).powi(5)
}
