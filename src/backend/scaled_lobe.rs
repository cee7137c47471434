//! A lobe at one setting, ready for evaluation at points.

use crate::integrate::scale::Scale;
use crate::model::lobe::Lobe;

/// A lobe's α, and the value of the factors that multiply it.
pub(crate) struct ScaledLobe {
    pub alpha: f64,
    pub scale: Scale,
}

impl ScaledLobe {
    pub fn new(lobe: &Lobe, alpha: f64, roughness: Option<f64>) -> Self {
        Self { alpha, scale: Scale::new(lobe.factors(), roughness) }
    }
}
