//! The error between samples: measures a table as a reader sees it that samples it bilinearly.
//!
//! A reader finds u from the axis's mapping, u = (x − a)/(b − a) or its square root, and from u the position
//! among the samples: u (n − 1) on nodes, u n − ½ on centres. Outside the outermost samples the texture
//! clamps to the edge, and the error of that is counted too. Weights are exact here; texture units round them
//! to 1/256 or so.
//!
//! Near (μ, α) = (0, 0) ρ depends on μ/α alone, so no table converges there. The largest error is
//! therefore taken over μ ≥ 1/256 and roughness ≥ 0.05, as far as the table's axes go; the root mean
//! square is over all of the variables' range.

use crate::backend::cpu;
use crate::base::error::Result;
use crate::base::tolerance::{LISTED_SHARE, Tolerance};
use crate::check;
use crate::check::Check;
use crate::check::cross_check::is_anisotropic_mean;
use crate::integrate::rule_set::has_listed_directions;
use crate::plan::TablePlan;
use crate::table::axis::{Axis, Mapping, Positions, Variable};
use crate::table::report::InterpolationError;
use crate::table::{Values, indices};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::convert::Infallible;

/// The part of a variable's range in which the bilinear error is promised.
pub(crate) fn promised(variable: Variable, [a, b]: [f64; 2]) -> [f64; 2] {
    match variable {
        Variable::Mu => [a.max(MU), b],
        Variable::Roughness => [a.max(ROUGHNESS), b],
        Variable::ThetaI | Variable::ThetaE => [a, b.min(MU.acos())],
        _ => [a, b],
    }
}

/// The least μ and roughness of the promise: no table converges at (μ, α) = (0, 0).
const MU: f64 = 1.0 / 256.0;
const ROUGHNESS: f64 = 0.05;

/// The tolerance of the fast f64 path, far below any that a bilinear look-up meets.
const FINE: Tolerance = Tolerance::known(1e-6);

/// The tolerance of the fast path: coarser where nothing is promised of look-ups and an integral takes long.
fn fast_tolerance(plan: &TablePlan) -> Tolerance {
    match has_listed_directions(plan) && plan.bilinear().is_none() {
        true => Tolerance::known((LISTED_SHARE * plan.tolerance()).max(FINE.get())),
        false => FINE,
    }
}

/// Measures the bilinear error of `values`, the table of `plan`; `None` for values of f, for listed axes (no reader finds
/// its position in them), where nothing is to be checked, and for a sample of means of an anisotropic lobe.
pub(crate) fn measure(plan: &TablePlan, values: &Values, check: Check) -> Result<Option<InterpolationError>> {
    let known = plan.lobes().iter().all(|lobe| check::reference_of_model(lobe.model()).is_some());
    // A mean over four angles takes a second: where nothing is promised between samples, it is not asked for.
    let is_slow = is_anisotropic_mean(plan) && plan.bilinear().is_none() && check != Check::All;
    if check == Check::Sample(0) || !known || !is_sampled(plan) || is_slow {
        return Ok(None);
    }
    let domain: Vec<_> = plan.axes().iter().map(|axis| promised(axis.variable(), axis.range())).collect();
    let tolerance = fast_tolerance(plan);
    let dense = Dense::new(plan, values, test_grid(plan), tolerance);
    let (searched, referenced) = match (is_anisotropic_mean(plan), has_listed_directions(plan)) {
        (true, _) => (1, 0),
        (false, true) => (SEARCHED / 4, REFERENCED),
        (false, false) => (SEARCHED, REFERENCED),
    };
    let worst = dense.worst(&domain, searched);
    let mut points: Vec<_> = worst.iter().map(|&texel| dense.around(plan, values, &domain, texel)).collect();
    if referenced > 0 {
        let further = check::sample(&dense.shape(), referenced);
        points.extend(further.into_iter().map(|texel| dense.coordinates(texel)));
    }

    let channels = plan.channels().len();
    let checked: Vec<_> = points
        .par_iter()
        .map(|point| {
            let plan_at_point = fine(plan, point.iter().map(|&x| vec![x]).collect(), tolerance);
            let fast = evaluate(&plan_at_point);
            let truth = check::reference_within(&plan_at_point, 0, check::reference_error(plan, check));
            let read = look_up(plan.axes(), values, channels, point);
            (truth, fast, read)
        })
        .collect();
    let (mut largest, mut certified) = ((None, BTreeMap::new()), 0.0);
    for (point, (truth, fast, read)) in points.iter().zip(&checked) {
        let inside = point.iter().zip(&domain).all(|(&x, [a, b])| (*a..=*b).contains(&x));
        for channel in 0..channels {
            certified = f64::max(certified, or_infinite((truth[channel] - fast[channel]).abs()));
            let error = or_infinite((read[channel] - truth[channel]).abs());
            if inside && largest.0.is_none_or(|max| error > max) {
                let names = plan.axes().iter().map(|axis| axis.variable().name().to_string());
                let mut worst: BTreeMap<_, _> = names.zip(point.iter().copied()).collect();
                worst.insert("channel".into(), channel as f64);
                worst.insert("value".into(), read[channel]);
                worst.insert("reference".into(), truth[channel]);
                largest = (Some(error), worst);
            }
        }
    }
    let names = plan.axes().iter().map(|axis| axis.variable().name().to_string());
    Ok(Some(InterpolationError {
        kind: "bilinear",
        max: largest.0,
        rms: dense.rms(),
        domain: names.zip(domain).filter(|(_, [a, b])| a <= b).collect(),
        worst: largest.1,
        points: dense.errors.len(),
        points_checked: points.len(),
        certified,
    }))
}

/// The number of worst points around which a finer grid is searched; fewer where an integral or its reference takes long.
const SEARCHED: usize = 8;
/// The number of further points that are compared with the reference. The fast path, which finds the worst points, is
/// certified by a finer rule of its own.
const REFERENCED: usize = 8;

/// The largest error in the promise's domain, by the fast path alone: the layout search uses no reference.
pub(crate) fn largest(plan: &TablePlan, values: &Values) -> f64 {
    let domain: Vec<_> = plan.axes().iter().map(|axis| promised(axis.variable(), axis.range())).collect();
    let dense = Dense::new(plan, values, test_grid(plan), FINE);
    dense.worst(&domain, 1).first().map_or(0.0, |&texel| dense.errors[texel])
}

/// Whether a reader can sample the table: it must be an integral over axes whose positions follow from a formula.
fn is_sampled(plan: &TablePlan) -> bool {
    let has_formula = |axis: &Axis| axis.len() == 1 || axis.positions() != Positions::Values;
    plan.quantity().is_integral()
        && plan.axes().iter().all(has_formula)
        && plan.axes().iter().any(|axis| axis.len() > 1)
}

/// Finds the samples that a look-up at x reads: the one at or below, and the weight of the next.
pub(crate) fn locate(axis: &Axis, x: f64) -> (usize, f64) {
    let (n, [a, b]) = (axis.len(), axis.range());
    if n == 1 {
        return (0, 0.0);
    }
    let u = ((x - a) / (b - a)).clamp(0.0, 1.0);
    let u = if axis.mapping() == Mapping::Sqrt { u.sqrt() } else { u };
    let position = match axis.positions() {
        Positions::Centers => u * n as f64 - 0.5,
        _ => u * (n - 1) as f64,
    };
    let position = position.clamp(0.0, (n - 1) as f64);
    let below = (position as usize).min(n - 2);
    (below, position - below as f64)
}

/// Reads the channels at a point bilinearly.
pub(crate) fn look_up(axes: &[Axis], values: &Values, channels: usize, point: &[f64]) -> Vec<f64> {
    let positions: Vec<_> = axes.iter().zip(point).map(|(axis, &x)| locate(axis, x)).collect();
    let mut read = vec![0.0; channels];
    for corner in 0..1usize << axes.len() {
        let (mut texel, mut weight) = (0, 1.0);
        for (k, (axis, &(below, share))) in axes.iter().zip(&positions).enumerate() {
            let above = corner >> k & 1;
            texel = texel * axis.len() + below + above;
            weight *= if above == 1 { share } else { 1.0 - share };
        }
        if weight > 0.0 {
            let texel = (0..channels).map(|channel| values.get(texel * channels + channel));
            read.iter_mut().zip(texel).for_each(|(read, value)| *read += weight * value);
        }
    }
    read
}

/// The plan of the same table in f64, over listed coordinates, to `tolerance`.
pub(crate) fn fine(plan: &TablePlan, coordinates: Vec<Vec<f64>>, tolerance: Tolerance) -> TablePlan {
    let axes = plan.axes().iter().zip(coordinates).map(|(axis, values)| axis.at_values(values));
    plan.exact_at_samples(axes.collect(), tolerance)
}

/// Evaluates a plan by the fast path, on all cores in f64.
pub(crate) fn evaluate(plan: &TablePlan) -> Vec<f64> {
    let Ok(values) = cpu::evaluate(plan, &|_| Ok::<_, Infallible>(()));
    values
}

/// Errors of look-ups on a grid finer than the table's.
struct Dense {
    coordinates: Vec<Vec<f64>>,
    /// The largest error of each texel's channels.
    errors: Vec<f64>,
    /// The sum of the squared errors of each texel's channels.
    squares: Vec<f64>,
    channels: usize,
    /// The tolerance of the integrals that stand in for the exact values.
    tolerance: Tolerance,
}

impl Dense {
    fn new(plan: &TablePlan, values: &Values, coordinates: Vec<Vec<f64>>, tolerance: Tolerance) -> Self {
        let channels = plan.channels().len();
        let truth = evaluate(&fine(plan, coordinates.clone(), tolerance));
        let mut dense = Self { coordinates, errors: vec![], squares: vec![], channels, tolerance };
        for (texel, truth) in truth.chunks(channels).enumerate() {
            let read = look_up(plan.axes(), values, channels, &dense.coordinates(texel));
            let errors = read.iter().zip(truth).map(|(a, b)| or_infinite((a - b).abs()));
            dense.errors.push(errors.clone().fold(0.0, f64::max));
            dense.squares.push(errors.map(|e| e * e).sum());
        }
        dense
    }

    fn shape(&self) -> Vec<usize> {
        self.coordinates.iter().map(Vec::len).collect()
    }

    /// The coordinates of a texel of the grid.
    fn coordinates(&self, texel: usize) -> Vec<f64> {
        self.coordinates.iter().zip(indices(&self.shape(), texel)).map(|(axis, k)| axis[k]).collect()
    }

    /// The `n` points of the domain with the largest errors, the worst first.
    fn worst(&self, domain: &[[f64; 2]], n: usize) -> Vec<usize> {
        let inside = |&texel: &usize| {
            self.coordinates(texel).iter().zip(domain).all(|(x, [a, b])| (*a..=*b).contains(x))
        };
        let mut texels: Vec<_> = (0..self.errors.len()).filter(inside).collect();
        texels.sort_by(|&a, &b| self.errors[b].total_cmp(&self.errors[a]));
        texels.truncate(n);
        texels
    }

    /// The coordinates of the worst point between the neighbours of a point, within the domain: the worst of a finer grid,
    /// then of still finer ones about that. One grid of eighths alone misses up to 0.9 % of the maximum.
    fn around(&self, plan: &TablePlan, values: &Values, domain: &[[f64; 2]], texel: usize) -> Vec<f64> {
        let mut finer = self.finer(plan, values, domain, texel, 4);
        for _ in 0..2 {
            let Some(&worst) = finer.worst(domain, 1).first() else { return self.coordinates(texel) };
            finer = finer.finer(plan, values, domain, worst, 2);
        }
        finer
            .worst(domain, 1)
            .first()
            .map_or_else(|| self.coordinates(texel), |&worst| finer.coordinates(worst))
    }

    /// The grid of so many steps from a point to each of its neighbours.
    fn finer(
        &self,
        plan: &TablePlan,
        values: &Values,
        domain: &[[f64; 2]],
        texel: usize,
        steps: i32,
    ) -> Self {
        let near = self.coordinates.iter().zip(indices(&self.shape(), texel)).zip(domain);
        let near = near.map(|((axis, k), [a, b])| {
            let [low, high] = [k.saturating_sub(1), (k + 1).min(axis.len() - 1)].map(|k| axis[k]);
            let step = |s: i32| {
                let (end, share) = (if s < 0 { low } else { high }, f64::from(s.abs()) / f64::from(steps));
                (axis[k] + (end - axis[k]) * share).clamp(*a, *b)
            };
            sorted((-steps..=steps).map(step).collect())
        });
        Dense::new(plan, values, near.collect(), self.tolerance)
    }

    /// The root mean square error. Each point has the weight of the part of each range that is nearest to it.
    fn rms(&self) -> f64 {
        let widths: Vec<_> = self.coordinates.iter().map(|x| widths(x)).collect();
        let weight = |texel| -> f64 {
            widths.iter().zip(indices(&self.shape(), texel)).map(|(axis, k)| axis[k]).product()
        };
        let (mut sum, mut all) = (0.0, 0.0);
        for (texel, square) in self.squares.iter().enumerate() {
            sum += weight(texel) * square;
            all += weight(texel) * self.channels as f64;
        }
        (sum / all).sqrt()
    }
}

/// The test coordinates of each axis of a plan. An integral over listed directions takes as long as a hundred others, so that
/// such a table is tested at fewer points.
fn test_grid(plan: &TablePlan) -> Vec<Vec<f64>> {
    const MOST_CELLS: usize = 64;
    const LEAST_CELLS: usize = 8;
    const MOST_LISTED: usize = 1 << 12;
    let grid = |cells: usize| -> Vec<_> { plan.axes().iter().map(|axis| test_points(axis, cells)).collect() };
    let points = |cells: usize| grid(cells).iter().map(Vec::len).product::<usize>();
    let mut cells = MOST_CELLS;
    while has_listed_directions(plan) && cells > LEAST_CELLS && points(cells) > MOST_LISTED {
        cells /= 2;
    }
    grid(cells)
}

/// The test coordinates of an axis: its samples, the middles between them in u, both ends of the range, and the ends of the
/// promise. At nodes of one axis the errors of the other stand alone, between them they add. An axis with more than `cells`
/// keeps all of its first ones, where tables are worst, and some of the others.
fn test_points(axis: &Axis, cells: usize) -> Vec<f64> {
    let first_cells = 3 * cells / 8;
    let (n, [a, b]) = (axis.len(), axis.range());
    if n == 1 {
        return axis.values().to_vec();
    }
    let kept = |k: usize| k < first_cells || k.is_multiple_of(n.div_ceil(cells)) || k + 2 >= n;
    let middle = |x: f64, y: f64| match axis.mapping() {
        Mapping::Linear => 0.5 * (x + y),
        Mapping::Sqrt => {
            let u = 0.5 * (((x - a) / (b - a)).sqrt() + ((y - a) / (b - a)).sqrt());
            a + (b - a) * u * u
        }
    };
    let cells = (0..n).filter(|&k| kept(k)).flat_map(|k| {
        let next = axis.values().get(k + 1).map(|&next| middle(axis.values()[k], next));
        std::iter::once(axis.values()[k]).chain(next)
    });
    sorted(
        cells
            .chain([a, b])
            .chain(promised(axis.variable(), [a, b]))
            .filter(|x| (a..=b).contains(x))
            .collect(),
    )
}

fn sorted(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}

/// The width of the part of the range that is nearest to each point; 1 where there is only one.
fn widths(x: &[f64]) -> Vec<f64> {
    let n = x.len();
    if n == 1 {
        return vec![1.0];
    }
    (0..n).map(|k| 0.5 * (x[(k + 1).min(n - 1)] - x[k.saturating_sub(1)])).collect()
}

fn or_infinite(error: f64) -> f64 {
    if error.is_nan() { f64::INFINITY } else { error }
}
