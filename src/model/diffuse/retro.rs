//! What the forms of Oren and Nayar's model share. Twin of `shaders/diffuse/retro.wgsl`.

use crate::base::half_angle::{Azimuth, Pair};
use crate::model::{Part, part};

pub(super) const PART: Part = part!("diffuse/retro");

/// max(0, s)/t = sin α tan β max(0, cos(φi − φe)).
pub(super) fn retro(p: &Pair, a: &Azimuth) -> f64 {
    p.ss * a.back / p.mu_i.max(p.mu_e)
}

/// 1 + s/t ≥ 0.
pub(super) fn one_plus_s_over_t(p: &Pair, a: &Azimuth) -> f64 {
    let ahead = 2.0 * (p.sd + p.ss * a.sin2) + p.mu_i * p.mu_e;
    if a.back > 0.0 { 1.0 + retro(p, a) } else { ahead }
}
