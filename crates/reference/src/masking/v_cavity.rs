//! V-shaped grooves.

use crate::masking::{Facet, Masking};
use std::f64::consts::FRAC_PI_2;

/// Cook & Torrance 1982.
pub(crate) struct VCavity;

impl Masking for VCavity {
    /// Section 4: G = min {1, 2 (N·H)(N·V)/(V·H), 2 (N·H)(N·L)/(V·H)}.
    fn g2(&self, facet: &Facet) -> f64 {
        let [masked, shadowed] = facet.mu.map(|mu| 2.0 * facet.cos_m * mu / facet.cos_d);
        masked.min(shadowed).min(1.0)
    }

    /// With V·H = cos θm (x t + μ), t = tan θm: the first branch is 1 where x t = μ, the second where
    /// x t³ + 3 μ t² − 3 x t − μ = 0, which is tan 3θm = −μ/x, and both are the same where μ t = x.
    fn kinks(&self, x: f64, mu: f64) -> Vec<f64> {
        if x <= 0.0 { Vec::new() } else { vec![mu / x, ((FRAC_PI_2 + (x / mu).atan()) / 3.0).tan(), x / mu] }
    }
}
