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

/// r at which tan θm reaches `t_max`, where tan θm = α sinh v and v = 8 artanh r.
pub(crate) fn map_end(t_max: f64, alpha: f64) -> f64 {
    const TAN_CAP: f64 = 1e9;
    let sinh_v = (t_max / alpha).min(TAN_CAP);
    let cosh_2 = (0.5 + 0.5 * (1.0 + sinh_v * sinh_v).sqrt()).sqrt();
    let cosh_4 = (0.5 + 0.5 * cosh_2).sqrt();
    0.25 * sinh_v / (cosh_2 * cosh_4 * (1.0 + cosh_4))
}

/// tan θm = p/m and w dv/dr = weight/divisor at r, where D cos θm dωm = w dv dφ / 2π.
pub(crate) struct Map {
    pub p: f64,
    pub m: f64,
    pub weight: f64,
    pub divisor: f64,
}

pub(crate) fn map(r: f64, alpha: f64) -> Map {
    let r2 = r * r;
    let (a, b) = (1.0 + r2, 1.0 - r2);
    let ra = 4.0 * r * a;
    let s = a * a + 4.0 * r2;
    let q = 2.0 * ra * s;
    let b4 = b * b * b * b;
    let cosh = s * s + ra * ra;
    Map { p: alpha * q, m: b4, weight: 16.0 * q * b4 * b * b * b, divisor: cosh * cosh * cosh }
}
