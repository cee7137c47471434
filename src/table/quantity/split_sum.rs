//! The split sum (DFG) terms of a microfacet lobe.

use crate::table::ErrorKind;
use crate::table::axis::Variable;
use crate::table::quantity::{Evaluation, FixedDirection, Limits, Quantity};

/// A and B of ∫ f cos θi dωi = F0·A + F90·B, over μ = cos θe.
pub static SPLIT_SUM: Quantity = Quantity {
    name: "split_sum",
    symbol: "A, B",
    unit: "1",
    summary: "the split sum (DFG) terms: F0·A + F90·B reflects",
    variables: &[Variable::Mu],
    anisotropic_variables: &[Variable::Mu, Variable::PhiI],
    error: ErrorKind::Absolute,
    evaluation: Evaluation::Directional(FixedDirection::Exitant),
    limits: Limits::Reflectance,
    is_promised: true,
};
