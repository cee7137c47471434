//! GGX: Trowbridge & Reitz 1975; Walter et al. 2007, eq. 33. Twin of `shaders/ndf/ggx.wgsl`.

use crate::models::{Part, part};
use crate::pair::Half;
use std::f64::consts::FRAC_1_PI;

pub(crate) const PART: Part = part!("ndf/ggx");

/// D(ωm), sr⁻¹.
pub(crate) fn ndf(h: &Half, hz2: f64, alpha: f64) -> f64 {
    let q = alpha * h.h2 / (alpha * alpha * hz2 + h.ht2);
    q * q * FRAC_1_PI
}

/// Beyond it, in units of α, the lobe holds 1e-18 of its weight.
pub(crate) const TAN_CAP: f64 = 1e9;

/// A map's tan θm = p/m at r, and `weight` = w dv/dr / m, where D cos θm dωm = w dv dφ / 2π.
pub(crate) struct Map {
    pub p: f64,
    pub m: f64,
    pub weight: f64,
}
