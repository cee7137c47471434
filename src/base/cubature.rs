//! Adaptive cubature: rectangles are bisected until two rules agree on their sum.
//!
//! Method: the tensor product K₁₅ ⊗ K₁₅ of Kronrod's rule, whose 15 nodes extend the 7 of Gauss–Legendre (Kronrod 1965;
//! nodes as in QUADPACK, Piessens et al. 1983). The error of a rectangle is taken as |K ⊗ K − G ⊗ K| + |K ⊗ K − K ⊗ G|:
//! that of the 7-point rules, so that what is kept, the 15-point rule, has digits to spare where the integrand is smooth.
//! Where it has a kink both rules may agree by luck. So every rectangle is bisected once at least, and its error is no
//! less than a quarter of what the bisection of the one before has changed, which a kink makes eight times its own. The
//! rectangle with the largest error is cut in two across the direction that has more of it.

use super::quadrature::Node;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// A rectangle of the unit square of a chart.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CubatureCell {
    /// Which chart.
    pub chart: usize,
    /// Both ends of the first coordinate.
    pub u: [f64; 2],
    /// Both ends of the second coordinate.
    pub x: [f64; 2],
}

/// What an integrand finds on a rectangle.
pub(crate) struct Measured<T> {
    pub samples: T,
    /// K ⊗ K of its components.
    pub sums: [f64; 3],
    /// The errors along u and along x.
    pub errors: [f64; 2],
}

/// Evaluations of a rectangle.
pub(crate) const EVALUATIONS: usize = 15 * 15;

/// The samples of rectangles whose errors add up to no more than the tolerance. `None` when that would take more than
/// `most` evaluations to sum, or when a value is not finite.
pub(crate) fn refine<T>(
    start: Vec<CubatureCell>,
    tolerance: f64,
    most: usize,
    mut measure: impl FnMut(&CubatureCell) -> Measured<T>,
) -> Option<Vec<T>> {
    let mut cells = BinaryHeap::new();
    for rectangle in start {
        let whole = Cell { rectangle, measured: measure(&rectangle) };
        cells.extend(whole.bisected(&mut measure));
    }
    loop {
        let error: f64 = cells.iter().map(Cell::error).sum();
        if error <= tolerance {
            return Some(cells.into_iter().map(|cell| cell.measured.samples).collect());
        }
        if !error.is_finite() || (cells.len() + 1) * EVALUATIONS > most {
            return None;
        }
        // All that have more than their share of the error at once: the sum above is then taken seldom.
        let share = 0.25 * cells.peek()?.error();
        while cells.peek().is_some_and(|cell| cell.error() >= share) {
            let halves = cells.pop()?.bisected(&mut measure);
            cells.extend(halves);
            if (cells.len() + 1) * EVALUATIONS > most {
                break;
            }
        }
    }
}

impl CubatureCell {
    fn halves(self, across_u: bool) -> [Self; 2] {
        let cut = |[low, high]: [f64; 2]| {
            let middle = 0.5 * (low + high);
            [[low, middle], [middle, high]]
        };
        match across_u {
            true => cut(self.u).map(|u| Self { u, ..self }),
            false => cut(self.x).map(|x| Self { x, ..self }),
        }
    }
}

struct Cell<T> {
    rectangle: CubatureCell,
    measured: Measured<T>,
}

impl<T> Cell<T> {
    fn bisected(&self, measure: &mut impl FnMut(&CubatureCell) -> Measured<T>) -> [Self; 2] {
        let [of_u, of_x] = self.measured.errors;
        let along = usize::from(of_u < of_x);
        let mut halves = self
            .rectangle
            .halves(along == 0)
            .map(|rectangle| Self { rectangle, measured: measure(&rectangle) });
        let change = |k: usize| {
            let sum: f64 = halves.iter().map(|half| half.measured.sums[k]).sum();
            (sum - self.measured.sums[k]).abs()
        };
        let least = 0.25 * change(0).max(change(1)).max(change(2));
        for half in &mut halves {
            let error = &mut half.measured.errors[along];
            *error = error.max(least);
        }
        halves
    }

    fn error(&self) -> f64 {
        self.measured.errors[0] + self.measured.errors[1]
    }
}

impl<T> Ord for Cell<T> {
    fn cmp(&self, other: &Self) -> Ordering {
        self.error().total_cmp(&other.error())
    }
}

impl<T> PartialOrd for Cell<T> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<T> Eq for Cell<T> {}

impl<T> PartialEq for Cell<T> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

/// A node of Kronrod's rule on [0, 1], and its weight in Gauss's, which is 0 at every other node.
#[derive(Debug, Clone, Copy)]
pub(crate) struct KronrodNode {
    pub node: Node,
    pub gauss_weight: f64,
}

/// Kronrod's rule of 15 nodes and the Gauss–Legendre rule of 7 among them, on an interval.
pub(crate) fn kronrod([low, high]: [f64; 2]) -> [KronrodNode; 15] {
    let width = high - low;
    std::array::from_fn(|k| {
        let (j, sign) = if k < 8 { (k, -1.0) } else { (14 - k, 1.0) };
        KronrodNode {
            node: Node { x: low + 0.5 * width * (1.0 + sign * NODES[j]), weight: 0.5 * width * WEIGHTS[j] },
            gauss_weight: if k % 2 == 1 { 0.5 * width * GAUSS_WEIGHTS[j / 2] } else { 0.0 },
        }
    })
}

const NODES: [f64; 8] = [
    0.991_455_371_120_812_6,
    0.949_107_912_342_758_5,
    0.864_864_423_359_769_1,
    0.741_531_185_599_394_4,
    0.586_087_235_467_691_1,
    0.405_845_151_377_397_2,
    0.207_784_955_007_898_47,
    0.0,
];
const WEIGHTS: [f64; 8] = [
    0.022_935_322_010_529_224,
    0.063_092_092_629_978_55,
    0.104_790_010_322_250_18,
    0.140_653_259_715_525_92,
    0.169_004_726_639_267_9,
    0.190_350_578_064_785_4,
    0.204_432_940_075_298_9,
    0.209_482_141_084_727_83,
];
const GAUSS_WEIGHTS: [f64; 4] =
    [0.129_484_966_168_869_7, 0.279_705_391_489_276_7, 0.381_830_050_505_118_9, 0.417_959_183_673_469_4];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_rules_are_exact_to_their_degrees() {
        for degree in 0..=23 {
            let rule = kronrod([0.0, 1.0]);
            let [kronrod, gauss] = [|n: &KronrodNode| n.node.weight, |n: &KronrodNode| n.gauss_weight]
                .map(|weight| rule.iter().map(|n| weight(n) * n.node.x.powi(degree)).sum::<f64>());
            let exact = 1.0 / (f64::from(degree) + 1.0);
            assert!((kronrod - exact).abs() < 1e-14, "{degree}: {kronrod}");
            assert_eq!((gauss - exact).abs() < 1e-14, degree <= 13, "{degree}: {gauss}");
        }
    }

    fn integral(f: impl Fn(f64, f64) -> f64, tolerance: f64, most: usize) -> Option<f64> {
        let start = vec![CubatureCell { chart: 0, u: [0.0, 1.0], x: [0.0, 1.0] }];
        let sums = refine(start, tolerance, most, |r| {
            let mut sums = [0.0; 3];
            for u in kronrod(r.u) {
                for x in kronrod(r.x) {
                    let value = f(u.node.x, x.node.x);
                    sums[0] += u.node.weight * x.node.weight * value;
                    sums[1] += u.gauss_weight * x.node.weight * value;
                    sums[2] += u.node.weight * x.gauss_weight * value;
                }
            }
            let errors = [(sums[0] - sums[1]).abs(), (sums[0] - sums[2]).abs()];
            Measured { samples: sums[0], sums: [sums[0]; 3], errors }
        });
        Some(sums?.iter().sum())
    }

    /// A kink, a peak and a root at an edge: the error is below the tolerance, and what does not fit is refused.
    #[test]
    fn tolerances_are_met() {
        for tolerance in [1e-2, 1e-4, 1e-6, 1e-8] {
            let kink = integral(|u, x| (x - 0.3 - 0.2 * u).abs(), tolerance, usize::MAX).unwrap();
            // ∫ ((0.3 + 0.2u)² + (0.7 − 0.2u)²)/2 du
            let exact = 0.5 * ((0.125 - 0.027) / 0.6 + (0.343 - 0.125) / 0.6);
            assert!((kink - exact).abs() <= tolerance, "{kink}");
            let peak = integral(|u, x| 1e-4 / (1e-4 + (u - 0.4).powi(2)) * x, tolerance, usize::MAX).unwrap();
            let exact = 0.5 * 1e-2 * (60f64.atan() + 40f64.atan());
            assert!((peak - exact).abs() <= tolerance, "{peak}");
            let root = integral(|u, x| (u * x).sqrt(), tolerance, usize::MAX).unwrap();
            assert!((root - 4.0 / 9.0).abs() <= tolerance, "{root}");
        }
        assert!(integral(|u, x| (x - u).abs(), 1e-8, 2000).is_none());
        assert!(integral(|_, _| f64::NAN, 1e-8, usize::MAX).is_none());
    }
}
