//! The radiosity of a material under a light, by its normal.

use crate::table::ErrorKind;
use crate::table::axis::Variable;
use crate::table::quantity::{Evaluation, Limits, Quantity};

/// M(n) = ∫ Le cos θe dωe = ∫ ρ_dh L cos θi dωi.
pub static RADIOSITY: Quantity = Quantity {
    name: "radiosity",
    symbol: "M",
    unit: "W m⁻²",
    summary: "radiosity over normals",
    variables: &[Variable::ThetaN, Variable::PhiN],
    anisotropic_variables: &[Variable::ThetaN, Variable::PhiN],
    error: ErrorKind::Relative,
    evaluation: Evaluation::Light,
    limits: Limits::NonNegative,
    is_promised: true,
};
