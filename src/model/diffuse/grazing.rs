//! What Burley's diffuse lobe and Frostbite's share. Twin of `shaders/diffuse/grazing.wgsl`.

use crate::base::half_angle::{Azimuth, Pair};
use crate::base::tolerance::decade;
use crate::model::{Part, part};

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

/// Nodes in θe and δφ for tolerances 1e-1 … 1e-10, measured (`nodes.rs`): the error of each count alone,
/// worst over θi and the roughness, is below a quarter of the tolerance.
pub(super) fn nodes(tolerance: f64) -> [usize; 2] {
    const COUNTS: [[usize; 2]; 10] =
        [[3, 1], [4, 3], [5, 4], [6, 4], [7, 5], [8, 6], [9, 6], [9, 7], [10, 7], [11, 8]];
    COUNTS[decade(tolerance)]
}
