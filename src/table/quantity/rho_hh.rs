//! The hemispherical-hemispherical reflectance, or average albedo.

use crate::table::ErrorKind;
use crate::table::quantity::{Evaluation, Limits, Quantity};

/// ρ_hh = 2 ∫ ρ_dh(μ) μ dμ.
pub static RHO_HH: Quantity = Quantity {
    name: "rho_hh",
    symbol: "ρ_hh",
    unit: "1",
    summary: "hemispherical-hemispherical reflectance, the cosine-weighted mean of rho_dh",
    variables: &[],
    anisotropic_variables: &[],
    error: ErrorKind::Absolute,
    evaluation: Evaluation::Hemispherical,
    limits: Limits::Reflectance,
    is_promised: true,
};
