//! The irradiance of a surface, by its normal.

use crate::table::ErrorKind;
use crate::table::axis::Variable;
use crate::table::quantity::{Evaluation, Limits, Quantity};

/// E(n) = ∫ L cos θi dωi.
pub static IRRADIANCE: Quantity = Quantity {
    name: "irradiance",
    symbol: "E",
    unit: "W m⁻²",
    summary: "irradiance over normals",
    variables: &[Variable::ThetaN, Variable::PhiN],
    anisotropic_variables: &[Variable::ThetaN, Variable::PhiN],
    error: ErrorKind::Relative,
    evaluation: Evaluation::Light,
    limits: Limits::NonNegative,
    is_promised: true,
};
