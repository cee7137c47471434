//! What a model is evaluated with: a roughness in the model's own measure, and parameters by their names.

use crate::measure::Measure;
use std::fmt;

/// A roughness in a model's own measure, the rest of its parameters, and the error that integrals may have; checked when
/// it is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// α of microfacets, σ of Oren–Nayar, …; 0 of a model that takes no roughness.
    pub(crate) alpha: f64,
    pub(crate) parameters: Parameters,
    /// The absolute error that an integral may have; 0: as little as the model's integrals reach.
    error: f64,
}

impl Setting {
    /// The setting of a model of this measure at a perceptual roughness.
    ///
    /// # Errors
    /// When the model takes a roughness and there is none, or it is not in [0, 1].
    pub fn new(measure: Measure, roughness: Option<f64>, parameters: &Parameters) -> Result<Self, Refused> {
        Ok(Self { alpha: measure.of_roughness(roughness)?, parameters: *parameters, error: 0.0 })
    }

    /// The same at a value of the measure itself: α, σ, ….
    ///
    /// # Errors
    /// When it is outside the measure's range.
    pub fn measured(measure: Measure, value: f64, parameters: &Parameters) -> Result<Self, Refused> {
        Ok(Self { alpha: measure.checked(value)?, parameters: *parameters, error: 0.0 })
    }

    /// The same with integrals to an absolute error of `error`, which is quicker than all the digits that there are. A
    /// second rule certifies each: the one of Gauss within Kronrod's.
    #[must_use]
    pub fn within(self, error: f64) -> Self {
        Self { error, ..self }
    }

    /// The tolerance of an integral that reaches `finest`.
    pub(crate) fn tolerance(&self, finest: f64) -> f64 {
        self.error.max(finest)
    }

    /// The roughness in the model's own measure.
    pub fn alpha(&self) -> f64 {
        self.alpha
    }

    /// The parameters.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }
}

/// [`Parameters`] from a line for each.
macro_rules! parameters {
    ($($(#[$about:meta])* $name:ident = $default:expr;)*) => {
        /// The parameters beside the roughness, by name. A model reads those that it takes.
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct Parameters {
            $($(#[$about])* pub(crate) $name: f64,)*
            /// Those of models that are not built in.
            others: [(&'static str, f64); OTHERS],
        }

        impl Parameters {
            /// Every parameter at its default.
            pub const DEFAULT: Self = Self { $($name: $default,)* others: [("", 0.0); OTHERS] };

            /// Whether a built-in model takes a parameter of this name.
            pub fn is_built_in(name: &str) -> bool {
                [$(stringify!($name)),*].contains(&name)
            }

            /// The parameter of a name.
            pub fn get(&self, name: &str) -> Option<f64> {
                match name {
                    $(stringify!($name) => Some(self.$name),)*
                    _ => self.others.iter().find(|other| other.0 == name && !name.is_empty()).map(|other| other.1),
                }
            }

            fn built_in(&mut self, name: &str) -> Option<&mut f64> {
                match name {
                    $(stringify!($name) => Some(&mut self.$name),)*
                    _ => None,
                }
            }
        }
    };
}

/// How many parameters a model that is not built in may have.
const OTHERS: usize = 8;

parameters! {
    /// η, the index of refraction over that of the medium outside.
    eta = 1.5;
    /// k, the extinction coefficient over the index of the medium outside.
    k = 0.0;
    /// F82-tint's reflectance at 81.8° over Schlick's.
    f82 = 1.0;
    /// The exponent of a generalised Schlick term.
    exponent = 5.0;
    /// A film's thickness, nm.
    thickness = 0.0;
    /// A film's index of refraction over that of the medium outside.
    film_eta = 1.3;
    /// The reflectance at normal incidence of what is below a film.
    f0 = 0.04;
    /// Whose reflectance it is: 0 is R, 1 is G and 2 is B.
    channel = 1.0;
    /// αx/αy.
    aspect = 1.0;
    /// KHR_materials_anisotropy's strength.
    strength = 0.0;
    /// The exponent γ of GTR.
    gamma = 2.0;
    /// EON's ρ, the albedo of a facet.
    albedo = 1.0;
    /// Cx = Cy of Lafortune's lobe.
    cxy = -1.0;
    /// Cz of Lafortune's lobe.
    cz = 1.0;
}

impl Parameters {
    /// The defaults but for those that are named.
    ///
    /// # Errors
    /// As [`Parameters::set`].
    pub fn named(values: impl IntoIterator<Item = (&'static str, f64)>) -> Result<Self, Refused> {
        let mut parameters = Self::DEFAULT;
        values.into_iter().try_for_each(|(name, value)| parameters.set(name, value))?;
        Ok(parameters)
    }

    /// Sets a parameter by its name. A name that no built-in model has is kept for models that are not built in.
    ///
    /// # Errors
    /// When the value is not finite, or there are more of those names than eight.
    pub fn set(&mut self, name: &'static str, value: f64) -> Result<(), Refused> {
        if !value.is_finite() {
            return Err(Refused::Parameter { name, value });
        }
        if let Some(parameter) = self.built_in(name) {
            *parameter = value;
            return Ok(());
        }
        let free = self.others.iter_mut().find(|other| other.0 == name || other.0.is_empty());
        *free.ok_or(Refused::TooMany(name))? = (name, value);
        Ok(())
    }
}

impl Default for Parameters {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Why there is no [`Setting`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Refused {
    /// The model takes a roughness, and none is given.
    NoRoughness,
    /// A roughness that is not in [0, 1].
    Roughness(f64),
    /// A value of the model's own measure that is outside its range.
    Measure {
        /// The value.
        value: f64,
        /// The least of the range.
        low: f64,
        /// The most of it.
        high: f64,
    },
    /// A parameter that is not finite.
    Parameter {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// A parameter that is one too many.
    TooMany(&'static str),
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoRoughness => write!(f, "no roughness; give one in [0, 1]"),
            Self::Roughness(roughness) => write!(f, "roughness {roughness} is outside [0, 1]"),
            Self::Measure { value, low, high } => write!(f, "{value} is outside [{low}, {high}]"),
            Self::Parameter { name, value } => write!(f, "{name} = {value}; give a finite number"),
            Self::TooMany(name) => write!(f, "{name} is one parameter too many; {OTHERS} are kept"),
        }
    }
}

impl std::error::Error for Refused {}

/// α alone, unchecked: tests of bad input need it.
#[cfg(test)]
impl From<f64> for Setting {
    fn from(alpha: f64) -> Self {
        Self { alpha, parameters: Parameters::DEFAULT, error: 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_are_set_by_name() {
        let mut parameters = Parameters::named([("eta", 2.0), ("dust", 0.3)]).unwrap();
        assert_eq!((parameters.eta, parameters.get("eta")), (2.0, Some(2.0)));
        assert_eq!(
            (parameters.get("dust"), parameters.get("k"), parameters.get("")),
            (Some(0.3), Some(0.0), None)
        );
        parameters.set("dust", 0.4).unwrap();
        assert_eq!((parameters.get("dust"), parameters.get("sand")), (Some(0.4), None));
        assert!(matches!(parameters.set("k", f64::NAN), Err(Refused::Parameter { name: "k", .. })));
        for name in ["b", "c", "d", "e", "f", "g", "h"] {
            parameters.set(name, 1.0).unwrap();
        }
        assert_eq!(parameters.set("i", 1.0), Err(Refused::TooMany("i")));
    }
}
