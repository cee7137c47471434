//! Builds a model of an embedder's own, checked once.

use super::{Component, Integral, Model, Parameter, Part, Shape};
use crate::base::error::{Error, Result};
use crate::base::half_angle::{Azimuth, Pair};
use crate::base::precision::VALUE_F32;
use crate::model::parameters::Setting;

/// The components of one or two names, of which a model evaluates [A, B].
const CHANNELS: [&str; 2] = ["A", "B"];

/// Places of parameters that a model of an embedder's own may have: see [`Parameters`](crate::model::parameters::Parameters).
const PLACES: usize = 8;

/// (A, B) of a pair of directions, sr⁻¹, in f64.
pub type Twin = fn(&Pair, &Azimuth, &Setting) -> [f64; 2];

/// A model in the making. It takes a shader, its twin in f64, its integration map and one or two components.
#[must_use]
pub struct ModelBuilder {
    name: String,
    summary: String,
    source: String,
    components: Vec<(String, Option<f64>)>,
    shape: Option<Shape>,
    parameters: Vec<Parameter>,
    shader: Vec<(String, String)>,
    twin: Option<Twin>,
    integral: Option<Integral>,
    rho_bound: f64,
    value_f32: f64,
}

impl Model {
    /// Begins a model of this name, which recipes, files and manifests use: lower case, digits and dashes.
    pub fn builder(name: impl Into<String>) -> ModelBuilder {
        ModelBuilder {
            name: name.into(),
            summary: String::new(),
            source: String::new(),
            components: Vec::new(),
            shape: None,
            parameters: Vec::new(),
            shader: Vec::new(),
            twin: None,
            integral: None,
            rho_bound: f64::INFINITY,
            value_f32: VALUE_F32,
        }
    }
}

impl ModelBuilder {
    /// Says what the model is, in one line, and who published it: author, year, equation.
    pub fn describe(self, summary: impl Into<String>, source: impl Into<String>) -> Self {
        Self { summary: summary.into(), source: source.into(), ..self }
    }

    /// Adds a component: the name of its weight in recipes, and the weight where a recipe gives none (`None`: it must).
    pub fn component(mut self, weight: impl Into<String>, default: Option<f64>) -> Self {
        self.components.push((weight.into(), default));
        self
    }

    /// Gives the model a roughness in this measure.
    pub fn shape(self, shape: Shape) -> Self {
        Self { shape: Some(shape), ..self }
    }

    /// Adds a parameter in [low, high], which shaders read by `parameter(place)` in the order of these calls.
    pub fn parameter(
        mut self,
        name: &'static str,
        summary: &'static str,
        unit: &'static str,
        range: [f64; 2],
        default: Option<f64>,
    ) -> Self {
        let place = self.parameters.len();
        self.parameters.push(Parameter { name, summary, unit, range, default, place });
        self
    }

    /// Adds WGSL: a name for messages, and a text that defines `lobe` and `lobe_row`.
    pub fn shader(mut self, name: impl Into<String>, wgsl: impl Into<String>) -> Self {
        self.shader.push((name.into(), wgsl.into()));
        self
    }

    /// Sets the twin: the shader's own formulas in f64.
    pub fn twin(self, twin: Twin) -> Self {
        Self { twin: Some(twin), ..self }
    }

    /// Sets how hemispherical integrals are done.
    pub fn integral(self, integral: Integral) -> Self {
        Self { integral: Some(integral), ..self }
    }

    /// Sets the bound on ρ_dh that the model promises; without one it promises none.
    pub fn rho_bound(self, rho_bound: f64) -> Self {
        Self { rho_bound, ..self }
    }

    /// Sets the relative error of values in f32, in place of [`VALUE_F32`].
    pub fn value_f32(self, value_f32: f64) -> Self {
        Self { value_f32, ..self }
    }

    /// The model, which lives as long as the process.
    ///
    /// # Errors
    /// When something is missing or out of range: the message says what to give.
    pub(crate) fn build(self) -> Result<&'static Model> {
        let refuse = |why: String| Err(Error::input(format!("model \"{}\": {why}", self.name)));
        let is_word = |name: &str| {
            !name.is_empty()
                && name
                    .bytes()
                    .all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'-' || b == b'_')
        };
        if !is_word(&self.name) {
            return refuse("a name has lower-case letters, digits, dashes and underscores alone".into());
        }
        let (Some(twin), Some(integral)) = (self.twin, self.integral) else {
            return refuse("it has no twin or no integral; give both".into());
        };
        if self.shader.is_empty() && !matches!(integral, Integral::Delta(_)) {
            return refuse("it has no shader; give WGSL that defines lobe and lobe_row".into());
        }
        if !(1..=CHANNELS.len()).contains(&self.components.len()) {
            return refuse(format!("it has {} components; give one or two", self.components.len()));
        }
        if self.parameters.len() > PLACES {
            return refuse(format!("it has {} parameters; give at most {PLACES}", self.parameters.len()));
        }
        for (k, parameter) in self.parameters.iter().enumerate() {
            let Parameter { name, range: [low, high], default, .. } = *parameter;
            if !is_word(name) || self.parameters[..k].iter().any(|other| other.name == name) {
                return refuse(format!("the parameter name \"{name}\" is no word, or given twice"));
            }
            if !(low.is_finite() && high.is_finite() && low < high) {
                return refuse(format!("{name}: the range [{low}, {high}] is no interval"));
            }
            if default.is_some_and(|value| !(low..=high).contains(&value)) {
                return refuse(format!("{name}: its default is outside [{low}, {high}]"));
            }
        }
        if self
            .components
            .iter()
            .any(|(weight, default)| !is_word(weight) || default.is_some_and(|x| !x.is_finite()))
        {
            return refuse("a component's weight needs a word for a name and a finite default".into());
        }
        if self.rho_bound.is_nan() || self.rho_bound <= 0.0 {
            return refuse(format!("a bound of {} on ρ_dh; give a number above 0", self.rho_bound));
        }
        if !(self.value_f32.is_finite() && self.value_f32 > 0.0) {
            return refuse(format!("an f32 error of {}; give a number above 0", self.value_f32));
        }
        let components = self.components.into_iter().zip(CHANNELS);
        let components: Vec<_> = components
            .map(|((weight, default), name)| Component { name, weight: weight.leak(), default })
            .collect();
        let parts = self.shader.into_iter().map(|(name, wgsl)| Part::new(name.leak(), wgsl.leak()));
        Ok(Box::leak(Box::new(Model {
            name: self.name.leak(),
            summary: self.summary.leak(),
            source: self.source.leak(),
            microfacet: None,
            components: components.leak(),
            shape: self.shape,
            parameters: self.parameters.leak(),
            derive: |_| {},
            rho_bound: self.rho_bound,
            parts: parts.collect::<Vec<_>>().leak(),
            integral,
            value_f32: self.value_f32,
            lobe: twin,
        })))
    }
}
