//! Nine spherical-harmonic coefficients of a light's irradiance.

use crate::table::ErrorKind;
use crate::table::axis::Variable;
use crate::table::quantity::{Evaluation, Limits, Quantity};

/// E_lm = Â_l L_lm for l ≤ 2: those of the radiance convolved with the clamped cosine.
pub static SH_IRRADIANCE: Quantity = Quantity {
    name: "sh_irradiance",
    symbol: "E_lm",
    unit: "W m⁻²",
    summary: "spherical-harmonic coefficients of the irradiance",
    variables: &[Variable::Harmonic],
    anisotropic_variables: &[Variable::Harmonic],
    error: ErrorKind::Relative,
    evaluation: Evaluation::Light,
    limits: Limits::Finite,
    is_promised: true,
};
