//! Nine spherical-harmonic coefficients of a light's radiance.

use crate::table::ErrorKind;
use crate::table::axis::Variable;
use crate::table::quantity::{Evaluation, Limits, Quantity};

/// L_lm = ∫ L Y_lm dω for l ≤ 2.
pub static SH: Quantity = Quantity {
    name: "sh",
    symbol: "L_lm",
    unit: "W m⁻²",
    summary: "spherical-harmonic coefficients of the radiance",
    variables: &[Variable::Harmonic],
    anisotropic_variables: &[Variable::Harmonic],
    error: ErrorKind::Relative,
    evaluation: Evaluation::Light,
    limits: Limits::Finite,
    is_promised: true,
};
