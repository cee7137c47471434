//! The trade-off: one table by every method at every cost, its time and its error, on one device in one
//! run, and which of them nobody beats in both.

mod candidates;
mod costs;
mod floor;
mod front;
mod picture;
mod subset;
mod timing;
mod write;

pub use costs::{Cost, costs};
pub use floor::Floor;
pub use front::front;
pub use write::write;

use crate::bake::{Evaluator, Observer};
use crate::base::error::{Error, Result};
use crate::base::precision::Precision;
use crate::base::timings::Stopwatch;
use crate::check;
use crate::plan::TablePlan;
use crate::table::quantity;
use crate::table::storage::Storage;
use candidates::{Candidate, candidates};
use rayon::prelude::*;
use serde::Serialize;
use std::collections::HashMap;
use std::fmt;
use subset::Subset;
use timing::{Timing, median, rounds, time};

/// How much to measure.
#[derive(Debug, Clone, Copy)]
pub struct TradeOptions {
    /// Seconds, as a device of 10⁸ evaluations a second would need them: which points are measured, and on
    /// which texels, must not depend on the clock.
    pub budget: f64,
    /// Compare every texel of what was run in full, not only the subset's.
    pub check_all: bool,
}

impl TradeOptions {
    /// No more steps than an observer is told of: the reference, and each method at each cost.
    pub fn steps(&self) -> usize {
        let settings = candidates::methods().into_iter().flatten();
        1 + settings.map(|(_, _, tolerance)| candidates::storages(tolerance).count()).sum::<usize>()
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
    /// The comparisons that matter.
    pub headlines: Vec<Headline>,
    /// What was not measured, and why.
    pub left_out: Vec<String>,
}

/// Two points, timed in turns.
#[derive(Debug, Clone, Serialize)]
pub struct Headline {
    /// This project's method and setting.
    pub ours: String,
    /// The other's.
    pub theirs: String,
    /// Their time over ours: the median over the rounds.
    pub ratio: f64,
    /// The smallest.
    pub ratio_min: f64,
    /// The largest.
    pub ratio_max: f64,
    /// The largest errors, ours and theirs.
    pub errors: [f64; 2],
    /// Whether their time is extrapolated from the subset, and no turns were taken.
    pub extrapolated: bool,
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
    /// What the values are rounded to when they are stored: the arithmetic's own format, or a narrower one. Its time
    /// is without that rounding, which is the host's; a tolerance with it takes a finer rule.
    pub storage: Storage,
    /// Of the whole table as it is stored.
    pub bytes: usize,
    /// Texels that were computed: all, or the subset's.
    pub texels: usize,
    /// Evaluations of the integrand for these texels. The warped rule does them at Chebyshev points of a table's axes
    /// and interpolates; the others do them at each texel.
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
    /// Whether no measured point is both faster and more exact; extrapolated ones do not take part, nor those of
    /// narrow storage, which trade exactness for bytes.
    pub on_front: bool,
}

/// Measures the trade-off of a table of integrals.
///
/// # Errors
/// When the table is one of values, the device fails, or the observer stops it.
pub fn measure(
    table: &TablePlan,
    evaluator: &Evaluator,
    options: &TradeOptions,
    observer: &dyn Observer,
) -> Result<Trade> {
    if table.quantity().is_value() {
        let integrals = quantity::integrals_in_words();
        let why = format!("values are not integrated and have no methods to compare; give {integrals}");
        return Err(Error::input(format!("table \"{}\": {why}", table.name())));
    }
    // Each point has a storage of its own.
    let table = &table.clone().with_storage(Storage::F32)?;
    let subset = Subset::new(table)?;
    let (candidates, mut left_out) = candidates(table, &subset.plan, options.budget);
    observer.begin("computing the reference");
    let truth = Truth::new(table, &subset, options.check_all, &|share| observer.advance(share))?;
    let rates = match evaluator {
        Evaluator::Device(device) => Some(device.rates()?),
        Evaluator::Cpu => None,
    };
    let start = Stopwatch::start();
    let mut points = Vec::new();
    for candidate in candidates {
        observer.begin(&format!("{} {}", candidate.method, candidate.setting));
        let in_budget = || start.seconds() < options.budget;
        let precision = match evaluator {
            Evaluator::Device(device) if candidate.precision == Precision::F64 && !device.has_f64() => {
                left_out.push(format!("{} {}: the device has no f64", candidate.method, candidate.setting));
                continue;
            }
            Evaluator::Device(_) => candidate.precision,
            Evaluator::Cpu => Precision::F64,
        };
        let storage = match (candidate.plan.storage(), precision) {
            (Storage::F32, Precision::F64) => Storage::F64,
            (storage, _) => storage,
        };
        let timing = time(evaluator, &candidate.plan, precision, &in_budget, &|| observer.advance(0.0))?;
        match timing.stored(storage, table.quantity().error) {
            Ok(timing) => {
                points.push(truth.point(table, &subset, candidate, timing, (precision, storage), rates));
            }
            Err(why) => left_out.push(format!(
                "{} {} as {}: {why}",
                candidate.method,
                candidate.setting,
                storage.name()
            )),
        }
    }
    let places: Vec<_> = points.iter().map(|p| (p.table_seconds, p.max_error, p.takes_part())).collect();
    for (point, on_front) in points.iter_mut().zip(front(&places)) {
        point.on_front = on_front;
    }
    let mut trade = Trade {
        table: in_words(table),
        shape: table.shape(),
        subset_texels: subset.texels.len(),
        subset: subset.to_string(),
        floor: rates.map(Floor::new),
        points,
        headlines: Vec::new(),
        left_out,
    };
    let pairs = trade.pairs().into_iter();
    let headlines = pairs.map(|pair| headline(evaluator, table, pair, observer)).collect::<Result<_>>()?;
    trade.headlines = headlines;
    Ok(trade)
}

/// What is measured; not by which rule.
fn in_words(table: &TablePlan) -> String {
    let axes: Vec<_> = table.axes().iter().map(|a| format!("{} {}", a.variable().name(), a.len())).collect();
    let over = if axes.is_empty() { String::new() } else { format!(" over {}", axes.join(" × ")) };
    format!("{} of {}{over}", table.quantity().name, table.subject())
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
        if table.lobes().iter().any(|lobe| check::reference_of_model(lobe.model()).is_none()) {
            return Err(Error::input(format!(
                "table \"{}\": a lobe has no reference to compare with",
                table.name()
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
        (precision, storage): (Precision, Storage),
        rates: Option<crate::backend::gpu::Rates>,
    ) -> Point {
        let Candidate { method, setting, plan, whole, evaluations, .. } = candidate;
        let channels = table.channels().len();
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
            storage,
            bytes: table.texels() * channels * storage.bytes(),
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

impl Point {
    /// Whether the values are stored as they were computed.
    pub fn is_whole(&self) -> bool {
        self.storage.bytes() >= Storage::F32.bytes()
    }

    fn takes_part(&self) -> bool {
        self.is_whole() && !self.extrapolated
    }
}

impl Trade {
    /// The point of a method at a setting, stored as it was computed.
    pub fn point(&self, method: &str, setting: &str) -> Option<&Point> {
        self.points.iter().find(|p| p.method == method && p.setting == setting && p.is_whole())
    }

    /// The comparisons that matter: with 1024 samples as most bakers take them, and at an error of 1e-4.
    fn pairs(&self) -> Vec<(&Point, &Point)> {
        let common = self.point("warped", "1e-6").zip(self.point("hammersley", "1024"));
        let meets = |p: &&Point| p.method == "vndf" && p.max_error <= 1e-4;
        let fewest = self.points.iter().filter(meets).min_by_key(|p| (p.extrapolated, p.evaluations));
        let same_error = self.point("warped", "1e-4").zip(fewest);
        [common, same_error].into_iter().flatten().collect()
    }
}

/// Times a pair again, in turns, so that a machine that is slower for a while is so for both.
fn headline(
    evaluator: &Evaluator,
    table: &TablePlan,
    (ours, theirs): (&Point, &Point),
    observer: &dyn Observer,
) -> Result<Headline> {
    let plan = |p: &Point| -> Result<TablePlan> {
        let (rule, tolerance) = candidates::setting(p.method, &p.setting)
            .ok_or_else(|| Error::Internal(format!("no method {} {}", p.method, p.setting)))?;
        table.clone().with_rule(rule)?.with_tolerance(tolerance.unwrap_or(table.tolerance()))
    };
    let (times, measured) = if theirs.extrapolated {
        ([ours, theirs].map(|p| vec![p.table_seconds]), false)
    } else {
        (rounds(evaluator, [&plan(ours)?, &plan(theirs)?], &|| observer.advance(0.0))?, true)
    };
    let mut ratios: Vec<_> = times[0].iter().zip(&times[1]).map(|(ours, theirs)| theirs / ours).collect();
    ratios.sort_by(f64::total_cmp);
    let name = |p: &Point| format!("{} {}", p.method, p.setting);
    Ok(Headline {
        ours: name(ours),
        theirs: name(theirs),
        ratio: median(&ratios),
        ratio_min: ratios.first().copied().unwrap_or(f64::NAN),
        ratio_max: ratios.last().copied().unwrap_or(f64::NAN),
        errors: [ours.max_error, theirs.max_error],
        extrapolated: !measured,
    })
}

impl fmt::Display for Headline {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { ours, theirs, ratio, ratio_min, ratio_max, errors, extrapolated } = self;
        write!(f, "{theirs} takes {ratio:.1} × the time of {ours}")?;
        if *extrapolated {
            write!(f, " (extrapolated from a subset of the texels)")?;
        } else {
            write!(f, " ({ratio_min:.1} – {ratio_max:.1}, run in turns)")?;
        }
        write!(f, ", with errors of {:.1e} and {:.1e}", errors[1], errors[0])
    }
}
