//! The f64 reference of a model, found by its name or by those of its parts, and of a lobe, which has a roughness,
//! parameters and factors.
//!
//! The reference is a crate of its own that imports none of ours. It gets names and numbers as recipes give them, before
//! this crate has turned them into its own measures.

use super::factor::ReferenceScale;
use crate::base::angles;
use crate::base::error::{Error, Result};
use crate::model::Model;
use crate::model::compensation::Albedo;
use crate::model::lobe::Lobe;
use crate::model::parameters::Parameters;
use crate::table::quantity::FixedDirection;
use gonio_reference::{Angles, Factors, Measure, Reference, Refused, Setting};
use std::sync::{PoisonError, RwLock};

/// The references of an embedder's models, by the models' names.
static REGISTERED: RwLock<Vec<(&'static str, &'static dyn Reference)>> = RwLock::new(Vec::new());

/// Registers the reference of an embedder's model by the model's name; from then on checks compare with it.
///
/// # Errors
/// When the model has a reference already.
pub fn register_reference(model: &'static Model, reference: &'static dyn Reference) -> Result<()> {
    if reference_of_model(model).is_some() {
        return Err(Error::input(format!("{} has a reference already", model.name)));
    }
    REGISTERED.write().unwrap_or_else(PoisonError::into_inner).push((model.name, reference));
    Ok(())
}

/// The reference of a model, if there is one.
pub fn reference_of_model(model: &Model) -> Option<&'static dyn Reference> {
    let built_in = match model.microfacet {
        Some(parts) => match &parts.masking {
            Some(masking) => gonio_reference::microfacet(parts.ndf.name, masking.name, parts.fresnel.name),
            None => gonio_reference::mirror(parts.fresnel.name),
        },
        None => gonio_reference::model(model.name),
    };
    built_in.or_else(|| {
        let registered = REGISTERED.read().unwrap_or_else(PoisonError::into_inner);
        registered.iter().find(|(name, _)| *name == model.name).map(|&(_, reference)| reference)
    })
}

/// The parameters of a model by their names.
pub(crate) fn reference_parameters(
    model: &Model,
    parameters: &Parameters,
) -> std::result::Result<gonio_reference::Parameters, Refused> {
    gonio_reference::Parameters::named(model.parameters.iter().map(|p| (p.name, parameters[p.place])))
}

/// The reference's angles of a pair of directions.
pub(crate) fn reference_angles(pair: &angles::Angles) -> Angles {
    let angles::Angles { theta_i, phi_i, theta_e, .. } = *pair;
    Angles { theta_i, theta_e, delta_phi: pair.delta_phi(), phi_i }
}

/// A lobe as the reference evaluates it, without its weights.
pub(crate) struct ReferenceLobe {
    reference: &'static dyn Reference,
    setting: Setting,
    /// The product of its factors, if it has any.
    scale: Option<ReferenceScale>,
}

impl ReferenceLobe {
    /// The lobe at its own roughness, or at `swept`, that of a table's row, with all the digits that its integrals reach.
    /// `None` where its model, or one that a factor is made of, has no reference, or the reference refuses the roughness or
    /// a parameter.
    pub fn exact(lobe: &Lobe, swept: Option<f64>) -> Option<Self> {
        Self::within(lobe, swept, 0.0)
    }

    /// The same with integrals to an absolute error of `error`.
    pub fn within(lobe: &Lobe, swept: Option<f64>, error: f64) -> Option<Self> {
        let reference = reference_of_model(lobe.model())?;
        let parameters = reference_parameters(lobe.model(), &lobe.parameters()).ok()?;
        let setting = Setting::new(reference.measure(), swept.or(lobe.roughness()), &parameters).ok()?;
        let setting = setting.within(error);
        let scale = match lobe.factors()[..] {
            [] => None,
            _ => Some(ReferenceScale::new(lobe, swept, error)?),
        };
        Some(Self { reference, setting, scale })
    }

    /// Evaluates f, sr⁻¹; `None` of a delta.
    pub fn brdf(&self, angles: &Angles) -> Option<[f64; 2]> {
        let f = self.reference.brdf(angles, &self.setting)?;
        let Some(scale) = &self.scale else { return Some(f) };
        let factor = scale.value(angles.theta_i.cos(), angles.theta_e.cos());
        Some(f.map(|f| f * factor))
    }

    /// Integrates ρ_dh at a fixed direction (μ, φ) of incidence or of exitance.
    pub fn rho_dh(&self, mu: f64, phi: f64, fixed: FixedDirection) -> [f64; 2] {
        match &self.scale {
            None => self.reference.rho_dh_at(mu, phi, &self.setting),
            Some(scale) => scale.rho_dh(self.reference, mu, &self.setting, fixed),
        }
    }

    /// Integrates ρ_hh.
    pub fn rho_hh(&self) -> [f64; 2] {
        match &self.scale {
            None => self.reference.rho_hh(&self.setting),
            Some(scale) => scale.rho_hh(self.reference, &self.setting),
        }
    }

    /// The approximate width of the lobe, rad: its model's measure of the roughness; `None` of a model that takes none.
    pub fn width(&self) -> Option<f64> {
        (self.reference.measure() != Measure::None).then(|| self.setting.alpha())
    }

    /// The factors D, F and G of a microfacet lobe; `None` of any other.
    #[cfg(feature = "cli")]
    pub fn factors(&self, angles: &Angles) -> Option<Factors> {
        self.reference.factors(angles, &self.setting)
    }
}

/// The reference of an albedo that a factor is made of, in a row of roughness `row`; `None` where it has none.
pub(super) fn reference_of_albedo(
    albedo: &Albedo,
    row: Option<f64>,
) -> Option<(&'static dyn Reference, Setting)> {
    let reference = reference_of_model(albedo.model)?;
    let parameters = reference_parameters(albedo.model, &albedo.parameters).ok()?;
    Some((reference, Setting::new(reference.measure(), albedo.roughness.or(row), &parameters).ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model;

    /// Every model that is built in has a reference, which knows each of its parameters and means the same by its
    /// roughness.
    #[test]
    fn every_model_has_a_reference() {
        let registered =
            |model: &Model| REGISTERED.read().unwrap().iter().any(|(name, _)| *name == model.name);
        for model in model::all().filter(|model| !registered(model)) {
            let reference = reference_of_model(model).unwrap_or_else(|| panic!("{} has none", model.name));
            for parameter in model.parameters {
                assert!(gonio_reference::Parameters::is_built_in(parameter.name), "{}", parameter.name);
            }
            let parameters = reference_parameters(model, &model.defaults()).unwrap();
            for parameter in model.parameters {
                assert_eq!(parameters.get(parameter.name), Some(model.defaults()[parameter.place]));
            }
            for roughness in [0.0, 1e-3, 0.02, 0.3, 0.77, 1.0] {
                let setting = Setting::new(reference.measure(), Some(roughness), &parameters).unwrap();
                assert_eq!(setting.alpha(), model.measure(roughness), "{} at {roughness}", model.name);
            }
        }
    }

    /// A number that is no roughness has no reference, so that no comparison calls it right.
    #[test]
    fn a_wrong_roughness_has_no_reference() {
        let ggx = model::find("ggx").unwrap();
        let lobe = Lobe::new(ggx, None, vec![[1.0; 2]]).unwrap();
        for roughness in [Some(7.0), Some(-0.5), Some(f64::NAN), None] {
            assert!(ReferenceLobe::exact(&lobe, roughness).is_none());
        }
        assert!(ReferenceLobe::exact(&lobe, Some(0.5)).is_some());
    }
}
