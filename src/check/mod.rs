//! What a table's values are worth: against the f64 reference, and between the samples.

pub(crate) mod bilinear;
mod cross_check;
pub(crate) mod layout_search;

#[cfg(feature = "files")]
pub(crate) use cross_check::Comparison;
pub use cross_check::{Check, VALUE_FLOOR, cross_check, reference};
pub(crate) use cross_check::{Tally, reference_albedo, reference_angles, reference_of, sample};
