//! The directional-hemispherical reflectance, or directional albedo.

use crate::table::ErrorKind;
use crate::table::axis::Variable;
use crate::table::quantity::{Evaluation, FixedDirection, Limits, Quantity};

/// ρ_dh(θi) = ∫ f cos θe dωe.
pub static RHO_DH: Quantity = Quantity {
    name: "rho_dh",
    symbol: "ρ_dh",
    unit: "1",
    summary: "directional-hemispherical reflectance",
    variables: &[Variable::ThetaI],
    anisotropic_variables: &[Variable::ThetaI, Variable::PhiI],
    error: ErrorKind::Absolute,
    evaluation: Evaluation::Directional(FixedDirection::Incident),
    limits: Limits::Reflectance,
    is_promised: true,
};
