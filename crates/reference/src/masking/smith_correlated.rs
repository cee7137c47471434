//! Smith masking and shadowing of microfacets at correlated heights.

use crate::masking::{Facet, Masking};

/// Ross et al. 2005; Heitz 2014.
pub(crate) struct SmithCorrelated;

impl Masking for SmithCorrelated {
    /// Heitz 2014, eq. 99: G2 = 1 / (1 + Λ(ωi) + Λ(ωe)), above the horizon.
    fn g2(&self, facet: &Facet) -> f64 {
        1.0 / (1.0 + facet.lambda[0] + facet.lambda[1])
    }
}
