//! What Burley's diffuse lobe and Frostbite's share. Twin of `shaders/diffuse/grazing.wgsl`.

use crate::models::{Part, part};
use crate::pair::{Azimuth, Pair};

pub(super) const PART: Part = part!("diffuse/grazing");

/// ωi·ωm squared, cos² θd.
pub(super) fn cos2_d(p: &Pair, a: &Azimuth) -> f64 {
    p.dt2 + p.ss * a.sin2 + p.hz2
}

/// 1 + (F90 − 1)(1 − μ)⁵.
pub(super) fn scatter(mu: f64, f90: f64) -> f64 {
    let x = 1.0 - mu;
    let x2 = x * x;
    mu * (1.0 + x + x2 * (1.0 + x + x2)) + f90 * (x2 * x2 * x)
}
