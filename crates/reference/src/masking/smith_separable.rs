//! Smith masking and shadowing of microfacets, as if the one knew nothing of the other.

use crate::masking::{Facet, Masking};

/// Smith 1967; Walter et al. 2007.
pub(crate) struct SmithSeparable;

impl Masking for SmithSeparable {
    /// Walter et al. 2007, eq. 23: G2 = G1(ωi) G1(ωe), each 1 / (1 + Λ) (Heitz 2014, eq. 43; for GGX Walter's
    /// eq. 34), above the horizon.
    fn g2(&self, facet: &Facet) -> f64 {
        let [g1_i, g1_e] = facet.lambda.map(|lambda| 1.0 / (1.0 + lambda));
        g1_i * g1_e
    }
}
