//! cosⁿθm with n = 2/α² − 2, the lobe of Blinn and of his successors. Twin of `shaders/classic/cosine.wgsl`.

use crate::base::half_angle::Half;
use crate::model::directions::{Fixed, Sample};
use crate::model::half_vector;
use crate::model::half_vector::{Kinks, Normal, Normals, directions};
use crate::model::ndf::beckmann;
use crate::model::parameters::Setting;
use crate::model::{Part, SlopeCounts, part};
use std::f64::consts::TAU;

pub(super) const PART: Part = part!("classic/cosine", "elementary");

/// The relative error of such a lobe's values in f32, in units of 2⁻²⁴: the 40 of every lobe, and of the exponent
/// n/2 ln(1 + tan²θm) fourteen roundings (four of n, four of tan²θm, six of the logarithm), which is 128 at most where
/// f is above 1e-30 sr⁻¹.
pub(super) const COSINE_F32: f64 = (40.0 + 14.0 * 128.0) / (1 << 24) as f64;

/// The root of cosⁿθm.
pub(super) fn root_of_power(h: &Half, hz2: f64, &Setting { alpha, .. }: &Setting) -> f64 {
    let n_half = (1.0 - alpha) * (1.0 + alpha) / (alpha * alpha);
    (-0.5 * n_half * (h.ht2 / hz2).ln_1p()).exp()
}

/// Directions, by cos^(n+1) θm = e^(−r²), the share of the normals beyond θm, up to 1e-13 of it: that is
/// tan²θm = e^(k r²) − 1 with k = 2/(n + 1) = 2α²/(2 − α²), analytic for any n.
pub(super) fn samples(fixed: &Fixed, s: &Setting, tolerance: f64, kinks: Kinks) -> Vec<Sample> {
    let a2 = s.alpha * s.alpha;
    let k = 2.0 * a2 / (2.0 - a2);
    let at = |r: f64| {
        // sin θm dθm = −d cos θm, cos θm = e^(−k r²/2)
        let solid_angle = TAU * k * r * (-0.5 * k * r * r).exp();
        Normal { p: (k * r * r).exp_m1().sqrt(), m: 1.0, solid_angle }
    };
    let end = |t: f64| ((t * t).ln_1p() / k).sqrt().min(5.5);
    directions(fixed, [counts(tolerance); 2], tolerance, &Normals { end: &end, at: &at, kinks, turn: None })
}

pub(super) fn most(tolerance: f64, kinks: &Kinks) -> usize {
    half_vector::most(kinks, [counts(tolerance); 2])
}

/// What Beckmann takes, to which this tends as n grows, and where its tolerance is coarse some more: measured.
fn counts(tolerance: f64) -> SlopeCounts {
    beckmann::counts(tolerance).at_least([4, 4], tolerance)
}
