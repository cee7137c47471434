//! The exitant radiance of a material under a light.

use crate::table::ErrorKind;
use crate::table::axis::Variable;
use crate::table::quantity::{Evaluation, Limits, Quantity};

/// Le(ωe) = ∫ f L cos θi dωi.
pub static RADIANCE: Quantity = Quantity {
    name: "radiance",
    symbol: "Le",
    unit: "W sr⁻¹ m⁻²",
    summary: "exitant radiance",
    variables: &[Variable::ThetaN, Variable::PhiN, Variable::ThetaE, Variable::PhiE],
    anisotropic_variables: &[Variable::ThetaN, Variable::PhiN, Variable::ThetaE, Variable::PhiE],
    error: ErrorKind::Relative,
    evaluation: Evaluation::Light,
    limits: Limits::NonNegative,
    is_promised: true,
};
