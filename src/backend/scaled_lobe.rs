//! A lobe at one setting, ready for evaluation at points.

use crate::integrate::scale::LobeScale;
use crate::model::lobe::Lobe;

/// The α of a lobe, and the scale that its factors make.
pub(crate) struct ScaledLobe {
    pub alpha: f64,
    pub scale: LobeScale,
}

impl ScaledLobe {
    /// The scaled lobe at an α, which a roughness stands for where its factors need one.
    pub fn new(lobe: &Lobe, alpha: f64, roughness: Option<f64>) -> Self {
        Self { alpha, scale: LobeScale::new(lobe.factors(), roughness) }
    }
}
