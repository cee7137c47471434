//! Classic lobes: of the half vector, and about an axis.

pub(crate) mod ashikhmin_shirley;
mod axis;
pub(crate) mod blinn;
pub(crate) mod lafortune;
mod normals;
pub(crate) mod phong;
pub(crate) mod ward;
pub(crate) mod ward_dur;

use crate::directions::{MIN_MU, Pair};
use crate::measure::Measure;
use crate::setting::Setting;
use crate::{Angles, Reference, definition};

/// A lobe about the normal, as a function of the half vector.
pub(crate) struct Classic {
    /// The components at a pair of directions and a roughness α > 0.
    value: fn(&Pair, f64) -> [f64; 2],
    /// ρ_dh(μ) of what α → 0 tends to.
    smooth: fn(f64) -> [f64; 2],
}

/// The absolute error that ρ_dh reaches.
const FINEST: f64 = 1e-11;

impl Reference for Classic {
    fn measure(&self) -> Measure {
        Measure::ALPHA
    }

    fn brdf(&self, angles: &Angles, setting: &Setting) -> Option<[f64; 2]> {
        (setting.alpha != 0.0).then(|| (self.value)(&Pair::new(angles), setting.alpha))
    }

    fn rho_dh(&self, mu: f64, setting: &Setting) -> [f64; 2] {
        self.rho_dh_within(setting.tolerance(FINEST), mu, setting.alpha)
    }

    fn rho_hh(&self, setting: &Setting) -> [f64; 2] {
        let alpha = setting.alpha;
        definition::rho_hh(setting, alpha, |mu, tolerance| self.rho_dh_within(tolerance, mu, alpha))
    }
}

impl Classic {
    fn rho_dh_within(&self, tolerance: f64, mu: f64, alpha: f64) -> [f64; 2] {
        if alpha == 0.0 {
            return (self.smooth)(mu.clamp(MIN_MU, 1.0));
        }
        normals::rho_dh(|pair| (self.value)(pair, alpha), tolerance, mu, alpha)
    }
}
