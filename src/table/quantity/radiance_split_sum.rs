//! The split sum's approximation of the exitant radiance.

use crate::table::ErrorKind;
use crate::table::axis::Variable;
use crate::table::quantity::{Evaluation, Limits, Quantity};

/// LD(r) (F0·A + F90·B), which approximates Le.
pub static RADIANCE_SPLIT_SUM: Quantity = Quantity {
    name: "radiance_split_sum",
    symbol: "LD (F0·A + F90·B)",
    unit: "W sr⁻¹ m⁻²",
    summary: "exitant radiance by pre-filtered light and the split sum",
    variables: &[Variable::ThetaN, Variable::PhiN, Variable::ThetaE, Variable::PhiE],
    anisotropic_variables: &[Variable::ThetaN, Variable::PhiN, Variable::ThetaE, Variable::PhiE],
    error: ErrorKind::Relative,
    evaluation: Evaluation::Light,
    limits: Limits::NonNegative,
    is_promised: false,
};
