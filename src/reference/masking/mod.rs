//! Masking and shadowing.

pub(super) mod none;
pub(super) mod smith_correlated;
pub(super) mod smith_separable;

/// G2(ωi, ωe): the share of microfacets that are neither masked nor shadowed.
pub(crate) trait Masking: Sync {
    /// G2 from Smith's Λ of the two directions.
    fn g2(&self, lambda_i: f64, lambda_e: f64) -> f64;
}
