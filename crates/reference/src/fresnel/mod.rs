//! Fresnel terms.

mod complex;
pub(crate) mod conductor;
pub(crate) mod dielectric;
pub(crate) mod f82;
pub(crate) mod generalized_schlick;
pub(crate) mod none;
pub(crate) mod schlick;
pub(crate) mod thin_film;

use crate::quadrature::integrate;
use crate::setting::Parameters;

/// A Fresnel term by what its weights multiply: F0 and F90 where it is Schlick's, or F itself and nothing.
pub(crate) trait Fresnel: Sync {
    /// The components at ωi·ωm and 1 − ωi·ωm, both given.
    fn weights(&self, cos_d: f64, one_minus_cos_d: f64, parameters: &Parameters) -> [f64; 2];

    /// Their mean over directions, of a mirror: 2 ∫ weights(μ) μ dμ.
    fn mean(&self, parameters: &Parameters) -> [f64; 2];
}

/// 2 ∫ F(μ) μ dμ over [0, 1], by μ = w², of an F that changes at grazing on the scale `turn` of μ.
fn mean(f: impl Fn(f64) -> [f64; 2], turn: f64) -> [f64; 2] {
    let weighted = |w: f64| f(w * w).map(|f| 4.0 * w.powi(3) * f);
    let breaks: Vec<_> = [0.0, turn.sqrt(), (5.0 * turn).sqrt()].into_iter().filter(|&w| w < 0.8).collect();
    integrate(weighted, &[&breaks[..], &[1.0]].concat(), 1e-12).value_or_nan()
}
