//! Cloth's visibility.

use crate::masking::{Facet, Masking};

/// Neubelt & Pettineo 2013, after Ashikhmin & Premože 2007.
pub(crate) struct AshikhminNeubelt;

impl Masking for AshikhminNeubelt {
    /// f = D F / (4 (n·l + n·v − (n·l)(n·v))).
    fn g2(&self, facet: &Facet) -> f64 {
        let [l, v] = facet.mu;
        l * v / (l + v - l * v)
    }
}
