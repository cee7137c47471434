//! GGX: Trowbridge & Reitz 1975; Walter et al. 2007, eq. 33. Twin of `shaders/ndf/ggx.wgsl`.

use crate::models::{Part, part};
use crate::pair::Half;
use std::f64::consts::FRAC_1_PI;

pub(crate) const PART: Part = part!("ndf/ggx");

/// D(ωm), sr⁻¹.
pub(crate) fn ndf(h: &Half, hz2: f64, alpha: f64) -> f64 {
    let q = h.h2 / (alpha * hz2 + h.ht2 / alpha);
    q * q * FRAC_1_PI
}

/// r at which tan θm reaches `t_max`, where tan θm = α sinh v and v = 4 artanh r.
pub(crate) fn map_end(t_max: f64, alpha: f64) -> f64 {
    const TAN_CAP: f64 = 1e9;
    let sinh_v = (t_max / alpha).min(TAN_CAP);
    let cosh_v = (1.0 + sinh_v * sinh_v).sqrt();
    sinh_v / (1.0 + cosh_v) / (1.0 + (2.0 / (1.0 + cosh_v)).sqrt())
}

/// (tan θm, w dv/dr) at r, where D cos θm dωm = w dv dφ / 2π.
pub(crate) fn map(r: f64, alpha: f64) -> [f64; 2] {
    let r2 = r * r;
    let q = 2.0 * r / (1.0 + r2);
    let g = (1.0 - r2) / (1.0 + r2);
    let sech = g * g / (1.0 + q * q);
    let tanh = 2.0 * q / (1.0 + q * q);
    [alpha * 2.0 * q / (g * g), 8.0 * tanh * sech * sech / (1.0 - r2)]
}
