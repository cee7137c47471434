//! The cross-check: a table's texels against the f64 reference.

use crate::base::angles::delta_phi;
use crate::base::error::Result;
use crate::base::sequence::stride;
use crate::base::tolerance::REFERENCE_SHARE;
use crate::check::reference::{ReferenceLobe, reference_of_model};
use crate::model::lobe::Lobe;
use crate::plan::TablePlan;
use crate::table::axis::{Axis, Variable};
use crate::table::quantity::{Evaluation, Quantity};
use crate::table::{Check, TableError, Values, indices};
use gonio_reference::Angles;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// Compares `values` with the reference. A NaN anywhere makes the largest error infinite.
///
/// It calls `tick` between comparisons, with a share of 1; an error from `tick` stops it.
pub fn cross_check(
    table: &TablePlan,
    values: &Values,
    check: Check,
    estimate: Option<f64>,
    tick: &(impl Fn(f64) -> Result<()> + Sync),
) -> Result<TableError> {
    let mut comparison = Comparison::new(table, check, estimate);
    comparison.add(0..table.texels(), &|k| values.get(k), tick)?;
    Ok(comparison.finish())
}

/// A comparison of a table that arrives piece by piece, in order. It compares the same texels and adds the same sums, and
/// so finds the same error, as a comparison of the whole.
pub(crate) struct Comparison<'a> {
    table: &'a TablePlan,
    /// The texels to compare, sorted; `None`: all of them.
    sample: Option<Vec<usize>>,
    /// The absolute error that the reference's integrals may have.
    reference_error: f64,
    tally: ErrorTally,
}

/// The texels of other tables that a mean over all directions of an anisotropic lobe counts for: its reference integrates over
/// four angles.
const MEAN_COST: usize = 256;

/// Whether a table has means over all directions of an anisotropic lobe.
pub(super) fn is_anisotropic_mean(table: &TablePlan) -> bool {
    let is_mean = table.quantity().evaluation == Evaluation::Hemispherical;
    is_mean && table.lobes().iter().any(|lobe| lobe.model().is_anisotropic())
}

/// At most so many texels, as far apart as they can be: the middle one of a table, first of all.
fn evenly(texels: usize, count: usize) -> Vec<usize> {
    let count = count.min(texels);
    (0..count).map(|k| (2 * k + 1) * texels / (2 * count)).collect()
}

impl<'a> Comparison<'a> {
    pub fn new(table: &'a TablePlan, check: Check, estimate: Option<f64>) -> Self {
        let known = table.lobes().iter().all(|lobe| reference_of_model(lobe.model()).is_some());
        let sample = match check {
            _ if !known => Some(Vec::new()),
            Check::All => None,
            Check::Sample(n) if is_anisotropic_mean(table) => {
                Some(evenly(table.texels(), n.div_ceil(MEAN_COST)))
            }
            Check::Sample(n) => Some(sample(&table.shape(), n)),
        };
        let reference_error = reference_error(table, check);
        let tally = ErrorTally::new(table.unmeasured(estimate));
        Self { table, sample, reference_error, tally }
    }

    /// Compares the texels of `piece`; `value` returns the piece's values, counted from 0. The next piece must begin where
    /// this one ends.
    pub fn add(
        &mut self,
        piece: Range<usize>,
        value: &(impl Fn(usize) -> f64 + Sync),
        tick: &(impl Fn(f64) -> Result<()> + Sync),
    ) -> Result<()> {
        let table = self.table;
        let channels = table.channels().len();
        let (texels, all): (Vec<_>, _) = match &self.sample {
            None => (piece.clone().collect(), table.texels()),
            Some(sample) => {
                let first_from = |texel| sample.partition_point(|&t| t < texel);
                (sample[first_from(piece.start)..first_from(piece.end)].to_vec(), sample.len())
            }
        };
        let share = 1.0 / all as f64;
        let compared = texels
            .par_iter()
            .map(|&texel| {
                let truth = reference_within(table, texel, self.reference_error);
                let values = ((texel - piece.start) * channels..).map(value);
                let channels: Vec<_> =
                    truth.into_iter().zip(values).map(|(truth, value)| (value, truth)).collect();
                tick(share)?;
                Ok((texel, channels))
            })
            .collect::<Result<Vec<_>>>()?;
        compared.into_iter().for_each(|(texel, channels)| self.tally.add(table.axes(), texel, channels));
        Ok(())
    }

    /// The error over all texels that were added.
    pub fn finish(self) -> TableError {
        self.tally.finish()
    }
}

/// The running error of a table against the truth: the largest difference, its coordinates, and the mean square.
pub(crate) struct ErrorTally {
    error: TableError,
    squares: f64,
    compared: usize,
}

impl ErrorTally {
    /// An empty tally; `error` says whether differences are absolute or relative.
    pub fn new(error: TableError) -> Self {
        Self { error, squares: 0.0, compared: 0 }
    }

    /// Adds a texel: for each channel its value and the truth. A NaN is an infinite difference.
    pub fn add(&mut self, axes: &[Axis], texel: usize, channels: impl IntoIterator<Item = (f64, f64)>) {
        let Self { error, squares, compared } = self;
        error.texels_checked += 1;
        for (channel, (value, truth)) in channels.into_iter().enumerate() {
            let difference = (value - truth).abs();
            let difference = error.floor.map_or(difference, |floor| difference / truth.abs().max(floor));
            let difference = if difference.is_nan() { f64::INFINITY } else { difference };
            *squares += difference * difference;
            *compared += 1;
            if error.measured_max.is_none_or(|max| difference >= max) {
                error.measured_max = Some(difference);
                let shape: Vec<_> = axes.iter().map(Axis::len).collect();
                let coordinates = axes.iter().zip(indices(&shape, texel));
                error.worst =
                    coordinates.map(|(axis, k)| (axis.variable().name().into(), axis.values()[k])).collect();
                error.worst.insert("channel".into(), channel as f64);
                error.worst.insert("value".into(), value);
                error.worst.insert("reference".into(), truth);
            }
        }
    }

    /// The error over all texels that were added.
    pub fn finish(mut self) -> TableError {
        if self.compared > 0 {
            self.error.measured_rms = Some((self.squares / self.compared as f64).sqrt());
        }
        self.error
    }
}

/// The absolute error that the reference's integrals may have in a check of a table.
pub(crate) fn reference_error(table: &TablePlan, check: Check) -> f64 {
    match check {
        Check::All => 0.0,
        Check::Sample(_) => REFERENCE_SHARE * table.tolerance(),
    }
}

/// Computes the channels of one texel by the reference; NaN where the reference has no value.
pub fn reference(table: &TablePlan, texel: usize) -> Vec<f64> {
    reference_within(table, texel, 0.0)
}

/// The same with integrals to an absolute error of `error` for each lobe of weight 1.
pub(crate) fn reference_within(table: &TablePlan, texel: usize, error: f64) -> Vec<f64> {
    let coordinates: BTreeMap<_, _> = table
        .axes()
        .iter()
        .zip(indices(&table.shape(), texel))
        .map(|(axis, k)| (axis.variable(), axis.values()[k]))
        .collect();
    let mut channels = vec![0.0; table.channels().len()];
    for lobe in table.lobes() {
        let [a, b] = reference_components(table.quantity(), lobe, &coordinates, error);
        for (channel, [weight_a, weight_b]) in channels.iter_mut().zip(lobe.weights()) {
            *channel += weight_a * a + weight_b * b;
        }
    }
    channels
}

/// Computes the components (A, B) of a lobe at a texel's coordinates by the reference; NaN where the reference has no
/// value, which no comparison calls right.
fn reference_components(
    quantity: &Quantity,
    lobe: &Lobe,
    coordinates: &BTreeMap<Variable, f64>,
    error: f64,
) -> [f64; 2] {
    let get = |variable| coordinates.get(&variable).copied();
    let Some(reference) = ReferenceLobe::within(lobe, get(Variable::Roughness), error) else {
        return [f64::NAN; 2];
    };
    let theta_i = get(Variable::ThetaI).unwrap_or(0.0);
    let phi_i = get(Variable::PhiI).unwrap_or(0.0);
    match quantity.evaluation {
        Evaluation::Value => {
            let delta_phi = match get(Variable::PhiE) {
                Some(phi_e) => delta_phi(phi_i, phi_e),
                None => get(Variable::DeltaPhi).unwrap_or(0.0),
            };
            let theta_e = get(Variable::ThetaE).unwrap_or(0.0);
            reference.brdf(&Angles { theta_i, theta_e, delta_phi, phi_i }).unwrap_or([f64::NAN; 2])
        }
        Evaluation::Directional(fixed) => {
            // μ of the direction that an integral keeps.
            let zenith = quantity.variables.first().and_then(|&variable| Some((variable, get(variable)?)));
            let mu = zenith.map_or(1.0, |(variable, value)| variable.cosine(value));
            reference.rho_dh(mu, phi_i, fixed)
        }
        Evaluation::Hemispherical => reference.rho_hh(),
        Evaluation::Light => [f64::NAN; 2],
    }
}

/// Chooses at least `n` different texels: every corner of the axes, where extremes meet, and steps of the golden section
/// through the rest.
pub(crate) fn sample(shape: &[usize], n: usize) -> Vec<usize> {
    let texels: usize = shape.iter().product();
    if n == 0 {
        return Vec::new();
    }
    if n >= texels {
        return (0..texels).collect();
    }
    let mut chosen = BTreeSet::new();
    for corner in 0..1usize << shape.len() {
        let index = |(k, &count): (usize, &usize)| if corner >> k & 1 == 1 { count - 1 } else { 0 };
        chosen.insert(
            shape.iter().enumerate().map(|axis| (index(axis), axis.1)).fold(0, |flat, (k, n)| flat * n + k),
        );
    }
    let stride = stride(texels);
    let mut texel = 0;
    while chosen.len() < n {
        texel = (texel + stride) % texels;
        chosen.insert(texel);
    }
    chosen.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model;
    use crate::table::quantity;

    #[test]
    fn a_sample_has_the_corners_and_no_repeats() {
        let chosen = sample(&[7, 9, 11], 100);
        assert_eq!(chosen.len(), 100);
        assert!([0, 10, 7 * 9 * 11 - 1, 6 * 9 * 11].iter().all(|corner| chosen.contains(corner)));
        assert_eq!(sample(&[2, 3], 256), (0..6).collect::<Vec<_>>());
    }

    #[test]
    fn the_comparer_sees_one_bad_texel_and_nan() {
        let axes = vec![Axis::natural(Variable::ThetaI, 40).unwrap()];
        let lambert = model::find("lambert").unwrap();
        let table = TablePlan::basis("t", &quantity::RHO_DH, lambert, None, axes).unwrap();
        let mut values = vec![1.0; 40];
        let check = |values: &[f32]| {
            cross_check(&table, &values.to_vec().into(), Check::All, None, &|_| Ok(())).unwrap()
        };
        assert!(check(&values).measured_max.unwrap() < 1e-9);
        values[17] = 1.001;
        let error = check(&values);
        assert!((error.measured_max.unwrap() - 1e-3).abs() < 1e-6);
        assert_eq!(error.worst["theta_i"], table.axes()[0].values()[17]);
        values[17] = f32::NAN;
        assert_eq!(check(&values).measured_max, Some(f64::INFINITY));
    }
}
