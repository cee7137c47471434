//! No masking.

use crate::masking::{Facet, Masking};

/// Torrance & Sparrow 1967, with a G of 1.
pub(crate) struct Unmasked;

impl Masking for Unmasked {
    /// Every microfacet is seen, above the horizon.
    fn g2(&self, _: &Facet) -> f64 {
        1.0
    }
}
