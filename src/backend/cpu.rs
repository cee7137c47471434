//! The CPU path: the same rules as the kernels, in f64, on all cores.

#[cfg(feature = "batch")]
use crate::base::error::Result;
use crate::integrate::evaluate;
use crate::integrate::rule_set::{RuleKind, RuleSet};
use crate::model::lobe::Lobe;
use crate::plan::TablePlan;
use rayon::prelude::*;

/// Evaluates the values of a table, row-major, channels last.
///
/// It calls `tick` as it goes on, with a share of 1; an error from `tick` stops it.
pub(crate) fn evaluate<E: Send>(
    table: &TablePlan,
    tick: &(impl Fn(f64) -> Result<(), E> + Sync),
) -> Result<Vec<f64>, E> {
    let channels = table.channels().len();
    let mut sums = vec![0.0; table.texels() * channels];
    let share = 1.0 / table.lobes().len() as f64;
    for lobe in table.lobes() {
        let rules = RuleSet::new(table, lobe);
        match &rules.kind {
            RuleKind::Values(values) => {
                let rows = rules.alphas.len() * values.rows();
                sums.par_chunks_mut(values.columns() * channels).enumerate().try_for_each(|(row, out)| {
                    add_row(out, lobe, &rules, row);
                    tick(share / rows as f64)
                })?;
            }
            RuleKind::Integrals { inner, outer } => {
                let texels = evaluate::texels(&rules, inner, outer, lobe, &|part| tick(share * part))?;
                sums.chunks_mut(channels).zip(texels).for_each(|(out, sum)| add(out, lobe, sum));
            }
        }
    }
    Ok(sums)
}

/// Evaluates a table of values tile by tile, and hands each of `tiles` to `sink` in order. A tile is a range of rows: all
/// azimuths of an α and a pair.
#[cfg(feature = "batch")]
pub(crate) fn stream(
    table: &TablePlan,
    tiles: &[std::ops::Range<usize>],
    sink: &mut dyn FnMut(usize, &[f32]) -> Result<()>,
) -> Result<()> {
    let row = table.axes().last().map_or(1, |axis| axis.len()) * table.channels().len();
    let rule_sets: Vec<_> = table.lobes().iter().map(|lobe| (lobe, RuleSet::new(table, lobe))).collect();
    for (k, tile) in tiles.iter().enumerate() {
        let mut sums = vec![0.0; tile.len() * row];
        sums.par_chunks_mut(row).zip(tile.clone()).for_each(|(out, row)| {
            rule_sets.iter().for_each(|(lobe, rules)| add_row(out, lobe, rules, row));
        });
        let values: Vec<_> = sums.into_iter().map(|x| x as f32).collect();
        sink(k, &values)?;
    }
    Ok(())
}

/// Adds a lobe to a row of values.
fn add_row(out: &mut [f64], lobe: &Lobe, rules: &RuleSet, row: usize) {
    let RuleKind::Values(values) = &rules.kind else { return };
    let setting = lobe.setting(rules.alphas[row / values.rows()]);
    let (pair, phi_i) = values.pair_and_phi(row % values.rows());
    let scale = rules.scales.get(row / values.rows()).map_or(1.0, |scale| scale.value(pair.mu_i, pair.mu_e));
    for (azimuth, out) in values.azimuths[phi_i].iter().zip(out.chunks_mut(lobe.weights().len())) {
        add(out, lobe, (lobe.model().lobe)(pair, azimuth, &setting).map(|x| scale * x));
    }
}

/// Adds the weighted components (A, B) of a lobe to the channels.
fn add(out: &mut [f64], lobe: &Lobe, [a, b]: [f64; 2]) {
    for (out, [weight_a, weight_b]) in out.iter_mut().zip(lobe.weights()) {
        *out += weight_a * a + weight_b * b;
    }
}
