//! Measures the error of a table's values: against the f64 reference, and between the samples.

pub(crate) mod bilinear;
mod cross_check;
mod factor;
#[cfg(feature = "scene")]
pub(crate) mod layout_search;
mod reference;

pub use crate::base::precision::VALUE_FLOOR;
pub use crate::table::Check;
#[cfg(feature = "batch")]
pub(crate) use cross_check::Comparison;
pub(crate) use cross_check::{ErrorTally, reference_error, reference_within, sample};
pub use cross_check::{cross_check, reference};
pub(crate) use reference::{ReferenceLobe, reference_angles, reference_parameters};
pub use reference::{reference_of_model, register_reference};
