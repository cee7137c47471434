//! Where over the hemispheres: the largest error over δφ, for each θi and θe.

use crate::base::angles::Angles;
use crate::base::error::Result;
use crate::lab::atlas::band::{BandSubject, floor};
use rayon::prelude::*;
use serde::Serialize;
use std::f64::consts::{FRAC_PI_2, PI};

/// A table of errors.
#[derive(Debug, Clone, Serialize)]
pub struct ErrorMap {
    /// At this α, the worst; none for a model without.
    pub alpha: Option<f64>,
    /// θi and θe, rad, both ends of [0, π/2] included.
    pub thetas: Vec<f64>,
    /// For each θi and then each θe: the largest relative error over δφ and components.
    pub errors: Vec<Vec<f64>>,
    /// The same in the middle: the median.
    pub medians: Vec<Vec<f64>>,
}

/// Samples of θ: whole degrees.
const SIZE: usize = 91;
/// δφ: the peak, all magnitudes from 1e-7, and backwards.
const DELTAS: usize = 24;

pub(super) fn measure(subject: &mut BandSubject, alpha: f64, shown: Option<f64>) -> Result<ErrorMap> {
    let theta = |k: usize| FRAC_PI_2 * (k as f64 / (SIZE - 1) as f64);
    let thetas: Vec<_> = (0..SIZE).map(theta).collect();
    let delta =
        |k: usize| if k == 0 { 0.0 } else { PI * 10f64.powf(-7.5 * (1.0 - k as f64 / (DELTAS - 1) as f64)) };
    let (mut errors, mut medians, mut values) = (Vec::new(), Vec::new(), Vec::new());
    for &theta_i in &thetas {
        let row = thetas.iter().flat_map(|&theta_e| {
            (0..DELTAS).map(move |k| Angles { theta_i, phi_i: 0.0, theta_e, phi_e: PI + delta(k) })
        });
        let row: Vec<_> = row.collect();
        (subject.evaluate)(&[alpha], &row, &mut values)?;
        let BandSubject { reference, channels, faint, .. } = *subject;
        let found: Vec<f64> = row
            .par_iter()
            .zip(values.par_chunks_exact(channels))
            .map(|(angles, values)| {
                let truth = reference(angles, alpha);
                let error = |(&value, truth_of): (&f32, f64)| {
                    let error = (f64::from(value) - truth_of).abs() / truth_of.max(floor(truth, faint));
                    if error.is_nan() { f64::INFINITY } else { error }
                };
                values.iter().zip(truth).map(error).fold(0.0, f64::max)
            })
            .collect();
        errors.push(
            found.chunks_exact(DELTAS).map(|found| found.iter().copied().fold(0.0, f64::max)).collect(),
        );
        medians.push(found.chunks_exact(DELTAS).map(middle).collect());
    }
    Ok(ErrorMap { alpha: shown, thetas, errors, medians })
}

fn middle(values: &[f64]) -> f64 {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
