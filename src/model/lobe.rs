//! A weighted lobe: a model, its roughness and parameters, its weights and the factors that multiply it.

use super::{Model, Roughness};
use crate::base::error::{Error, Result};
use crate::model::compensation::Factor;
use crate::model::parameters::{Parameters, Setting};

/// A model times weights: f = Σ over components of weight · component, for each channel, times the factors.
#[derive(Debug, Clone, PartialEq)]
pub struct Lobe {
    model: &'static Model,
    roughness: Option<Roughness>,
    parameters: Parameters,
    weights: Vec<[f64; 2]>,
    factors: Vec<Factor>,
}

impl Lobe {
    /// A lobe with its model's defaults for all parameters but the roughness.
    ///
    /// `roughness` is perceptual, in [0, 1]; `None` where a table sweeps it, or where the model takes none. `weights` are
    /// those of the components A and B, for each channel.
    ///
    /// # Errors
    /// When the roughness is outside [0, 1], or a weight is not finite.
    pub fn new(model: &'static Model, roughness: Option<f64>, weights: Vec<[f64; 2]>) -> Result<Self> {
        let roughness = roughness.map(Roughness::new).transpose().map_err(|why| why.at(model.name))?;
        check_weights(model, &weights)?;
        Ok(Self { model, roughness, parameters: model.defaults(), weights, factors: Vec::new() })
    }

    /// Sets the roughness, the model's own measure of it (`alpha`, `sigma`), or another of its parameters, by the names
    /// that recipes use.
    ///
    /// # Errors
    /// When the model has no parameter of this name, or the value is outside its range.
    pub fn set(&mut self, name: &str, value: f64) -> Result<()> {
        let model = self.model;
        if let Some(shape) = model.shape.filter(|shape| name == "roughness" || name == shape.name) {
            let measured = name == shape.name;
            let largest = if measured { shape.most } else { 1.0 };
            if !(0.0..=largest).contains(&value) {
                return Err(out_of_range(name, value, [0.0, largest]));
            }
            let roughness = if measured { shape.roughness(value) } else { value };
            self.roughness = Some(Roughness::new(roughness.min(1.0))?);
            return Ok(());
        }
        let Some(parameter) = model.parameters.iter().find(|parameter| parameter.name == name) else {
            return Err(Error::input(format!("{} has no parameter \"{name}\"", model.name)));
        };
        if !(parameter.range[0]..=parameter.range[1]).contains(&value) {
            return Err(out_of_range(name, value, parameter.range));
        }
        self.parameters[parameter.place] = value;
        Ok(())
    }

    /// The lobe with other weights.
    ///
    /// # Errors
    /// When a weight is not finite.
    pub fn with_weights(self, weights: Vec<[f64; 2]>) -> Result<Self> {
        check_weights(self.model, &weights)?;
        Ok(Self { weights, ..self })
    }

    /// The lobe multiplied by `factors`, in place of those that it has.
    pub fn with_factors(self, factors: Vec<Factor>) -> Self {
        Self { factors, ..self }
    }

    /// The lobe with all parameters of its model, each in its place.
    pub(crate) fn with_parameters(self, parameters: Parameters) -> Self {
        Self { parameters, ..self }
    }

    /// The model.
    pub fn model(&self) -> &'static Model {
        self.model
    }

    /// The perceptual roughness, where the lobe has one of its own.
    pub fn roughness(&self) -> Option<f64> {
        self.roughness.map(Roughness::get)
    }

    /// The model's parameters beside the roughness, each in its place.
    pub fn parameters(&self) -> Parameters {
        self.parameters
    }

    /// For each channel, the weights of the components A and B.
    pub fn weights(&self) -> &[[f64; 2]] {
        &self.weights
    }

    /// The factors of the two cosines that multiply the lobe.
    pub fn factors(&self) -> &[Factor] {
        &self.factors
    }

    /// The setting with a shape, in the model's own measure.
    pub fn setting(&self, alpha: f64) -> Setting {
        Setting { alpha, parameters: self.parameters }
    }

    /// The setting at a table row's roughness, or at the lobe's own where the table has no roughness axis.
    ///
    /// # Errors
    /// When the model takes a roughness and there is none.
    pub fn setting_at(&self, swept: Option<f64>) -> Result<Setting> {
        Ok(self.setting(self.alpha_at(swept)?))
    }

    /// α, or whatever the model's measure of a roughness is; 0 of a model that takes none.
    fn alpha_at(&self, swept: Option<f64>) -> Result<f64> {
        if self.model.shape.is_none() {
            return Ok(0.0);
        }
        match swept.or(self.roughness()) {
            Some(roughness) => Ok(self.model.measure(roughness)),
            None => {
                Err(Error::input(format!("{} needs a roughness: give a value or an axis", self.model.name)))
            }
        }
    }

    /// Whether the lobe is a delta: the ideal mirror, or a microfacet lobe of roughness 0.
    pub fn is_delta(&self) -> bool {
        match self.roughness() {
            Some(roughness) => self.model.is_delta_at(roughness),
            None => self.model.is_delta(),
        }
    }

    /// The largest ρ_dh of the lobe with every weight 1.
    pub(crate) fn rho_bound(&self) -> f64 {
        self.model.rho_bound * self.factors.iter().map(Factor::rho_bound).product::<f64>()
    }

    /// The settings with some shapes.
    pub(crate) fn settings(&self, alphas: &[f64]) -> Vec<Setting> {
        alphas.iter().map(|&alpha| self.setting(alpha)).collect()
    }
}

fn check_weights(model: &Model, weights: &[[f64; 2]]) -> Result<()> {
    match weights.as_flattened().iter().find(|weight| !weight.is_finite()) {
        Some(weight) => {
            Err(Error::input(format!("{}: a weight of {weight}; give a finite number", model.name)))
        }
        None => Ok(()),
    }
}

fn out_of_range(name: &str, value: f64, [low, high]: [f64; 2]) -> Error {
    Error::input(format!("{name} = {value} is outside [{low}, {high}]"))
}
