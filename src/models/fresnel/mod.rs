//! Fresnel reflectance.

pub(crate) mod none;
pub(crate) mod schlick;

use super::{Component, Term};
use crate::reference;

/// F, split by what a material weighs.
pub(crate) trait Fresnel {
    const TERM: Term;
    const REFERENCE: &'static dyn reference::Fresnel;
    const COMPONENTS: &'static [Component];

    /// The components for c = ωi·ωm and x = 1 − c.
    fn fresnel(c: f64, x: f64) -> [f64; 2];
}
