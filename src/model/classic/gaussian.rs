//! exp(−tan²θm/α²), the lobe of Ward and of his successors.

use crate::model::SlopeCounts;
use crate::model::directions::{Fixed, Sample};
use crate::model::half_vector::{Kinks, Normal, Normals, directions};
use crate::model::parameters::Setting;
use std::f64::consts::TAU;

/// The relative error of such a lobe's values in f32, in units of 2⁻²⁴: the 40 of every lobe, and of the exponent
/// five roundings, which is 128 at most where f is above 1e-30 sr⁻¹.
pub(super) const GAUSSIAN_F32: f64 = (40.0 + 5.0 * 128.0) / (1 << 24) as f64;

/// Directions: tan θm = α r, up to where the rest, e^(−r²), is 1e-13.
pub(super) fn samples(
    fixed: &Fixed,
    &Setting { alpha, .. }: &Setting,
    tolerance: f64,
    counts: SlopeCounts,
    kinks: Kinks,
) -> Vec<Sample> {
    let at = |r: f64| {
        // sin θm dθm = t / (1 + t²)^(3/2) dt
        let t = alpha * r;
        Normal { p: t, m: 1.0, solid_angle: TAU * alpha * t / (1.0 + t * t).powf(1.5) }
    };
    let end = |t_max: f64| (t_max / alpha).min(5.5);
    directions(fixed, [counts; 2], tolerance, &Normals { end: &end, at: &at, kinks, turn: None })
}
