//! The share of the irradiance that a material sends back.

use crate::table::ErrorKind;
use crate::table::axis::Variable;
use crate::table::quantity::{Evaluation, Limits, Quantity};

/// M/E; 0 where there is no light. No model's bound is asked of it: it is a mean of ρ_dh, whose tables are held to theirs.
pub static REFLECTED_SHARE: Quantity = Quantity {
    name: "reflected_share",
    symbol: "M/E",
    unit: "1",
    summary: "share of the irradiance that leaves as radiosity",
    variables: &[Variable::ThetaN, Variable::PhiN],
    anisotropic_variables: &[Variable::ThetaN, Variable::PhiN],
    error: ErrorKind::Relative,
    evaluation: Evaluation::Light,
    limits: Limits::NonNegative,
    is_promised: true,
};
