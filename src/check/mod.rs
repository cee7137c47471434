//! What a table's values are worth: against the f64 reference, and between the samples.

pub(crate) mod bilinear;
mod cross_check;
mod factor;
pub(crate) mod layout_search;
mod reference;

#[cfg(feature = "files")]
pub(crate) use cross_check::Comparison;
pub use cross_check::{Check, VALUE_FLOOR, cross_check, reference};
pub(crate) use cross_check::{Tally, sample};
pub(crate) use reference::{Fixed, ReferenceLobe, reference_angles, reference_parameters};
pub use reference::{reference_of_model, register_reference};
