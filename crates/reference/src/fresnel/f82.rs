//! Schlick's approximation with a metal's dip.

use crate::fresnel::{Fresnel, schlick};
use crate::setting::Parameters;

/// Kutz, Hašan & Edmondson 2021: F = S − (1 − f82) S(c̄) M with Schlick's S, c̄ = 1/7 and
/// M = c (1 − c)⁶ / (c̄ (1 − c̄)⁶), by what F0 and F90 weigh in S.
pub(crate) struct F82;

impl Fresnel for F82 {
    fn weights(&self, cos_d: f64, one_minus_cos_d: f64, p: &Parameters) -> [f64; 2] {
        let dip = (1.0 - p.f82) * cos_d * one_minus_cos_d.powi(6) / PEAK;
        subtracted(schlick::weights(cos_d, one_minus_cos_d), dip)
    }

    /// 2 ∫ μ (1 − μ)⁶ μ dμ = 2 · 2! 6!/9! = 1/126.
    fn mean(&self, p: &Parameters) -> [f64; 2] {
        subtracted([20.0 / 21.0, 1.0 / 21.0], (1.0 - p.f82) / (126.0 * PEAK))
    }
}

fn subtracted([a, b]: [f64; 2], dip: f64) -> [f64; 2] {
    let [a_there, b_there] = schlick::weights(1.0 / 7.0, 6.0 / 7.0);
    [a - dip * a_there, b - dip * b_there]
}

/// c̄ (1 − c̄)⁶ = 6⁶/7⁷.
const PEAK: f64 = 46_656.0 / 823_543.0;
