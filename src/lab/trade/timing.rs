//! Running a table again and again, and looking at the clock.

use crate::backend::cpu;
use crate::backend::gpu;
use crate::bake::Evaluator;
use crate::base::error::{Error, Result};
use crate::base::precision::Precision;
use crate::base::timings::Stopwatch;
use crate::integrate::rule_set::RuleSet;
use crate::plan::TablePlan;
use crate::table::storage::{Storage, Stored};
use crate::table::{ErrorKind, Values};

/// A table, and the time that it took.
pub(super) struct Timing {
    /// Seconds of the host before anything is evaluated. On the CPU path each run has them in it.
    pub prepare: f64,
    /// Seconds, run by run.
    pub runs: Vec<f64>,
    pub values: Values,
}

impl Timing {
    /// With the values that a reader of the stored ones gets; a reason where a format does not hold them.
    pub fn stored(self, storage: Storage, kind: ErrorKind) -> Result<Self, String> {
        let Stored { values, .. } = storage.store(self.values, kind)?;
        Ok(Self { values, ..self })
    }
}

/// A table that is ready to be run.
enum ReadyTable<'a> {
    Device(gpu::WarmTable<'a>),
    Cpu { plan: &'a TablePlan, prepare: f64 },
}

/// Times a table, warm, as often as it is worth. `go_on` stops it by an error.
pub(super) fn time(
    evaluator: &Evaluator,
    plan: &TablePlan,
    precision: Precision,
    in_budget: &dyn Fn() -> bool,
    go_on: &dyn Fn() -> Result<()>,
) -> Result<Timing> {
    let warm = ReadyTable::new(evaluator, plan, precision)?;
    let mut runs = Vec::new();
    while one_more(&runs, in_budget()) {
        go_on()?;
        runs.push(warm.run()?);
    }
    let values = match &warm {
        ReadyTable::Device(warm) => warm.values()?,
        ReadyTable::Cpu { plan, .. } => Values::F64(cpu::evaluate(plan, &|_| Ok::<_, Error>(()))?),
    };
    let (ReadyTable::Device(gpu::WarmTable { prepare, .. }) | ReadyTable::Cpu { prepare, .. }) = warm;
    Ok(Timing { prepare, runs, values })
}

/// The times of two tables that are run in turns, in f32.
pub(super) fn rounds(
    evaluator: &Evaluator,
    plans: [&TablePlan; 2],
    go_on: &dyn Fn() -> Result<()>,
) -> Result<[Vec<f64>; 2]> {
    const ROUNDS: usize = 7;
    let warm = plans.map(|plan| ReadyTable::new(evaluator, plan, Precision::F32));
    let [ours, theirs] = warm;
    let warm = [ours?, theirs?];
    let mut times = [Vec::new(), Vec::new()];
    for _ in 0..ROUNDS {
        go_on()?;
        for (warm, times) in warm.iter().zip(&mut times) {
            times.push(warm.run()?);
        }
    }
    Ok(times)
}

/// Whether one more run is worth its time: 3 at least, 2 of long ones, up to 21 while they are short; 1 will
/// do once the budget is spent. The number of runs changes no result.
fn one_more(runs: &[f64], in_budget: bool) -> bool {
    const SHORT: f64 = 0.3;
    let spent: f64 = runs.iter().sum();
    let least = match in_budget {
        false => 1,
        true if spent > 2.0 * SHORT => 2,
        true => 3,
    };
    runs.len() < least || in_budget && runs.len() < 21 && spent < SHORT
}

/// The middle of a sorted list, or the mean of the two middles.
pub(super) fn median(sorted: &[f64]) -> f64 {
    match sorted.len() {
        0 => f64::NAN,
        n if n % 2 == 1 => sorted[n / 2],
        n => 0.5 * (sorted[n / 2 - 1] + sorted[n / 2]),
    }
}

impl<'a> ReadyTable<'a> {
    fn new(evaluator: &'a Evaluator, plan: &'a TablePlan, precision: Precision) -> Result<Self> {
        Ok(match evaluator {
            Evaluator::Device(device) => Self::Device(device.warm(plan, precision)?),
            Evaluator::Cpu => {
                let start = Stopwatch::start();
                plan.lobes().iter().for_each(|lobe| drop(RuleSet::new(plan, lobe)));
                Self::Cpu { plan, prepare: start.seconds() }
            }
        })
    }

    /// Seconds of one run.
    fn run(&self) -> Result<f64> {
        match self {
            Self::Device(warm) => warm.run(),
            Self::Cpu { plan, .. } => {
                let start = Stopwatch::start();
                cpu::evaluate(plan, &|_| Ok::<_, Error>(()))?;
                Ok(start.seconds())
            }
        }
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
        assert!(one_more(&[0.2, 0.2], true) && !one_more(&[0.2; 3], true));
        assert!(one_more(&[9.0], true) && !one_more(&[9.0; 2], true));
        assert!(one_more(&[0.01; 20], true) && !one_more(&[0.01; 21], true));
        assert!(one_more(&[], false) && !one_more(&[0.01], false));
    }
}
