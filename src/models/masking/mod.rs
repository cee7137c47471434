//! Masking and shadowing of microfacets.

pub(crate) mod none;
mod schlick;
pub(crate) mod schlick_ggx;
pub(crate) mod schlick_ggx_direct;
pub(crate) mod smith_correlated;
pub(crate) mod smith_separable;

use super::ndf::Ndf;
use super::{SlopeCounts, Term};
use crate::reference;
use crate::setting::Setting;

/// G2 of the normals of `N`.
pub(crate) trait Masking {
    const TERM: Term;
    const REFERENCE: &'static dyn reference::Masking;
    /// Why ρ has no bound, if it has none.
    const UNBOUNDED: Option<&'static str> = None;

    /// What it takes where cos φ > 0, the side on which the horizon turns, and where cos φ < 0, when correlated
    /// Smith takes so much.
    fn counts(correlated: [SlopeCounts; 2], _tolerance: f64) -> [SlopeCounts; 2] {
        correlated
    }

    /// G2 / (4 μi μe)
    fn visibility<N: Ndf>(mu_i: f64, mu_e: f64, s: &Setting) -> f64;

    /// G2 = 2 μe x / masking(x, y), for μi = μe x/y.
    fn masking<N: Ndf>(x: f64, y: f64, mu_e: f64, s: &Setting) -> f64;

    /// G2 of the mirror that α → 0 tends to.
    fn mirror(_mu: f64) -> f64 {
        1.0
    }
}
