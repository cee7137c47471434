//! The quantities that can be tabulated, of a BRDF and of light. A quantity is a file here that defines it, and a
//! line of the registry.

use crate::base::error::{Error, Result};
use crate::table::ErrorKind;
use crate::table::axis::Variable;

/// A quantity that a table holds.
#[derive(Debug, PartialEq)]
#[non_exhaustive]
pub struct Quantity {
    /// The name in recipes, files and manifests.
    pub name: &'static str,
    /// The symbol in print.
    pub symbol: &'static str,
    /// The unit of its values.
    pub unit: &'static str,
    /// One line for people.
    pub summary: &'static str,
    /// The variables of its directions, slowest first; a subject's roughness comes before them. Of an integral the first
    /// is the zenith angle of the fixed direction, or its cosine.
    pub variables: &'static [Variable],
    /// The variables of its directions where a lobe is anisotropic.
    pub anisotropic_variables: &'static [Variable],
    /// The kind of its errors, absolute or relative.
    pub error: ErrorKind,
    /// The way its values follow from a BRDF, or that they are light's.
    pub evaluation: Evaluation,
    /// The values that are possible.
    pub limits: Limits,
    /// Whether a table of it must meet the tolerance. The error of an approximation is a result and not a fault.
    pub is_promised: bool,
}

/// The evaluation of a quantity's values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Evaluation {
    /// f itself.
    Value,
    /// ∫ f cos θ dω over one direction while the other is fixed.
    Directional(FixedDirection),
    /// The cosine-weighted mean over ωi of ∫ f cos θe dωe.
    Hemispherical,
    /// The bakers of light evaluate it; no plan of a BRDF has such a quantity.
    Light,
}

/// The direction that an integral over directions keeps fixed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FixedDirection {
    /// ωi: the integral is over ωe.
    Incident,
    /// ωe: the integral is over ωi.
    Exitant,
}

/// The values that a quantity can have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Limits {
    /// Finite values of either sign.
    Finite,
    /// Finite values that are not negative.
    NonNegative,
    /// Finite values that are not negative, and no more than the models promise to reflect: 1 where energy is
    /// conserved.
    Reflectance,
}

/// Declares the modules of the quantities and [`QUANTITIES`] from one list.
macro_rules! quantities {
    ($($module:ident::$name:ident,)*) => {
        $(mod $module; pub use $module::$name;)*

        /// The registry: quantities of a BRDF in the order in which a scene's tables come, then those of light.
        pub static QUANTITIES: &[&Quantity] = &[$(&$name),*];
    };
}

quantities! {
    brdf::BRDF,
    rho_dh::RHO_DH,
    rho_hh::RHO_HH,
    split_sum::SPLIT_SUM,
    irradiance::IRRADIANCE,
    sh::SH,
    sh_irradiance::SH_IRRADIANCE,
    radiance::RADIANCE,
    radiance_split_sum::RADIANCE_SPLIT_SUM,
    split_sum_error::SPLIT_SUM_ERROR,
    radiosity::RADIOSITY,
    reflected_share::REFLECTED_SHARE,
}

impl Quantity {
    /// The variables of its directions, for anisotropic or isotropic subjects.
    pub fn variables(&self, anisotropic: bool) -> &'static [Variable] {
        if anisotropic { self.anisotropic_variables } else { self.variables }
    }

    /// Whether it is f itself, so that no rule integrates anything.
    pub fn is_value(&self) -> bool {
        self.evaluation == Evaluation::Value
    }

    /// Whether it is an integral of f over directions.
    pub fn is_integral(&self) -> bool {
        matches!(self.evaluation, Evaluation::Directional(_) | Evaluation::Hemispherical)
    }

    /// Whether it is a quantity of light, which no BRDF has.
    pub fn is_of_light(&self) -> bool {
        self.evaluation == Evaluation::Light
    }

    /// The direction that its integral keeps fixed.
    pub fn fixed_direction(&self) -> Option<FixedDirection> {
        match self.evaluation {
            Evaluation::Directional(fixed) => Some(fixed),
            Evaluation::Hemispherical => Some(FixedDirection::Incident),
            Evaluation::Value | Evaluation::Light => None,
        }
    }

    /// Whether a value is possible, leaving aside how much a model reflects.
    pub(crate) fn allows(&self, value: f64) -> bool {
        value.is_finite() && (self.limits == Limits::Finite || value >= 0.0)
    }

    /// The values that [`allows`](Self::allows) accepts, in words.
    pub(crate) fn allowed(&self) -> String {
        let subject = if self.is_of_light() { "light" } else { "a BRDF" };
        let sign = if self.limits == Limits::Finite { "" } else { " and non-negative" };
        format!("{subject} is finite{sign}")
    }

    /// The reason why a BRDF has no such quantity, if it is light's.
    pub(crate) fn refused(&self) -> Option<String> {
        let name = self.name;
        self.is_of_light()
            .then(|| format!("{name} is a quantity of light; of a BRDF there are {}", names(of_a_brdf())))
    }
}

/// The quantities of a BRDF: those that recipes and plans tabulate.
pub fn of_a_brdf() -> impl Iterator<Item = &'static Quantity> + Clone {
    QUANTITIES.iter().copied().filter(|quantity| !quantity.is_of_light())
}

/// The integrals of a BRDF, in words: "a, b or c".
#[cfg(feature = "lab")]
pub(crate) fn integrals_in_words() -> String {
    crate::base::words::alternatives(
        of_a_brdf().filter(|quantity| quantity.is_integral()).map(|quantity| quantity.name),
    )
}

/// The quantity of a BRDF of this name.
///
/// # Errors
/// When there is none, or it is a quantity of light.
pub fn find(name: &str) -> Result<&'static Quantity> {
    let Some(quantity) = QUANTITIES.iter().find(|quantity| quantity.name == name) else {
        return Err(Error::input(format!("no quantity \"{name}\"; there are {}", names(of_a_brdf()))));
    };
    match quantity.refused() {
        Some(why) => Err(Error::input(why)),
        None => Ok(quantity),
    }
}

/// The names of quantities, separated by commas.
fn names(quantities: impl Iterator<Item = &'static Quantity>) -> String {
    quantities.map(|quantity| quantity.name).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn names_are_unique_and_only_those_of_a_brdf_are_found() {
        let names: BTreeSet<_> = QUANTITIES.iter().map(|quantity| quantity.name).collect();
        assert_eq!(names.len(), QUANTITIES.len());
        let found: Vec<_> = of_a_brdf().map(|quantity| find(quantity.name).unwrap().name).collect();
        assert_eq!(found, ["brdf", "rho_dh", "rho_hh", "split_sum"]);
        let unknown = find("colour").unwrap_err().to_string();
        assert_eq!(unknown, "no quantity \"colour\"; there are brdf, rho_dh, rho_hh, split_sum");
        for light in QUANTITIES.iter().filter(|quantity| quantity.is_of_light()) {
            let why = find(light.name).unwrap_err().to_string();
            assert!(why.contains("of light") && why.contains("split_sum"), "{why}");
        }
    }

    /// An integral reads its fixed direction from its first variable.
    #[test]
    fn the_first_variable_of_an_integral_is_its_fixed_zenith_angle() {
        for quantity in of_a_brdf() {
            let zenith = match quantity.evaluation {
                Evaluation::Directional(FixedDirection::Incident) => &[Variable::ThetaI, Variable::Mu][..],
                Evaluation::Directional(FixedDirection::Exitant) => &[Variable::ThetaE, Variable::Mu],
                _ => continue,
            };
            for anisotropic in [false, true] {
                assert!(zenith.contains(&quantity.variables(anisotropic)[0]), "{}", quantity.name);
            }
        }
    }

    #[test]
    fn values_are_judged_in_the_words_of_their_subject() {
        assert!(BRDF.allows(0.0) && !BRDF.allows(-1e-9) && !BRDF.allows(f64::NAN));
        assert!(SH.allows(-1.0) && !SH.allows(f64::INFINITY));
        assert_eq!(RHO_DH.allowed(), "a BRDF is finite and non-negative");
        assert_eq!(RADIANCE.allowed(), "light is finite and non-negative");
        assert_eq!(SH.allowed(), "light is finite");
    }
}
