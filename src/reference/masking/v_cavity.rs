//! V-shaped grooves.

use super::{Facet, Masking};

/// Cook & Torrance 1982.
pub(crate) struct VCavity;

impl Masking for VCavity {
    fn tolerance(&self) -> f64 {
        1e-9
    }

    /// Section 4: G = min {1, 2 (N·H)(N·V)/(V·H), 2 (N·H)(N·L)/(V·H)}.
    fn g2(&self, facet: &Facet) -> f64 {
        let [masked, shadowed] = facet.mu.map(|mu| 2.0 * facet.cos_m * mu / facet.cos_d);
        masked.min(shadowed).min(1.0)
    }
}
