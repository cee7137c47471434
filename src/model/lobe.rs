//! A weighted lobe: a model, its roughness and parameters, its weights and the factors that multiply it.

use super::Model;
use crate::base::error::{Error, Result};
use crate::model::compensation::Factor;
use crate::model::parameters::{Parameters, Setting};

/// A lobe of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Lobe {
    /// The model.
    pub model: &'static Model,
    /// Perceptual roughness where the table has no roughness axis; unused by models without one.
    pub roughness: Option<f64>,
    /// The rest of the model's parameters, each in its place.
    pub parameters: Parameters,
    /// For each channel, the weights of the components A and B.
    pub weights: Vec<[f64; 2]>,
    /// What it is multiplied with beside, of the two cosines alone.
    pub factors: Vec<Factor>,
}

impl Lobe {
    /// A lobe with its model's defaults for all but the roughness.
    pub fn new(model: &'static Model, roughness: Option<f64>, weights: Vec<[f64; 2]>) -> Self {
        Self { model, roughness, parameters: model.defaults(), weights, factors: Vec::new() }
    }

    /// Takes a value for a parameter of its model.
    ///
    /// # Errors
    /// When there is none of this name, or the value is outside its range.
    pub fn set(&mut self, name: &str, value: f64) -> Result<()> {
        let Some(parameter) = self.model.parameters.iter().find(|parameter| parameter.name == name) else {
            return Err(Error::input(format!("{} has no parameter \"{name}\"", self.model.name)));
        };
        let [low, high] = parameter.range;
        if !(low..=high).contains(&value) {
            return Err(Error::input(format!("{name} = {value} is outside [{low}, {high}]")));
        }
        self.parameters[parameter.place] = value;
        Ok(())
    }

    /// The setting with a shape, in the model's own measure.
    pub fn setting(&self, alpha: f64) -> Setting {
        Setting { alpha, parameters: self.parameters }
    }

    /// The setting at the lobe's own roughness, or at this one where a table sweeps it.
    pub fn setting_at(&self, swept: Option<f64>) -> Setting {
        self.setting(self.model.measure(swept.or(self.roughness).unwrap_or(0.0)))
    }

    /// What ρ_dh of it reaches at most with every weight 1.
    pub(crate) fn rho_bound(&self) -> f64 {
        self.model.rho_bound * self.factors.iter().map(Factor::rho_bound).product::<f64>()
    }

    /// The settings with some shapes.
    pub(crate) fn settings(&self, alphas: &[f64]) -> Vec<Setting> {
        alphas.iter().map(|&alpha| self.setting(alpha)).collect()
    }
}
