//! Hammon's approximation of Smith masking and shadowing at correlated heights.

use crate::masking::{Facet, Masking};

/// Hammon 2017, *PBR Diffuse Lighting for GGX+Smith Microsurfaces*, slides 82 to 84.
pub(crate) struct SmithJointApprox;

impl Masking for SmithJointApprox {
    /// G2/(4 μi μe) = 0.5 / lerp(2 μi μe, μi + μe, α); of two α, each with the cosine of its direction.
    fn g2(&self, facet: &Facet) -> f64 {
        let [mu_i, mu_e] = facet.mu;
        let [alpha_i, alpha_e] = facet.alpha;
        let lerp = 2.0 * mu_i * mu_e * (1.0 - 0.5 * (alpha_i + alpha_e)) + alpha_i * mu_e + alpha_e * mu_i;
        4.0 * mu_i * mu_e * (0.5 / lerp)
    }
}
