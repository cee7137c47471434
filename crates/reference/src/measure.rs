//! What a roughness means to a model.

use crate::setting::Refused;
use std::f64::consts::FRAC_PI_2;

/// A model's own measure of a perceptual roughness in [0, 1].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Measure {
    /// The model takes no roughness.
    None,
    /// α = roughness² (Burley 2012, section 5.4), and no less than `least`.
    Alpha {
        /// The smallest α that the model has.
        least: f64,
    },
    /// The roughness as it is.
    Roughness,
    /// σ = π/2 · roughness, rad: KHR_materials_diffuse_roughness (draft).
    Sigma,
}

impl Measure {
    /// α = roughness².
    pub const ALPHA: Self = Self::Alpha { least: 0.0 };

    /// The measure of a roughness; 0 for a model that takes none.
    ///
    /// # Errors
    /// When the model takes a roughness and there is none, or it is not in [0, 1]; NaN is not.
    pub fn of_roughness(self, roughness: Option<f64>) -> Result<f64, Refused> {
        if self == Self::None {
            return Ok(0.0);
        }
        let roughness = roughness.ok_or(Refused::NoRoughness)?;
        if !(0.0..=1.0).contains(&roughness) {
            return Err(Refused::Roughness(roughness));
        }
        Ok(match self {
            Self::None => 0.0,
            Self::Alpha { least } => (roughness * roughness).max(least),
            Self::Roughness => roughness,
            Self::Sigma => FRAC_PI_2 * roughness,
        })
    }

    /// A value of the measure itself, from the least that it takes to that of roughness 1.
    ///
    /// # Errors
    /// When it is outside that range; NaN is.
    pub fn checked(self, value: f64) -> Result<f64, Refused> {
        let [low, high] = match self {
            Self::None => return Ok(0.0),
            Self::Alpha { least } => [least, 1.0],
            Self::Roughness => [0.0, 1.0],
            Self::Sigma => [0.0, FRAC_PI_2],
        };
        if (low..=high).contains(&value) { Ok(value) } else { Err(Refused::Measure { value, low, high }) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_roughness_outside_0_to_1_is_refused() {
        for measure in [Measure::ALPHA, Measure::Roughness, Measure::Sigma] {
            for roughness in [7.0, -0.5, 1.0 + f64::EPSILON, f64::INFINITY, f64::NAN] {
                assert!(matches!(measure.of_roughness(Some(roughness)), Err(Refused::Roughness(_))));
                assert!(measure.checked(roughness * 2.0).is_err());
            }
            assert_eq!(measure.of_roughness(None), Err(Refused::NoRoughness));
            assert_eq!(measure.of_roughness(Some(0.0)), Ok(0.0));
        }
    }

    #[test]
    fn measures_are_those_of_the_papers() {
        assert_eq!(Measure::ALPHA.of_roughness(Some(0.5)), Ok(0.25));
        assert_eq!(Measure::Alpha { least: 1e-3 }.of_roughness(Some(0.01)), Ok(1e-3));
        assert_eq!(Measure::Roughness.of_roughness(Some(0.5)), Ok(0.5));
        assert_eq!(Measure::Sigma.of_roughness(Some(1.0)), Ok(FRAC_PI_2));
        assert_eq!(Measure::None.of_roughness(None), Ok(0.0));
    }
}
