//! The error of the split sum, as a share of the exitant radiance.

use crate::table::ErrorKind;
use crate::table::axis::Variable;
use crate::table::quantity::{Evaluation, Limits, Quantity};

/// |LD (F0·A + F90·B) − Le| / Le.
pub static SPLIT_SUM_ERROR: Quantity = Quantity {
    name: "split_sum_error",
    symbol: "|LD (F0·A + F90·B) − Le| / Le",
    unit: "1",
    summary: "error of the split sum, as a share of the exitant radiance",
    variables: &[Variable::ThetaN, Variable::PhiN, Variable::ThetaE, Variable::PhiE],
    anisotropic_variables: &[Variable::ThetaN, Variable::PhiN, Variable::ThetaE, Variable::PhiE],
    error: ErrorKind::Relative,
    evaluation: Evaluation::Light,
    limits: Limits::NonNegative,
    is_promised: false,
};
