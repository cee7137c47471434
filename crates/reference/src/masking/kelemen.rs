//! The quotient of Kelemen and Szirmay-Kalos.

use crate::masking::{Facet, Masking};

/// Kelemen & Szirmay-Kalos 2001.
pub(crate) struct Kelemen;

impl Masking for Kelemen {
    /// G2 / (μi μe) = 1 / (ωi·ωm)².
    fn g2(&self, facet: &Facet) -> f64 {
        facet.mu[0] * facet.mu[1] / (facet.cos_d * facet.cos_d)
    }
}
