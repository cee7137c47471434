//! Fresnel reflectance.

pub(crate) mod conductor;
pub(crate) mod dielectric;
pub(crate) mod f82;
pub(crate) mod metals;
pub(crate) mod none;
pub(crate) mod schlick;

use super::{Component, Metal, Parameter, Term};
use crate::reference;
use crate::setting::{Parameters, Setting};

/// F, split by what a material weighs.
pub(crate) trait Fresnel {
    const TERM: Term;
    const REFERENCE: &'static dyn reference::Fresnel;
    const COMPONENTS: &'static [Component];
    const PARAMETERS: &'static [Parameter] = &[];

    /// Names that stand for parameters.
    const METALS: &'static [Metal] = &[];

    /// Adds what its shader takes beside the parameters, or in place of them.
    fn derive(_parameters: &mut Parameters) {}

    /// Why these parameters are refused, if they are, though each is in its range.
    fn refused(_parameters: &Parameters) -> Option<&'static str> {
        None
    }

    /// The components for c = ωi·ωm and x = 1 − c.
    fn fresnel(c: f64, x: f64, s: &Setting) -> [f64; 2];
}
