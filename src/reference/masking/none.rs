//! No masking.

use super::Masking;

/// Torrance & Sparrow 1967, with a G of 1.
pub(crate) struct Unmasked;

impl Masking for Unmasked {
    /// Every microfacet is seen, above the horizon.
    fn g2(&self, _lambda_i: f64, _lambda_e: f64) -> f64 {
        1.0
    }
}
