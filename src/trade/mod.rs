//! The trade-off: one table by every method at every cost, its time and its error, on one device in one
//! run, and which of them nobody beats in both.

mod candidates;
mod floor;
mod front;
mod subset;
#[cfg(feature = "files")]
mod write;

pub use floor::Floor;
pub use front::front;
#[cfg(feature = "files")]
pub use write::write;

use crate::bake::{Evaluator, Observer};
use crate::check;
use crate::cpu;
use crate::error::{Error, Result};
use crate::gpu::Timing;
use crate::plan::{Precision, TablePlan};
use crate::quantity::Evaluation;
use crate::table::Values;
use candidates::{Candidate, candidates};
use rayon::prelude::*;
use serde::Serialize;
use std::collections::HashMap;
use std::time::Instant;
use subset::Subset;

/// How much to measure.
#[derive(Debug, Clone, Copy)]
pub struct Options {
    /// Seconds, as a device of 10⁸ evaluations a second would need them: which points are measured, and on
    /// which texels, must not depend on the clock.
    pub budget: f64,
    /// Compare every texel of what was run in full, not only the subset's.
    pub check_all: bool,
}

impl Options {
    /// No more steps than an observer is told of: the reference, and each method at each cost.
    pub fn steps(&self) -> usize {
        1 + candidates::methods().iter().map(Vec::len).sum::<usize>()
    }
}

/// What was measured.
#[derive(Debug, Clone, Serialize)]
pub struct Trade {
    /// The table, in words.
    pub table: String,
    /// Samples along its axes, slowest first.
    pub shape: Vec<usize>,
    /// Texels of the subset whose error every method is judged by, and how they were chosen.
    pub subset_texels: usize,
    /// The same in words.
    pub subset: String,
    /// What the device can do at most; not on the CPU path.
    pub floor: Option<Floor>,
    /// The points, method by method, the cheapest first.
    pub points: Vec<Point>,
    /// What was not measured, and why.
    pub left_out: Vec<String>,
}

/// One method at one cost.
#[derive(Debug, Clone, Serialize)]
pub struct Point {
    /// The rule's name.
    pub method: &'static str,
    /// Its tolerance, nodes or samples.
    pub setting: String,
    /// The arithmetic: `f32` or `f64`.
    pub precision: &'static str,
    /// Texels that were computed: all, or the subset's.
    pub texels: usize,
    /// Evaluations of the integrand for these texels.
    pub evaluations: u64,
    /// Runs that were timed, after one that was not.
    pub runs: usize,
    /// The median of their times for these texels, s.
    pub seconds: f64,
    /// The shortest, s.
    pub seconds_min: f64,
    /// The longest, s.
    pub seconds_max: f64,
    /// The median for the whole table, s: extrapolated where only the subset was computed.
    pub table_seconds: f64,
    /// Whether it is.
    pub extrapolated: bool,
    /// Seconds of the host before that: nodes, factors, upload. On the CPU path they are part of the time.
    pub prepare: f64,
    /// The largest difference to the reference, over `checked` texels.
    pub max_error: f64,
    /// The root mean square of the differences.
    pub rms_error: f64,
    /// Texels compared.
    pub checked: usize,
    /// The share of the time that the device could not do without: see [`Floor`].
    pub floor_share: Option<f64>,
    /// Whether no measured point is both faster and more exact; extrapolated ones do not take part.
    pub on_front: bool,
}

/// Measures the trade-off of a table of integrals.
///
/// # Errors
/// When the table is one of values, the device fails, or the observer stops it.
pub fn measure(
    table: &TablePlan,
    evaluator: &Evaluator,
    options: &Options,
    observer: &dyn Observer,
) -> Result<Trade> {
    if table.quantity.evaluation == Evaluation::Value {
        let why =
            "values are not integrated and have no methods to compare; give rho_dh, rho_hh or split_sum";
        return Err(Error::input(format!("table \"{}\": {why}", table.name)));
    }
    let subset = Subset::new(table)?;
    let (candidates, mut left_out) = candidates(table, &subset.plan, options.budget);
    observer.begin("computing the reference");
    let truth = Truth::new(table, &subset, options.check_all, &|share| observer.advance(share))?;
    let rates = match evaluator {
        Evaluator::Device(device) => Some(device.rates()?),
        Evaluator::Cpu => None,
    };
    let start = Instant::now();
    let mut points = Vec::new();
    for candidate in candidates {
        observer.begin(&format!("{} {}", candidate.method, candidate.setting));
        let more = |runs: &[f64]| -> Result<bool> {
            observer.advance(0.0)?;
            Ok(enough_patience(runs, start.elapsed().as_secs_f64() < options.budget))
        };
        let precision = match evaluator {
            Evaluator::Device(device) if candidate.precision == Precision::F64 && !device.has_f64() => {
                left_out.push(format!("{} {}: the device has no f64", candidate.method, candidate.setting));
                continue;
            }
            Evaluator::Device(_) => candidate.precision,
            Evaluator::Cpu => Precision::F64,
        };
        let timing = time(evaluator, &candidate.plan, precision, &more)?;
        points.push(truth.point(table, &subset, candidate, timing, precision, rates));
    }
    let places: Vec<_> = points.iter().map(|p| (p.table_seconds, p.max_error, !p.extrapolated)).collect();
    for (point, on_front) in points.iter_mut().zip(front(&places)) {
        point.on_front = on_front;
    }
    Ok(Trade {
        table: table.to_string(),
        shape: table.shape(),
        subset_texels: subset.texels.len(),
        subset: subset.to_string(),
        floor: rates.map(Floor::new),
        points,
        left_out,
    })
}

/// Whether one more run is worth its time: 3 at least, up to 21 while they are short; 1 will do once the
/// budget is spent. The number of runs changes no result.
fn enough_patience(runs: &[f64], in_budget: bool) -> bool {
    const SHORT: f64 = 0.3;
    let least = if in_budget { 3 } else { 1 };
    runs.len() < least || in_budget && runs.len() < 21 && runs.iter().sum::<f64>() < SHORT
}

fn time(
    evaluator: &Evaluator,
    plan: &TablePlan,
    precision: Precision,
    more: &dyn Fn(&[f64]) -> Result<bool>,
) -> Result<Timing> {
    match evaluator {
        Evaluator::Device(device) => device.time(plan, precision, more),
        Evaluator::Cpu => {
            let start = Instant::now();
            plan.lobes.iter().for_each(|lobe| drop(crate::work::Work::new(plan, lobe)));
            let prepare = start.elapsed().as_secs_f64();
            let run = || cpu::evaluate(plan, &|_| Ok::<_, Error>(()));
            let mut values = run()?;
            let mut runs = Vec::new();
            while more(&runs)? {
                let start = Instant::now();
                values = run()?;
                runs.push(start.elapsed().as_secs_f64());
            }
            Ok(Timing { prepare, runs, values: Values::F64(values) })
        }
    }
}

/// The reference's channels, by texel of the whole table.
struct Truth(HashMap<usize, Vec<f64>>);

impl Truth {
    fn new(
        table: &TablePlan,
        subset: &Subset,
        all: bool,
        tick: &(impl Fn(f64) -> Result<()> + Sync),
    ) -> Result<Self> {
        if table.lobes.iter().any(|lobe| lobe.model.reference.is_none()) {
            return Err(Error::input(format!(
                "table \"{}\": a lobe has no reference to compare with",
                table.name
            )));
        }
        let texels = if all { (0..table.texels()).collect() } else { subset.texels.clone() };
        let share = 1.0 / texels.len() as f64;
        let of = |&texel: &usize| {
            tick(share)?;
            Ok((texel, check::reference(table, texel)))
        };
        Ok(Self(texels.par_iter().map(of).collect::<Result<_>>()?))
    }

    /// A point, from its values and times.
    fn point(
        &self,
        table: &TablePlan,
        subset: &Subset,
        candidate: Candidate,
        timing: Timing,
        precision: Precision,
        rates: Option<crate::gpu::Rates>,
    ) -> Point {
        let Candidate { method, setting, plan, whole, evaluations, .. } = candidate;
        let channels = table.channels.len();
        let differences = |(at, texel): (usize, usize)| {
            let truth = self.0[&texel].iter().enumerate();
            truth.map(|(c, truth)| (timing.values.get(at * channels + c) - truth).abs()).collect::<Vec<_>>()
        };
        let checked: Vec<_> = if whole {
            let mut texels: Vec<_> = self.0.keys().map(|&texel| (texel, texel)).collect();
            texels.sort_unstable(); // sums must not depend on the order of a map
            texels
        } else {
            subset.texels.iter().copied().enumerate().collect()
        };
        let differences: Vec<_> = checked.iter().copied().flat_map(differences).collect();
        // A NaN is no small error.
        let seen = |d: f64| if d.is_nan() { f64::INFINITY } else { d };
        let squares: f64 = differences.iter().map(|&d| seen(d * d)).sum();
        let mut runs = timing.runs;
        runs.sort_by(f64::total_cmp);
        let seconds = median(&runs);
        let bytes = plan.texels() * channels * precision.bytes();
        Point {
            method,
            setting,
            precision: precision.name(),
            texels: plan.texels(),
            evaluations,
            runs: runs.len(),
            seconds,
            seconds_min: runs.first().copied().unwrap_or(f64::NAN),
            seconds_max: runs.last().copied().unwrap_or(f64::NAN),
            table_seconds: seconds * table.texels() as f64 / plan.texels() as f64,
            extrapolated: !whole,
            prepare: timing.prepare,
            max_error: differences.iter().copied().map(seen).fold(0.0, f64::max),
            rms_error: (squares / differences.len() as f64).sqrt(),
            checked: checked.len(),
            floor_share: rates.and_then(|rates| {
                let operations = floor::operations(&plan)? * evaluations as f64;
                Some(Floor::new(rates).seconds(bytes as f64, operations) / seconds)
            }),
            on_front: false,
        }
    }
}

/// The middle of a sorted list, or the mean of the two middles.
fn median(sorted: &[f64]) -> f64 {
    match sorted.len() {
        0 => f64::NAN,
        n if n % 2 == 1 => sorted[n / 2],
        n => 0.5 * (sorted[n / 2 - 1] + sorted[n / 2]),
    }
}

impl Trade {
    /// The point of a method at a setting.
    pub fn point(&self, method: &str, setting: &str) -> Option<&Point> {
        self.points.iter().find(|p| p.method == method && p.setting == setting)
    }

    /// The comparisons that matter, in words: with 1024 samples as most bakers take them, and at 1e-4.
    pub fn headlines(&self) -> Vec<String> {
        let ratio = |ours: &Point, theirs: &Point| {
            let label = if theirs.extrapolated { ", extrapolated" } else { "" };
            format!(
                "{} {} takes {:.1} × the time of {} {}{label}: {:.2} against {:.2} ms, with errors of {:.1e} and {:.1e}",
                theirs.method,
                theirs.setting,
                theirs.table_seconds / ours.table_seconds,
                ours.method,
                ours.setting,
                1e3 * theirs.table_seconds,
                1e3 * ours.table_seconds,
                theirs.max_error,
                ours.max_error
            )
        };
        let common = self.point("warped", "1e-6").zip(self.point("hammersley", "1024"));
        let meets = |p: &&Point| p.method == "vndf" && p.max_error <= 1e-4;
        let fastest =
            self.points.iter().filter(meets).min_by(|a, b| a.table_seconds.total_cmp(&b.table_seconds));
        let same_error = self.point("warped", "1e-4").zip(fastest);
        [common, same_error].into_iter().flatten().map(|(ours, theirs)| ratio(ours, theirs)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_in_the_middle() {
        assert_eq!((median(&[1.0, 2.0, 9.0]), median(&[1.0, 2.0, 4.0, 9.0])), (2.0, 3.0));
        assert!(median(&[]).is_nan());
    }

    #[test]
    fn runs_are_three_at_least_and_one_when_late() {
        assert!(enough_patience(&[9.0, 9.0], true) && !enough_patience(&[9.0; 3], true));
        assert!(enough_patience(&[0.01; 20], true) && !enough_patience(&[0.01; 21], true));
        assert!(enough_patience(&[], false) && !enough_patience(&[0.01], false));
    }
}
