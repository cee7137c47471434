//! What a lobe is evaluated with: plain numbers, which the shaders, their twins and the reference read alike.

use super::Model;
use std::collections::BTreeMap;

/// Parameters beyond the shape, in the places that parts give them: a Fresnel term's from 4 on, so that there is
/// room for other terms', and those of a model without terms from 0.
pub type Parameters = [f64; 8];

/// A model's shape and the rest of its parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// The shape, in the model's own measure: α of microfacets, σ of Oren–Nayar, …; unused without one.
    pub alpha: f64,
    /// The rest.
    pub parameters: Parameters,
}

impl From<f64> for Setting {
    /// A shape alone, for models that take no more.
    fn from(alpha: f64) -> Self {
        Self { alpha, parameters: [0.0; 8] }
    }
}

/// Parameters by their names.
pub(crate) fn named(model: &Model, places: &Parameters) -> BTreeMap<&'static str, f64> {
    model.parameters.iter().map(|parameter| (parameter.name, places[parameter.place])).collect()
}
