//! ρ_dh(ωi) = ∫ f cos θe dωe of any f, by adaptive cubature of many incidences at once.
//!
//! The chart is (θe, δφ), δφ = φe − φi − π, so that the horizon and the normal are edges. Each coordinate runs
//! logarithmically away from where lobes are narrow,
//!
//! ```text
//! θe = θ₀ ± w sinh x,   θ₀ = 0, θi, π/2        δφ = δ₀ ± w sinh y,   δ₀ = 0 (mirror), π (back to the source)
//! ```
//!
//! so that a lobe of any width from w on is a bump of width 1 or so, and what grazes, whose width in δφ grows in
//! proportion to cos θi + cos θe, has a straight edge. Everything else is found by bisection: Kronrod's 7 nodes in each
//! coordinate extend the 3 of Gauss–Legendre, and the cell whose rules disagree is cut across the coordinate in which
//! they disagree more. All new cells of all incidences are one call of the subject.

use crate::base::error::Result;
use crate::verify::Angles;
use crate::verify::probe::{Probe, is_non_finite};
use std::f64::consts::{FRAC_PI_2, PI};

/// A value and how far it may be off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rho {
    pub value: f64,
    /// A bound of the error, as far as the rules can tell.
    pub estimate: f64,
}

impl Rho {
    /// What the value is at least.
    pub fn certain(&self) -> f64 {
        self.value - self.estimate
    }

    /// What the value may be at most.
    pub fn possible(&self) -> f64 {
        self.value + self.estimate
    }
}

/// How finely a chart is cut before anything is known of f, and how it is laid out.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layout {
    /// The largest cell, rad.
    pub largest: f64,
    /// A factor of all widths, for a second rule that has no node of the first.
    pub stretch: f64,
    /// Whether f of a pair and of its mirror image are equal, so that one half of the hemisphere stands for both.
    pub bilateral: bool,
}

/// An integral in progress.
#[derive(Debug, Clone)]
pub(super) struct Integral {
    pub theta_i: f64,
    pub phi_i: f64,
    rays: [Vec<Ray>; 2],
    /// 2 where half of the hemisphere stands for both.
    fold: f64,
    cells: Vec<Cell>,
    /// Cells that are not evaluated yet.
    new: Vec<Cell>,
    /// The error of cells that are not cut further.
    left: f64,
}

/// The widths at which the logarithms begin: of lobes about θi, about the other ends; and of δφ at normal incidence.
const WIDTH: f64 = 3e-6;
const END_WIDTH: f64 = 3e-5;
const AZIMUTH_WIDTH: f64 = 1e-5;
/// What a cell's error is at least, of what cutting its parent changed.
const CHANGE: f64 = 0.1;
/// Bisections of a cell in all.
const DEPTH: u8 = 60;
/// The share of the error that the cells of a round have.
const BULK: f64 = 0.6;

/// One coordinate from an origin: origin + sign · width · sinh(end · u), u in [0, 1].
#[derive(Debug, Clone, Copy)]
struct Ray {
    origin: f64,
    sign: f64,
    width: f64,
    end: f64,
}

impl Ray {
    fn new(origin: f64, sign: f64, width: f64, length: f64) -> Self {
        Self { origin, sign, width, end: (length / width).asinh() }
    }

    fn at(&self, u: f64) -> f64 {
        self.origin + self.sign * self.width * (self.end * u).sinh()
    }

    fn slope(&self, u: f64) -> f64 {
        self.width * self.end * (self.end * u).cosh()
    }

    fn length(&self, [low, high]: [f64; 2]) -> f64 {
        (self.at(high) - self.at(low)).abs()
    }

    /// The u of a coordinate, if it is on the ray.
    fn place(&self, coordinate: f64) -> Option<f64> {
        let u = ((coordinate - self.origin) * self.sign / self.width).asinh() / self.end;
        (0.0..=1.0).contains(&u).then_some(u)
    }
}

#[derive(Debug, Clone)]
struct Cell {
    /// Which rays, and both ends of u along each.
    rays: [usize; 2],
    span: [[f64; 2]; 2],
    sums: [f64; 3],
    /// The error along each coordinate, the largest of the channels.
    errors: [f64; 2],
    depth: u8,
    /// What the parent's cut changed, a half for each; known once both halves are evaluated.
    parent: Option<[f64; 3]>,
}

impl Cell {
    fn error(&self) -> f64 {
        self.errors[0] + self.errors[1]
    }

    fn halves(&self, along: usize) -> [Self; 2] {
        let [low, high] = self.span[along];
        let middle = 0.5 * (low + high);
        [[low, middle], [middle, high]].map(|span| {
            let mut half = self.clone();
            half.span[along] = span;
            half.depth += 1;
            half
        })
    }
}

impl Integral {
    pub fn new(theta_i: f64, phi_i: f64, layout: &Layout) -> Self {
        let Layout { largest, stretch, bilateral } = *layout;
        let (sin, cos) = (theta_i.sin(), theta_i.cos().max(0.0));
        let half = 0.5 * theta_i;
        let rest = 0.5 * (FRAC_PI_2 - theta_i);
        let thetas = [
            (0.0, 1.0, END_WIDTH, half),
            (theta_i, -1.0, WIDTH, half),
            (theta_i, 1.0, WIDTH, rest),
            (FRAC_PI_2, -1.0, END_WIDTH, rest),
        ];
        // A ray shorter than its width is straight.
        let thetas = thetas.iter().filter(|ray| ray.3 > 0.0);
        let thetas: Vec<_> =
            thetas.map(|&(from, sign, w, length)| Ray::new(from, sign, w * stretch, length)).collect();
        let width = stretch * (AZIMUTH_WIDTH * cos.max(1e-4) / sin.max(1e-9)).min(1.0);
        let sides: &[f64] = if bilateral { &[1.0] } else { &[1.0, -1.0] };
        let azimuths = sides.iter().flat_map(|&side| {
            [Ray::new(0.0, side, width, FRAC_PI_2), Ray::new(side * PI, -side, width, FRAC_PI_2)]
        });
        let rays = [thetas, azimuths.collect()];
        let mut integral = Self {
            theta_i,
            phi_i,
            fold: if bilateral { 2.0 } else { 1.0 },
            cells: Vec::new(),
            new: Vec::new(),
            left: 0.0,
            rays,
        };
        // The logarithmic half that a lobe may be in, and the other.
        let mut start = Vec::new();
        for a in 0..integral.rays[0].len() {
            for b in 0..integral.rays[1].len() {
                for u in [[0.0, 0.6], [0.6, 1.0]] {
                    for v in [[0.0, 0.6], [0.6, 1.0]] {
                        start.push(Cell {
                            rays: [a, b],
                            span: [u, v],
                            sums: [0.0; 3],
                            errors: [0.0; 2],
                            depth: 0,
                            parent: None,
                        });
                    }
                }
            }
        }
        while let Some(cell) = start.pop() {
            let [theta, phi] = integral.sizes(&cell);
            match theta.max(phi) > largest {
                true => start.extend(cell.halves(usize::from(phi > theta))),
                false => integral.new.push(cell),
            }
        }
        integral
    }

    /// Cuts the cells around a direction until they are smaller than a size, rad.
    pub fn seed(&mut self, theta_e: f64, delta: f64, size: f64) {
        let delta = if self.rays[1].len() == 2 { delta.abs() } else { delta };
        let mut stack = std::mem::take(&mut self.new);
        while let Some(cell) = stack.pop() {
            let [theta, phi] = self.sizes(&cell);
            let holds = |k: usize, x: f64| {
                let [low, high] = cell.span[k];
                self.rays[k][cell.rays[k]].place(x).is_some_and(|u| u >= low && u <= high)
            };
            match theta.max(phi) > size && cell.depth < DEPTH && holds(0, theta_e) && holds(1, delta) {
                true => stack.extend(cell.halves(usize::from(phi > theta))),
                false => self.new.push(cell),
            }
        }
    }

    /// How long a cell is, rad on the sphere.
    fn sizes(&self, cell: &Cell) -> [f64; 2] {
        let [theta, phi] = [0, 1].map(|k| &self.rays[k][cell.rays[k]]);
        let sin = cell.span[0].map(|u| theta.at(u).sin()).into_iter().fold(0.0, f64::max);
        [theta.length(cell.span[0]), sin * phi.length(cell.span[1])]
    }

    /// ρ so far, of the channel that is most for certain.
    pub fn rho(&self) -> Rho {
        let error: f64 = self.cells.iter().map(Cell::error).sum();
        let value = |c: usize| self.cells.iter().map(|cell| cell.sums[c]).sum::<f64>();
        let value = (0..3).map(value).fold(f64::NEG_INFINITY, f64::max);
        Rho { value, estimate: error + self.left + 1e-15 * value.abs() }
    }

    /// Pairs evaluated.
    fn spent(&self) -> usize {
        (2 * self.cells.len()).saturating_sub(1) * NODES.len() * NODES.len()
    }

    /// Cuts what is worst, unless the tolerance is met or the most pairs are spent.
    fn cut(&mut self, tolerance: f64, most: usize) {
        let Rho { value, estimate } = self.rho();
        if self.cells.is_empty() || estimate <= tolerance * value.abs().max(1.0) || self.spent() >= most {
            return;
        }
        // The cells that have most of the error, as many as that takes (Dörfler 1996): few rounds, and few cells in vain.
        self.cells.sort_by(|a, b| b.error().total_cmp(&a.error()));
        let mut marked = 0.0;
        let mut count = 0;
        while count < self.cells.len() && marked < BULK * estimate {
            marked += self.cells[count].error();
            count += 1;
        }
        for mut cell in self.cells.drain(..count).collect::<Vec<_>>() {
            if cell.depth >= DEPTH {
                // As fine as f64 has it: its error stays, and is no one's to mend.
                self.left += cell.error();
                cell.errors = [0.0; 2];
                self.cells.push(cell);
                continue;
            }
            let along = usize::from(cell.errors[1] > cell.errors[0]);
            for mut half in cell.halves(along) {
                half.parent = Some(cell.sums);
                self.new.push(half);
            }
        }
    }

    /// Appends the pairs of the new cells.
    fn pairs(&self, pairs: &mut Vec<Angles>) {
        for cell in &self.new {
            let [theta, phi] = self.nodes(cell);
            for [theta_e, _] in theta {
                for [delta, _] in phi {
                    let phi_e = self.phi_i + PI + delta;
                    pairs.push(Angles { theta_i: self.theta_i, phi_i: self.phi_i, theta_e, phi_e });
                }
            }
        }
    }

    /// Coordinates and their derivatives along u.
    fn nodes(&self, cell: &Cell) -> [[[f64; 2]; 7]; 2] {
        [0, 1].map(|k| {
            let (ray, [low, high]) = (&self.rays[k][cell.rays[k]], cell.span[k]);
            NODES.map(|node| {
                let u = 0.5 * (low + high) + 0.5 * (high - low) * node[0];
                let x = ray.at(u);
                // The last digit may lie beyond the horizon.
                [if k == 0 { x.clamp(0.0, FRAC_PI_2) } else { x }, 0.5 * (high - low) * ray.slope(u)]
            })
        })
    }

    /// Sums the new cells, whose values come in the order of [`Integral::pairs`].
    fn take(&mut self, values: &mut std::slice::ChunksExact<f32>, channels: usize) {
        let mut new = std::mem::take(&mut self.new);
        for cell in &mut new {
            let [theta, phi] = self.nodes(cell);
            let (mut sums, mut rough, mut size) = ([0.0; 3], [[0.0; 3]; 2], [0.0; 3]);
            for ([theta_e, d_theta], [_, kronrod, gauss]) in theta.into_iter().zip(NODES) {
                let weight = self.fold * theta_e.cos().max(0.0) * theta_e.sin() * d_theta;
                for ([_, d_phi], [_, kronrod_phi, gauss_phi]) in phi.into_iter().zip(NODES) {
                    let Some(values) = values.next() else { return };
                    for c in 0..channels {
                        // What is not finite is reported as such, and must not hide the rest.
                        let value = if is_non_finite(values[c]) { 0.0 } else { f64::from(values[c]) };
                        let value = weight * d_phi * value;
                        sums[c] += kronrod * kronrod_phi * value;
                        rough[0][c] += gauss * kronrod_phi * value;
                        rough[1][c] += kronrod * gauss_phi * value;
                        size[c] += kronrod * kronrod_phi * value.abs();
                    }
                }
            }
            // As QUADPACK has it: the finer rule is better than the coarser one by more than they differ.
            let error = |k: usize| {
                let of = |c: usize| {
                    let difference = (sums[c] - rough[k][c]).abs();
                    if size[c] > 0.0 {
                        difference * (100.0 * difference / size[c]).sqrt().min(1.0)
                    } else {
                        0.0
                    }
                };
                (0..channels).map(of).fold(0.0, f64::max)
            };
            (cell.sums, cell.errors) = (sums, [error(0), error(1)]);
        }
        // Halves come in twos: what their parent was off by.
        for k in 0..new.len() {
            let Some(parent) = new[k].parent.take() else { continue };
            if k + 1 < new.len() && new[k + 1].parent.take().is_some() {
                let change = |c: usize| (new[k].sums[c] + new[k + 1].sums[c] - parent[c]).abs();
                let least = 0.5 * CHANGE * (0..channels).map(change).fold(0.0, f64::max);
                let along = usize::from(new[k].span[0] == new[k + 1].span[0]);
                for half in &mut new[k..k + 2] {
                    half.errors[along] = half.errors[along].max(least);
                }
            }
        }
        self.cells.extend(new);
    }
}

/// Refines integrals at one setting until each is within the tolerance (relative where ρ > 1) or has taken so many pairs.
pub(super) fn refine(
    probe: &mut Probe,
    setting: &[f64],
    integrals: &mut [Integral],
    tolerance: f64,
    most: usize,
) -> Result<()> {
    let channels = probe.channels();
    loop {
        let mut pairs = Vec::new();
        for integral in &mut *integrals {
            if integral.new.is_empty() {
                integral.cut(tolerance, most);
            }
            integral.pairs(&mut pairs);
        }
        if pairs.is_empty() {
            return Ok(());
        }
        let values = probe.evaluate(setting, &pairs)?;
        let mut values = values.chunks_exact(channels);
        integrals.iter_mut().for_each(|integral| integral.take(&mut values, channels));
    }
}

/// Kronrod's nodes on [−1, 1] and their weights; Gauss's weights of every other one (QUADPACK's way, of 3 and 7).
const NODES: [[f64; 3]; 7] = [
    [-0.960_491_268_708_020_3, 0.104_656_226_026_467_27, 0.0],
    [-0.774_596_669_241_483_4, 0.268_488_089_868_333_44, 5.0 / 9.0],
    [-0.434_243_749_346_802_55, 0.401_397_414_775_962_2, 0.0],
    [0.0, 0.450_916_538_658_474_14, 8.0 / 9.0],
    [0.434_243_749_346_802_55, 0.401_397_414_775_962_2, 0.0],
    [0.774_596_669_241_483_4, 0.268_488_089_868_333_44, 5.0 / 9.0],
    [0.960_491_268_708_020_3, 0.104_656_226_026_467_27, 0.0],
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_rules_are_exact_to_their_degrees() {
        for degree in 0..12 {
            let [kronrod, gauss] =
                [1, 2].map(|w| NODES.iter().map(|n| n[w] * n[0].powi(degree)).sum::<f64>());
            let exact = if degree % 2 == 0 { 2.0 / (f64::from(degree) + 1.0) } else { 0.0 };
            assert!((kronrod - exact).abs() < 1e-14, "{degree}: {kronrod}");
            assert_eq!((gauss - exact).abs() < 1e-14, degree < 6 || degree % 2 == 1, "{degree}: {gauss}");
        }
    }
}
