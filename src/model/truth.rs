//! The reference, for tests of this layer and of the next.

use crate::model::Model;
use crate::model::parameters::{Setting, named};

/// ρ_dh of a microfacet model by the reference.
pub(crate) fn rho_dh(model: &Model, mu: f64, setting: &Setting) -> [f64; 2] {
    let parts = model.microfacet.unwrap();
    let masking = parts.masking.as_ref().unwrap();
    let reference = gonio_reference::microfacet(parts.ndf.name, masking.name, parts.fresnel.name).unwrap();
    let parameters = gonio_reference::Parameters::named(named(model, &setting.parameters)).unwrap();
    let setting =
        gonio_reference::Setting::measured(reference.measure(), setting.alpha, &parameters).unwrap();
    reference.rho_dh(mu, &setting)
}
