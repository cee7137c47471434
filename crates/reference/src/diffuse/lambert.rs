//! The perfect diffuser.

use crate::setting::Setting;
use crate::{Angles, Reference, definition};
use std::f64::consts::FRAC_1_PI;

/// Lambert 1760: A = 1/π.
pub static LAMBERT: &dyn Reference = &Lambert;

struct Lambert;

impl Reference for Lambert {
    fn brdf(&self, _angles: &Angles, _: &Setting) -> Option<[f64; 2]> {
        Some([FRAC_1_PI, 0.0])
    }

    fn rho_dh(&self, mu: f64, setting: &Setting) -> [f64; 2] {
        definition::rho_dh(|_| [FRAC_1_PI, 0.0], mu, setting)
    }
}
