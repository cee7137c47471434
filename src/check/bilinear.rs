//! The error between nodes: what a table is worth to a reader that samples it bilinearly.
//!
//! A reader finds u from the axis's mapping, u = (x − a)/(b − a) or its square root, and from u the place
//! among the samples: u (n − 1) on nodes, u n − ½ on centres. Outside the outermost samples the texture
//! clamps to the edge: what that costs is counted too. Weights are exact here; texture units round them
//! to 1/256 or so.
//!
//! Near (μ, α) = (0, 0) ρ depends on μ/α alone, so no table converges there. The largest error is
//! therefore taken over μ ≥ 1/256 and roughness ≥ 0.05, as far as the table's axes go; the root mean
//! square is over all of the variables' range.

use crate::backend::cpu;
use crate::base::error::Result;
use crate::base::tolerance::Tolerance;
use crate::check;
use crate::check::Check;
use crate::plan::TablePlan;
use crate::table::axis::{Axis, Mapping, Positions, Variable};
use crate::table::report::InterpolationError;
use crate::table::{Values, indices};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::convert::Infallible;

/// Where the promise of a variable begins.
pub(crate) fn promised(variable: Variable, [a, b]: [f64; 2]) -> [f64; 2] {
    match variable {
        Variable::Mu => [a.max(MU), b],
        Variable::Roughness => [a.max(ROUGHNESS), b],
        Variable::ThetaI | Variable::ThetaE => [a, b.min(MU.acos())],
        _ => [a, b],
    }
}

/// No table converges at (μ, α) = (0, 0): promises begin here.
const MU: f64 = 1.0 / 256.0;
const ROUGHNESS: f64 = 0.05;

/// The tolerance of the fast f64 path, far below any that a bilinear look-up meets.
const FINE: Tolerance = Tolerance::known(1e-6);

/// The error of `values`, the table of `plan`, as it is sampled bilinearly; `None` for values of f, for
/// axes that are lists (no reader finds its place in them), and where nothing is to be checked.
pub(crate) fn measure(plan: &TablePlan, values: &Values, check: Check) -> Result<Option<InterpolationError>> {
    let known = plan.lobes().iter().all(|lobe| check::reference_of_model(lobe.model()).is_some());
    if check == Check::Sample(0) || !known || !is_sampled(plan) {
        return Ok(None);
    }
    let domain: Vec<_> = plan.axes().iter().map(|axis| promised(axis.variable(), axis.range())).collect();
    let coordinates: Vec<_> = plan.axes().iter().map(test_points).collect();
    let dense = Dense::new(plan, values, coordinates);
    let worst = dense.worst(&domain, SEARCHED);
    let mut places: Vec<_> = worst.iter().map(|&texel| dense.around(plan, values, &domain, texel)).collect();
    places.extend(check::sample(&dense.shape(), REFERENCED).into_iter().map(|texel| dense.at(texel)));

    let channels = plan.channels().len();
    let checked: Vec<_> = places
        .par_iter()
        .map(|at| {
            let point = fine(plan, at.iter().map(|&x| vec![x]).collect(), FINE);
            let fast = evaluate(&point);
            let truth = check::reference(&point, 0);
            let read = look_up(plan.axes(), values, channels, at);
            (truth, fast, read)
        })
        .collect();
    let (mut found, mut certified) = ((None, BTreeMap::new()), 0.0);
    for (at, (truth, fast, read)) in places.iter().zip(&checked) {
        let inside = at.iter().zip(&domain).all(|(&x, [a, b])| (*a..=*b).contains(&x));
        for channel in 0..channels {
            certified = f64::max(certified, or_infinite((truth[channel] - fast[channel]).abs()));
            let error = or_infinite((read[channel] - truth[channel]).abs());
            if inside && found.0.is_none_or(|max| error > max) {
                let names = plan.axes().iter().map(|axis| axis.variable().name().to_string());
                let mut worst: BTreeMap<_, _> = names.zip(at.iter().copied()).collect();
                worst.insert("channel".into(), channel as f64);
                worst.insert("value".into(), read[channel]);
                worst.insert("reference".into(), truth[channel]);
                found = (Some(error), worst);
            }
        }
    }
    let names = plan.axes().iter().map(|axis| axis.variable().name().to_string());
    Ok(Some(InterpolationError {
        kind: "bilinear",
        max: found.0,
        rms: dense.rms(),
        domain: names.zip(domain).filter(|(_, [a, b])| a <= b).collect(),
        worst: found.1,
        points: dense.errors.len(),
        points_checked: places.len(),
        certified,
    }))
}

/// How many of the worst cells are searched, and how many points more are compared with the reference.
const SEARCHED: usize = 8;
const REFERENCED: usize = 56;

/// The largest error in the promise's domain by the fast path alone: for plans, which are pure.
pub(crate) fn largest(plan: &TablePlan, values: &Values) -> f64 {
    let domain: Vec<_> = plan.axes().iter().map(|axis| promised(axis.variable(), axis.range())).collect();
    let dense = Dense::new(plan, values, plan.axes().iter().map(test_points).collect());
    dense.worst(&domain, 1).first().map_or(0.0, |&texel| dense.errors[texel])
}

/// Whether a reader can sample the table: an integral, over axes that a formula finds its place in.
fn is_sampled(plan: &TablePlan) -> bool {
    let found = |axis: &Axis| axis.len() == 1 || axis.positions() != Positions::Values;
    plan.quantity().is_integral()
        && plan.axes().iter().all(found)
        && plan.axes().iter().any(|axis| axis.len() > 1)
}

/// What bilinear look-ups at x read between: the sample at or below, and the next one's weight.
pub(crate) fn locate(axis: &Axis, x: f64) -> (usize, f64) {
    let (n, [a, b]) = (axis.len(), axis.range());
    if n == 1 {
        return (0, 0.0);
    }
    let u = ((x - a) / (b - a)).clamp(0.0, 1.0);
    let u = if axis.mapping() == Mapping::Sqrt { u.sqrt() } else { u };
    let place = match axis.positions() {
        Positions::Centers => u * n as f64 - 0.5,
        _ => u * (n - 1) as f64,
    };
    let place = place.clamp(0.0, (n - 1) as f64);
    let below = (place as usize).min(n - 2);
    (below, place - below as f64)
}

/// The channels that a bilinear look-up reads.
pub(crate) fn look_up(axes: &[Axis], values: &Values, channels: usize, at: &[f64]) -> Vec<f64> {
    let places: Vec<_> = axes.iter().zip(at).map(|(axis, &x)| locate(axis, x)).collect();
    let mut read = vec![0.0; channels];
    for corner in 0..1usize << axes.len() {
        let (mut texel, mut weight) = (0, 1.0);
        for (k, (axis, &(below, share))) in axes.iter().zip(&places).enumerate() {
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

/// The same table in f64 by the fast path, over listed coordinates.
pub(crate) fn fine(plan: &TablePlan, coordinates: Vec<Vec<f64>>, tolerance: Tolerance) -> TablePlan {
    let axes = plan.axes().iter().zip(coordinates).map(|(axis, values)| axis.at_values(values));
    plan.exact_at_samples(axes.collect(), tolerance)
}

/// The fast path: all cores, f64.
pub(crate) fn evaluate(plan: &TablePlan) -> Vec<f64> {
    let Ok(values) = cpu::evaluate(plan, &|_| Ok::<_, Infallible>(()));
    values
}

/// Errors of look-ups on a grid finer than the table's.
struct Dense {
    coordinates: Vec<Vec<f64>>,
    /// Texel by texel, the largest of the channels and the sum of their squares.
    errors: Vec<f64>,
    squares: Vec<f64>,
    channels: usize,
}

impl Dense {
    fn new(plan: &TablePlan, values: &Values, coordinates: Vec<Vec<f64>>) -> Self {
        let channels = plan.channels().len();
        let truth = evaluate(&fine(plan, coordinates.clone(), FINE));
        let mut dense = Self { coordinates, errors: vec![], squares: vec![], channels };
        for (texel, truth) in truth.chunks(channels).enumerate() {
            let read = look_up(plan.axes(), values, channels, &dense.at(texel));
            let errors = read.iter().zip(truth).map(|(a, b)| or_infinite((a - b).abs()));
            dense.errors.push(errors.clone().fold(0.0, f64::max));
            dense.squares.push(errors.map(|e| e * e).sum());
        }
        dense
    }

    fn shape(&self) -> Vec<usize> {
        self.coordinates.iter().map(Vec::len).collect()
    }

    fn at(&self, texel: usize) -> Vec<f64> {
        self.coordinates.iter().zip(indices(&self.shape(), texel)).map(|(axis, k)| axis[k]).collect()
    }

    /// The points of the domain with the largest errors, the worst first.
    fn worst(&self, domain: &[[f64; 2]], n: usize) -> Vec<usize> {
        let inside =
            |&texel: &usize| self.at(texel).iter().zip(domain).all(|(x, [a, b])| (*a..=*b).contains(x));
        let mut texels: Vec<_> = (0..self.errors.len()).filter(inside).collect();
        texels.sort_by(|&a, &b| self.errors[b].total_cmp(&self.errors[a]));
        texels.truncate(n);
        texels
    }

    /// The worst of a finer grid between the neighbours of a point, as far as they lie in the domain.
    fn around(&self, plan: &TablePlan, values: &Values, domain: &[[f64; 2]], texel: usize) -> Vec<f64> {
        const STEPS: i32 = 4;
        let near = self.coordinates.iter().zip(indices(&self.shape(), texel)).zip(domain);
        let near = near.map(|((axis, k), [a, b])| {
            let [low, high] = [k.saturating_sub(1), (k + 1).min(axis.len() - 1)].map(|k| axis[k]);
            let step = |s: i32| {
                let (end, share) = (if s < 0 { low } else { high }, f64::from(s.abs()) / f64::from(STEPS));
                (axis[k] + (end - axis[k]) * share).clamp(*a, *b)
            };
            sorted((-STEPS..=STEPS).map(step).collect())
        });
        let finer = Dense::new(plan, values, near.collect());
        finer.worst(domain, 1).first().map_or_else(|| self.at(texel), |&worst| finer.at(worst))
    }

    /// Each point stands for what is nearer to it than to others, in each variable.
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

/// Samples, the middles between them in u, both ends of the range, and where the promise begins: at
/// nodes of one axis the errors of the other stand alone, between them they add. Of long axes every so
/// many cells are kept, but all of the first, where tables are worst.
fn test_points(axis: &Axis) -> Vec<f64> {
    const ALL_OF: usize = 24;
    const CELLS: usize = 64;
    let (n, [a, b]) = (axis.len(), axis.range());
    if n == 1 {
        return axis.values().to_vec();
    }
    let kept = |k: usize| k < ALL_OF || k.is_multiple_of(n.div_ceil(CELLS)) || k + 2 >= n;
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

/// The part of the range that is nearest to each point; 1 where there is but one.
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
