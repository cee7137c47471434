//! The ideal mirror: the limit of every microfacet model as α → 0.

use crate::fresnel::Fresnel;
use crate::setting::Setting;
use crate::{Angles, Reference};

/// f = F δ(θi − θe) δ(δφ) / (cos θi sin θi) with any Fresnel term.
pub(crate) struct Mirror {
    pub fresnel: &'static dyn Fresnel,
}

impl Reference for Mirror {
    /// A delta has no value.
    fn brdf(&self, _angles: &Angles, _: &Setting) -> Option<[f64; 2]> {
        None
    }

    /// ωm = n: ρ_dh = F(μ).
    fn rho_dh(&self, mu: f64, setting: &Setting) -> [f64; 2] {
        let mu = mu.clamp(0.0, 1.0);
        self.fresnel.weights(mu, 1.0 - mu, &setting.parameters)
    }

    fn rho_dh_times(&self, mu: f64, setting: &Setting, factor: &dyn Fn(f64) -> f64) -> [f64; 2] {
        self.rho_dh(mu, setting).map(|rho| rho * factor(mu))
    }

    fn rho_hh(&self, setting: &Setting) -> [f64; 2] {
        self.fresnel.mean(&setting.parameters)
    }
}
