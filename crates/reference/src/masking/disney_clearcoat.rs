//! Disney's masking of its clearcoat.

use crate::masking::{Facet, Masking};

/// Burley 2012, as in BRDF Explorer's `disney.brdf`.
pub(crate) struct DisneyClearcoat;

impl Masking for DisneyClearcoat {
    /// Gr = smithG_GGX(NdotL, .25) smithG_GGX(NdotV, .25), which has 1/(4 NdotL NdotV) in it:
    /// smithG_GGX(NdotV, α) = 1/(NdotV + √(a + b − ab)), a = α², b = NdotV².
    fn g2(&self, facet: &Facet) -> f64 {
        let g1 = |n_v: f64| {
            let (a, b) = (0.25 * 0.25, n_v * n_v);
            2.0 * n_v / (n_v + (a + b - a * b).sqrt())
        };
        facet.mu.map(g1).iter().product()
    }
}
