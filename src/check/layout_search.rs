//! The layout search: finds the mapping, positions, range, size and format with the fewest bytes that meet a tolerance
//! when an engine samples the table bilinearly.
//!
//! Weights of a look-up are ≥ 0 and sum to 1, so with I_x and I_y the interpolations along each axis,
//! |I_x I_y f − f| ≤ max |I_x f − f| + max |I_y f − f|: errors of single axes, which are cheap to tabulate
//! and fall as 1/n², rank the choices. The best few are then searched by bisection on the error that
//! the rounded table really has, and the winner is measured between all of its samples.

use crate::base::error::{Error, Result};
use crate::base::tolerance::{LAYOUT_MARGIN, LAYOUT_REFERENCE_SHARE, Tolerance, UNORM_RULE};
use crate::check::bilinear::{evaluate, fine, largest, locate, look_up, promised};
use crate::plan::TablePlan;
use crate::table::axis::{Axis, Mapping, Positions, Variable};
use crate::table::report::{Choice, Layout};
use crate::table::storage::Storage;
use crate::table::{ErrorKind, Values, indices};
use std::cell::RefCell;

/// Chooses axes and storage of a table for its tolerance. `auto` are the axes to choose: the search takes only their range
/// from the table.
///
/// # Errors
/// When no size up to 512 meets the tolerance.
pub(crate) fn optimise(table: TablePlan, auto: &[Variable], storage: Option<Storage>) -> Result<TablePlan> {
    let search = Search::new(&table, auto, storage);
    let mut candidates: Vec<LayoutCandidate> =
        search.shortlist().iter().filter_map(|options| search.best(options)).collect();
    candidates.sort_by_key(|candidate| candidate.bytes);
    let mut candidates = candidates.into_iter();
    let chosen = candidates.next().ok_or_else(|| {
        Error::input(format!(
            "table \"{}\": no size of its auto axes up to {MAX_SAMPLES} meets {:e} bilinearly; allow more, narrow the range, or \
             give its other axis more samples",
            table.name(), table.tolerance()
        ))
    })?;
    let usual: usize = table
        .axes()
        .iter()
        .map(|axis| if auto.contains(&axis.variable()) { 128 } else { axis.len() })
        .product();
    let choice = Choice {
        runner_up: candidates.next().map(|next| next.layout()),
        usual_bytes: usual * table.channels().len() * Storage::F16.bytes(),
        chosen: chosen.layout(),
    };
    table.with_layout(chosen.axes, chosen.storage, choice)
}

/// The largest number of samples of an axis that is tried.
const MAX_SAMPLES: usize = 512;
/// The number of combinations of options that are searched by bisection.
const SHORTLIST: usize = 3;
/// The number of points along each axis at which candidates are tested.
const TESTS: usize = 65;
/// The sizes at which the errors of single axes are tabulated.
const SIZES: [usize; 3] = [24, 64, 160];

/// The tolerance of the search's own integrals.
fn search_tolerance(table: &TablePlan) -> Tolerance {
    Tolerance::known((LAYOUT_REFERENCE_SHARE * table.tolerance()).min(UNORM_RULE))
}

/// An axis without its number of samples.
#[derive(Debug, Clone, Copy, PartialEq)]
struct AxisOption {
    variable: Variable,
    mapping: Mapping,
    positions: Positions,
    range: [f64; 2],
}

impl AxisOption {
    fn axis(&self, n: usize) -> Option<Axis> {
        Axis::new(self.variable, n, self.range, self.positions, self.mapping).ok()
    }
}

/// A layout with its bytes and its largest error at the test points.
struct LayoutCandidate {
    axes: Vec<Axis>,
    storage: Storage,
    bytes: usize,
    error: f64,
}

impl LayoutCandidate {
    fn layout(&self) -> Layout {
        let axes = self.axes.iter().map(|axis| {
            let mapping = if axis.mapping() == Mapping::Sqrt { "sqrt" } else { "linear" };
            let positions = match axis.positions() {
                Positions::Nodes => "nodes",
                Positions::Centers => "centers",
                Positions::Values => "values",
            };
            let [a, b] = axis.range();
            format!("{} {mapping} {positions} [{a:.4}, {b:.4}] × {}", axis.variable().name(), axis.len())
        });
        Layout { axes: axes.collect(), storage: self.storage, bytes: self.bytes, error: self.error }
    }
}

/// An axis option with its single-axis errors at [`SIZES`].
#[derive(Clone, Copy)]
struct OptionErrors {
    option: AxisOption,
    errors: [f64; SIZES.len()],
}

impl OptionErrors {
    /// The error at `n` samples: a power law through the two nearest sizes.
    fn error(&self, n: usize) -> f64 {
        let k = usize::from(n > SIZES[1]);
        let [x0, x1] = [SIZES[k], SIZES[k + 1]].map(|n| (n as f64).ln());
        let [y0, y1] = [self.errors[k], self.errors[k + 1]].map(|e| e.max(1e-12).ln());
        (y0 + (y1 - y0) * ((n as f64).ln() - x0) / (x1 - x0)).exp()
    }
}

/// The search over the layouts of one table.
struct Search<'a> {
    table: &'a TablePlan,
    /// The indices of the axes to choose.
    auto: Vec<usize>,
    storages: Vec<Storage>,
    /// The test coordinates of all axes, in the promise's domain.
    tests: Vec<Vec<f64>>,
    /// The exact values at the test coordinates.
    truth: Vec<f64>,
    /// The options of each axis to choose, with their errors.
    options: RefCell<Vec<Vec<OptionErrors>>>,
}

impl<'a> Search<'a> {
    fn new(table: &'a TablePlan, auto: &[Variable], storage: Option<Storage>) -> Self {
        let auto = (0..table.axes().len()).filter(|&k| auto.contains(&table.axes()[k].variable())).collect();
        let tests: Vec<_> = table
            .axes()
            .iter()
            .map(|axis| {
                let [a, b] = promised(axis.variable(), axis.range());
                let a = a.min(b);
                // Denser where ρ turns: at the lower end.
                let tests = |n: usize| (0..n).map(move |k| a + (b - a) * (k as f64 / (n - 1) as f64).powi(2));
                if a < b { tests(TESTS).collect() } else { vec![b] }
            })
            .collect();
        let truth = evaluate(&fine(table, tests.clone(), search_tolerance(table)));
        // Two bytes before four; of two, unorm16, which is finer than halves where it fits. Four can only
        // help where the rounding of two is felt.
        let fits = |&value: &f64| (0.0..=1.0).contains(&Storage::Unorm16.round(value));
        let narrow = if truth.iter().all(fits) { Storage::Unorm16 } else { Storage::F16 };
        let felt = narrow.rounding(ErrorKind::Absolute) > 0.05 * table.tolerance();
        let storages = match storage {
            Some(storage) => vec![storage],
            None if felt => vec![narrow, Storage::F32],
            None => vec![narrow],
        };
        let search = Self { table, auto, storages, tests, truth, options: RefCell::default() };
        let options = search.auto.iter().map(|&k| search.axis_options(k)).collect();
        search.options.replace(options);
        search
    }

    /// The options of axis `k`, with their single-axis errors.
    fn axis_options(&self, k: usize) -> Vec<OptionErrors> {
        let (variable, range) = (self.table.axes()[k].variable(), self.table.axes()[k].range());
        let promise = promised(variable, range);
        let mut ranges = vec![range];
        if promise != range && promise[0] < promise[1] {
            ranges.push(promise);
        }
        let mut options = Vec::new();
        for range in ranges {
            for mapping in [Mapping::Linear, Mapping::Sqrt] {
                for positions in [Positions::Nodes, Positions::Centers] {
                    let option = AxisOption { variable, mapping, positions, range };
                    let errors = SIZES.map(|n| self.single_axis_error(k, option, n));
                    options.push(OptionErrors { option, errors });
                }
            }
        }
        options
    }

    /// The largest error of interpolating along axis `k` alone.
    fn single_axis_error(&self, k: usize, option: AxisOption, n: usize) -> f64 {
        let Some(axis) = option.axis(n) else { return f64::INFINITY };
        let mut coordinates = self.tests.clone();
        // Every other test will do for the ranking.
        for (j, tests) in coordinates.iter_mut().enumerate() {
            if j == k {
                *tests = axis.values().to_vec();
            } else {
                *tests = tests.iter().copied().step_by(COARSE).collect();
            }
        }
        let shape: Vec<_> = coordinates.iter().map(Vec::len).collect();
        let channels = self.table.channels().len();
        let values = evaluate(&fine(self.table, coordinates, search_tolerance(self.table)));
        let all: Vec<_> = self.tests.iter().map(Vec::len).collect();
        let mut largest = 0.0;
        for (texel, truth) in self.truth.chunks(channels).enumerate() {
            let mut index = indices(&all, texel);
            if index.iter().enumerate().any(|(j, i)| j != k && i % COARSE != 0) {
                continue;
            }
            let (below, share) = locate(&axis, self.tests[k][index[k]]);
            index.iter_mut().enumerate().filter(|(j, _)| *j != k).for_each(|(_, i)| *i /= COARSE);
            let mut read = |i: usize| {
                index[k] = i;
                index.iter().zip(&shape).fold(0, |flat, (i, n)| flat * n + i) * channels
            };
            let (low, high) = (read(below), read((below + 1).min(n - 1)));
            for (c, truth) in truth.iter().enumerate() {
                let value = (1.0 - share) * values[low + c] + share * values[high + c];
                largest = f64::max(largest, (value - truth).abs());
            }
        }
        largest
    }

    /// The combinations of options, one for each axis, with the fewest texels by the bound.
    fn shortlist(&self) -> Vec<Vec<OptionErrors>> {
        let options = self.options.borrow();
        let mut ranked: Vec<(usize, Vec<OptionErrors>)> = match &options[..] {
            [only] => only.iter().filter_map(|&c| Some((self.least(&[c])?.0, vec![c]))).collect(),
            [first, second] => {
                let pairs = first.iter().flat_map(|&a| second.iter().map(move |&b| [a, b]));
                pairs.filter_map(|pair| Some((self.least(&pair)?.0, pair.to_vec()))).collect()
            }
            _ => Vec::new(),
        };
        ranked.sort_by_key(|(texels, _)| *texels);
        ranked.into_iter().take(SHORTLIST).map(|(_, combination)| combination).collect()
    }

    /// The fewest texels by the bound, and the size of the first axis there.
    fn least(&self, options: &[OptionErrors]) -> Option<(usize, usize)> {
        let room = LAYOUT_MARGIN * self.table.tolerance();
        let smallest =
            |option: &OptionErrors, room: f64| (2..=2 * MAX_SAMPLES).find(|&n| option.error(n) <= room);
        match options {
            [only] => smallest(only, room).map(|n| (n, n)),
            [a, b] => (2..=2 * MAX_SAMPLES)
                .step_by(2)
                .filter(|&n| a.error(n) < room)
                .filter_map(|n| Some((n * smallest(b, room - a.error(n))?, n)))
                .min(),
            _ => None,
        }
    }

    /// The smallest table of these options that meets the tolerance.
    fn best(&self, options: &[OptionErrors]) -> Option<LayoutCandidate> {
        let (texels, first) = self.least(options)?;
        // Formats in the order of their bytes: the first in which some size meets the tolerance.
        self.storages.iter().find_map(|&storage| {
            if storage.rounding(ErrorKind::Absolute) > 0.5 * self.table.tolerance() {
                return None;
            }
            let candidate = match options {
                [only] => self.shortest(storage, &[], only.option, texels),
                [a, b] => {
                    let sizes = (0..=4).map(|k| (first as f64 * (0.8 + 0.1 * f64::from(k))) as usize);
                    let candidates = sizes.filter_map(|n| {
                        let axis = a.option.axis(n.clamp(2, MAX_SAMPLES))?;
                        self.shortest(storage, &[axis], b.option, texels / n.max(1) + 2)
                    });
                    candidates.min_by_key(|candidate| candidate.bytes)
                }
                _ => None,
            };
            candidate.and_then(|candidate| self.confirmed(candidate))
        })
    }

    /// The candidate with the shortest last axis that meets the tolerance, by bisection around the bound's size.
    fn shortest(
        &self,
        storage: Storage,
        first: &[Axis],
        last: AxisOption,
        bound: usize,
    ) -> Option<LayoutCandidate> {
        let candidate = |n: usize| {
            let mut axes = self.table.axes().to_vec();
            let chosen = first.iter().cloned().chain(last.axis(n));
            self.auto.iter().zip(chosen).for_each(|(&k, axis)| axes[k] = axis);
            self.candidate(axes, storage)
        };
        let room = LAYOUT_MARGIN * self.table.tolerance();
        let (mut low, mut high) = ((bound / 2).max(1), (bound * 5 / 4 + 2).min(MAX_SAMPLES));
        let mut best = loop {
            match candidate(high).filter(|candidate| candidate.error <= room) {
                Some(candidate) => break candidate,
                None if high >= (2 * bound).min(MAX_SAMPLES) => return None,
                None => (low, high) = (high, (high * 5 / 4).min(MAX_SAMPLES)),
            }
        };
        while high - low > 1 {
            let middle = (low + high) / 2;
            match candidate(middle).filter(|candidate| candidate.error <= room) {
                Some(candidate) => (best, high) = (candidate, middle),
                None => low = middle,
            }
        }
        Some(best)
    }

    /// The candidate of some axes and a format, with its error at the test points; `None` where its values do not fit.
    fn candidate(&self, axes: Vec<Axis>, storage: Storage) -> Option<LayoutCandidate> {
        let nodes = axes.iter().map(|axis| axis.values().to_vec()).collect();
        let plan = fine(self.table, nodes, search_tolerance(self.table));
        let channels = self.table.channels().len();
        let values = Values::F64(evaluate(&plan));
        let values = storage.store(values, ErrorKind::Absolute).ok()?.values;
        let shape: Vec<_> = self.tests.iter().map(Vec::len).collect();
        let mut error = 0.0;
        for (texel, truth) in self.truth.chunks(channels).enumerate() {
            let point: Vec<_> =
                self.tests.iter().zip(indices(&shape, texel)).map(|(tests, k)| tests[k]).collect();
            let read = look_up(&axes, &values, channels, &point);
            error = read.iter().zip(truth).map(|(a, b)| (a - b).abs()).fold(error, f64::max);
        }
        Some(LayoutCandidate { bytes: values.len() * storage.bytes(), axes, storage, error })
    }

    /// Measures a candidate between its own samples too, and lengthens its axes a little if need be.
    fn confirmed(&self, mut candidate: LayoutCandidate) -> Option<LayoutCandidate> {
        const TRIES: usize = 6;
        for _ in 0..TRIES {
            let plan = self.table.at_samples(candidate.axes.clone());
            let nodes = candidate.axes.iter().map(|axis| axis.values().to_vec()).collect();
            let nodes = fine(&plan, nodes, search_tolerance(&plan));
            let values =
                candidate.storage.store(Values::F64(evaluate(&nodes)), ErrorKind::Absolute).ok()?.values;
            candidate.error = largest(&plan, &values);
            if candidate.error <= CONFIRMED * self.table.tolerance() {
                return Some(candidate);
            }
            let mut axes = candidate.axes;
            for &k in &self.auto {
                axes[k] = axes[k].with_count(axes[k].len() + 1).ok()?;
            }
            candidate = self.candidate(axes, candidate.storage)?;
        }
        None
    }
}

/// The step through the test points of the other axis when options are ranked.
const COARSE: usize = 8;
/// The share of the tolerance that a confirmed layout may use: the rest is for the device's own error, which the rule
/// bounds by a tenth of the tolerance and which is 1e-6 as measured.
const CONFIRMED: f64 = 0.995;
