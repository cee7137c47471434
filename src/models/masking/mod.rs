//! Masking and shadowing of microfacets.

pub(crate) mod none;
pub(crate) mod smith_correlated;
pub(crate) mod smith_separable;

use super::ndf::Ndf;
use super::{Parameter, SlopeCounts, Term};
use crate::reference;
use crate::setting::{Parameters, Setting};

/// G2 of the normals of `N`.
pub(crate) trait Masking {
    const TERM: Term;
    const REFERENCE: &'static dyn reference::Masking;
    const PARAMETERS: &'static [Parameter] = &[];

    /// Adds what its shader takes beside the parameters, or in place of them.
    fn derive(_parameters: &mut Parameters) {}
    /// Why ρ has no bound, if it has none.
    const UNBOUNDED: Option<&'static str> = None;

    /// What it takes where cos φ > 0, the side on which the horizon turns, and correlated Smith takes so much.
    fn near(correlated: SlopeCounts) -> SlopeCounts {
        correlated
    }

    /// G2 / (4 μi μe)
    fn visibility<N: Ndf>(mu_i: f64, mu_e: f64, s: &Setting) -> f64;

    /// G2 = 2 μe x / masking(x, y), for μi = μe x/y.
    fn masking<N: Ndf>(x: f64, y: f64, mu_e: f64, s: &Setting) -> f64;
}
