//! The BRDF itself.

use crate::table::ErrorKind;
use crate::table::axis::Variable;
use crate::table::quantity::{Evaluation, Limits, Quantity};

/// f(θi, θe, δφ), or f(θi, φi, θe, φe) where azimuths differ.
pub static BRDF: Quantity = Quantity {
    name: "brdf",
    symbol: "f",
    unit: "sr⁻¹",
    summary: "the BRDF, without the cosine",
    variables: &[Variable::ThetaI, Variable::ThetaE, Variable::DeltaPhi],
    anisotropic_variables: &[Variable::ThetaI, Variable::PhiI, Variable::ThetaE, Variable::PhiE],
    error: ErrorKind::Relative,
    evaluation: Evaluation::Value,
    limits: Limits::NonNegative,
    is_promised: true,
};
