//! Smith masking and shadowing of microfacets at correlated heights.

use super::Masking;

/// Ross et al. 2005; Heitz 2014.
pub(crate) struct SmithCorrelated;

impl Masking for SmithCorrelated {
    /// Heitz 2014, eq. 99: G2 = 1 / (1 + Λ(ωi) + Λ(ωe)), above the horizon.
    fn g2(&self, lambda_i: f64, lambda_e: f64) -> f64 {
        1.0 / (1.0 + lambda_i + lambda_e)
    }
}
