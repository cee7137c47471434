//! The CPU path: the same rules as the kernels, in f64, on all cores.

#[cfg(feature = "batch")]
use crate::base::error::Error;
use crate::integrate::evaluate;
use crate::integrate::rule_set::{Work, WorkKind};
use crate::model::lobe::Lobe;
use crate::plan::TablePlan;
use rayon::prelude::*;

/// The values of a table, row-major, channels last.
///
/// `tick` is called as work is done, with a share of 1, and stops it by returning an error.
pub(crate) fn evaluate<E: Send>(
    table: &TablePlan,
    tick: &(impl Fn(f64) -> Result<(), E> + Sync),
) -> Result<Vec<f64>, E> {
    let channels = table.channels().len();
    let mut sums = vec![0.0; table.texels() * channels];
    let share = 1.0 / table.lobes().len() as f64;
    for lobe in table.lobes() {
        let work = Work::new(table, lobe);
        match &work.kind {
            WorkKind::Values(values) => {
                let rows = work.alphas.len() * values.rows();
                sums.par_chunks_mut(values.columns() * channels).enumerate().try_for_each(|(row, out)| {
                    add_row(out, lobe, &work, row);
                    tick(share / rows as f64)
                })?;
            }
            WorkKind::Integrals { inner, outer } => {
                let texels = evaluate::texels(&work, inner, outer, lobe, &|part| tick(share * part))?;
                sums.chunks_mut(channels).zip(texels).for_each(|(out, sum)| add(out, lobe, sum));
            }
        }
    }
    Ok(sums)
}

/// The values of some rows of a table of values at a time (a row is all azimuths of an α and a pair):
/// `sink` gets each of `tiles` in order.
#[cfg(feature = "batch")]
pub(crate) fn stream(
    table: &TablePlan,
    tiles: &[std::ops::Range<usize>],
    sink: &mut dyn FnMut(usize, &[f32]) -> Result<(), Error>,
) -> Result<(), Error> {
    let row = table.axes().last().map_or(1, |axis| axis.len()) * table.channels().len();
    let works: Vec<_> = table.lobes().iter().map(|lobe| (lobe, Work::new(table, lobe))).collect();
    for (k, tile) in tiles.iter().enumerate() {
        let mut sums = vec![0.0; tile.len() * row];
        sums.par_chunks_mut(row).zip(tile.clone()).for_each(|(out, row)| {
            works.iter().for_each(|(lobe, work)| add_row(out, lobe, work, row));
        });
        let values: Vec<_> = sums.into_iter().map(|x| x as f32).collect();
        sink(k, &values)?;
    }
    Ok(())
}

fn add_row(out: &mut [f64], lobe: &Lobe, work: &Work, row: usize) {
    let WorkKind::Values(values) = &work.kind else { return };
    let setting = lobe.setting(work.alphas[row / values.rows()]);
    let (pair, frame) = values.place(row % values.rows());
    let scale = work.scales.get(row / values.rows()).map_or(1.0, |scale| scale.at(pair.mu_i, pair.mu_e));
    for (azimuth, out) in values.frames[frame].iter().zip(out.chunks_mut(lobe.weights().len())) {
        add(out, lobe, (lobe.model().lobe)(pair, azimuth, &setting).map(|x| scale * x));
    }
}

fn add(out: &mut [f64], lobe: &Lobe, [a, b]: [f64; 2]) {
    for (out, [weight_a, weight_b]) in out.iter_mut().zip(lobe.weights()) {
        *out += weight_a * a + weight_b * b;
    }
}
