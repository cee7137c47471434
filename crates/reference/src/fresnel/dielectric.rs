//! Fresnel's equations for a dielectric.

use crate::fresnel::{Fresnel, mean};
use crate::setting::Parameters;

/// Walter et al. 2007, eq. 22, for unpolarised light from a medium of index 1 onto one of η ≥ 1:
/// F = ½ (g − c)²/(g + c)² (1 + (c (g + c) − 1)²/(c (g − c) + 1)²), g² = η² − 1 + c².
pub(crate) struct Dielectric;

impl Fresnel for Dielectric {
    fn weights(&self, cos_d: f64, _one_minus_cos_d: f64, p: &Parameters) -> [f64; 2] {
        let (eta, c) = (p.eta, cos_d);
        if eta == 1.0 {
            return [0.0; 2]; // no surface, also where g + c = 0
        }
        let e = (eta - 1.0) * (eta + 1.0);
        let g = (e + c * c).sqrt();
        // g − c = (g² − c²)/(g + c), which keeps its digits as η → 1.
        let difference = e / (g + c);
        let perpendicular = difference / (g + c);
        let ratio = (c * (g + c) - 1.0) / (c * difference + 1.0);
        [0.5 * perpendicular.powi(2) * (1.0 + ratio.powi(2)), 0.0]
    }

    /// By quadrature: the closed form (Duntley 1942) cancels as η → 1.
    fn mean(&self, p: &Parameters) -> [f64; 2] {
        let eta = p.eta;
        mean(|mu| self.weights(mu, 1.0 - mu, p), ((eta - 1.0) * (eta + 1.0)).sqrt())
    }
}
