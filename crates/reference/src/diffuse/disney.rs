//! What Disney's principled BRDF adds to its diffuse and specular lobes.

use crate::directions::Pair;
use crate::measure::Measure;
use crate::setting::Setting;
use crate::{Angles, Reference, definition};
use std::f64::consts::FRAC_1_PI;

/// Burley 2012, *Physically-Based Shading at Disney*, after Hanrahan & Krueger 1993; `ss` of `disney.brdf`:
/// A = 1.25 (Fss (1/(μi + μe) − 0.5) + 0.5)/π, Fss = (1 + (Fss90 − 1) FL)(1 + (Fss90 − 1) FV), Fss90 = cos² θd roughness, with
/// Schlick's FL and FV of the cosines.
pub static DISNEY_SUBSURFACE: &dyn Reference = &Subsurface;

/// Its sheen, `FH` of `disney.brdf`: A = (1 − cos θd)⁵, cos θd = ωi·ωm.
pub static DISNEY_SHEEN: &dyn Reference = &Sheen;

struct Subsurface;
struct Sheen;

impl Reference for Subsurface {
    fn measure(&self) -> Measure {
        Measure::Roughness
    }

    fn brdf(&self, angles: &Angles, setting: &Setting) -> Option<[f64; 2]> {
        let pair = Pair::new(angles);
        let fss90 = pair.cos_d.powi(2) * setting.alpha;
        let mix = |mu: f64| 1.0 + (fss90 - 1.0) * (1.0 - mu).powi(5);
        let fss = mix(pair.mu_i) * mix(pair.mu_e);
        Some([FRAC_1_PI * 1.25 * (fss * (1.0 / (pair.mu_i + pair.mu_e) - 0.5) + 0.5), 0.0])
    }

    fn rho_dh(&self, mu: f64, setting: &Setting) -> [f64; 2] {
        definition::rho_dh(|angles| self.brdf(angles, setting).unwrap_or([f64::NAN; 2]), mu, setting)
    }
}

impl Reference for Sheen {
    fn brdf(&self, angles: &Angles, _: &Setting) -> Option<[f64; 2]> {
        Some([Pair::new(angles).one_minus_cos_d.powi(5), 0.0])
    }

    fn rho_dh(&self, mu: f64, setting: &Setting) -> [f64; 2] {
        definition::rho_dh(|angles| self.brdf(angles, setting).unwrap_or([f64::NAN; 2]), mu, setting)
    }
}
