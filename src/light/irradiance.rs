//! Irradiance E(n) = ∫ L(ω) max(0, n·ω) dω.
//!
//! Of a map, L is constant over a cell, so a cell that is above the surface sends L n·∫ω dω, and that integral is in
//! closed form ([`Cell::vector`](crate::radiometry::Cell::vector)). In a row these are, but for two factors of the row's, L ∫(cos ψ, sin ψ, 1) dψ, whose
//! sums over columns are made once: a row costs a normal two look-ups, and beside those only cells that the horizon
//! crosses. Those are cut where n·ω, linear over triangles of a cell's parameters (θ, ψ), changes its sign, and what is
//! left is integrated by the rule of three midpoints, exact to degree 2. Where the cut is displaced by η, n·ω is at most
//! η: with η ~ Δ²/8, what that costs is Δ²/20 of what a crossing cell sends, and that is Δ of what a cell does.
//!
//! This is the twin of `shaders/light/irradiance.wgsl`, in f64, and all that the shader is given.

use super::{Environment, Light, dot};
use crate::bake::Evaluator;
use crate::error::Result;
use crate::radiometry::{chord, sin2};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Maps with fewer columns or rows are given as the same function on a finer grid, so that cells are small.
const LEAST: [usize; 2] = [64, 32];
/// Columns between sums that are kept.
pub(crate) const BLOCK: usize = 16;
/// Columns by which what is surely above the surface, or surely not, stays away from the horizon: what f32 and an
/// arc cosine of 7e-5 rad make of 16384 columns, and one for the rounding to whole columns.
const MARGIN: f64 = 1.5;
/// The least n·ω/(…) that is divided by: rows at a pole and normals along it have no azimuth.
const TINY: f64 = 1e-30;

/// E(n) of any light but a map, in closed form.
pub fn in_closed_form(light: &Light, normal: [f64; 3]) -> Option<[f64; 3]> {
    match light {
        Light::Constant(radiance) => Some(radiance.map(|l| PI * l)),
        Light::Directional { direction, irradiance } => {
            let cos = dot(normal, *direction).max(0.0);
            Some(irradiance.map(|e| e * cos))
        }
        Light::Disk(disk) => {
            let factor = disk.form_factor(normal);
            Some(disk.radiance.map(|l| l * factor))
        }
        Light::Sky(sky) => Some(sky.irradiance(normal)),
        Light::Map(_) => None,
    }
}

/// A row of a map.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Row {
    /// (cos, sin) of θ at its upper and lower border, and in its middle.
    pub edges: [[f64; 2]; 2],
    pub middle: [f64; 2],
    /// ∫ sin² θ dθ and ∫ cos θ sin θ dθ over it.
    pub across: f64,
    pub along: f64,
}

/// A column of a map.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Column {
    /// (cos, sin) of ψ at its left border, and in its middle.
    pub edge: [f64; 2],
    pub middle: [f64; 2],
    /// ∫ (cos ψ, sin ψ) dψ over it.
    pub chord: [f64; 2],
}

/// For x, y and z, R, G and B each: Σ L ∫(cos ψ, sin ψ, 1) dψ.
pub(crate) type Sums = [[f64; 3]; 3];

/// A map, ready to be integrated.
pub(crate) struct Prepared {
    pub map: Environment,
    pub rows: Vec<Row>,
    /// One more than the map has, so that the last has a right border.
    pub columns: Vec<Column>,
    /// For each row, the sums of the first 0, [`BLOCK`], 2 [`BLOCK`], … columns.
    pub sums: Vec<Sums>,
    /// Δψ, and half of Δθ.
    pub step: f64,
    pub half: f64,
}

/// A normal in the map's frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Normal {
    pub n: [f64; 3],
    /// sin θn.
    pub sin: f64,
    /// Its azimuth, in columns.
    pub place: f64,
}

impl Prepared {
    pub fn new(map: &Environment) -> Self {
        let map = map.at_least(LEAST[0], LEAST[1]);
        let cos_sin = |angle: f64| [angle.cos(), angle.sin()];
        let row = |k: usize| {
            let theta = [map.theta(k), map.theta(k + 1)];
            let (middle, height) = (0.5 * (theta[0] + theta[1]), theta[1] - theta[0]);
            Row {
                edges: theta.map(cos_sin),
                middle: cos_sin(middle),
                across: sin2(theta),
                along: 0.5 * (2.0 * middle).sin() * height.sin(),
            }
        };
        let column = |k: usize| {
            let psi = [map.psi(k), map.psi(k + 1)];
            Column { edge: cos_sin(psi[0]), middle: cos_sin(0.5 * (psi[0] + psi[1])), chord: chord(psi) }
        };
        let rows = (0..map.height()).map(row).collect();
        let columns: Vec<_> = (0..=map.width()).map(column).collect();
        let step = TAU / map.width() as f64;
        let sums = (0..map.height()).into_par_iter().flat_map_iter(|row| {
            let mut sums = [[0.0; 3]; 3];
            let mut kept = vec![sums];
            for (column, at) in columns.iter().take(map.width()).enumerate() {
                add(&mut sums, map.texel(row, column), at, step);
                if (column + 1) % BLOCK == 0 {
                    kept.push(sums);
                }
            }
            kept
        });
        let sums = sums.collect();
        let half = 0.5 * PI / map.height() as f64;
        Self { rows, columns, sums, step, half, map }
    }

    /// Sums that a row has.
    pub fn kept(&self) -> usize {
        self.map.width() / BLOCK + 1
    }

    /// A unit vector of the world.
    pub fn normal(&self, world: [f64; 3]) -> Normal {
        let n = self.map.turn(world);
        let place = n[1].atan2(n[0]).rem_euclid(TAU) / self.step;
        Normal { n, sin: n[0].hypot(n[1]), place }
    }

    /// E of some normals of the world, R, G, B; cells that the horizon crosses are cut into `split`² first.
    pub fn irradiance(&self, normals: &[[f64; 3]], split: u32) -> Vec<[f64; 3]> {
        let of = |&world: &[f64; 3]| {
            let normal = self.normal(world);
            let rows = (0..self.rows.len()).map(|row| self.row(&normal, row, split));
            rows.fold([0.0; 3], plus)
        };
        normals.par_iter().map(of).collect()
    }

    /// The same, by whichever evaluator can.
    pub fn of(
        &self,
        evaluator: &Evaluator,
        normals: &[[f64; 3]],
        split: u32,
        tick: &dyn Fn(f64) -> Result<()>,
    ) -> Result<Vec<[f64; 3]>> {
        match evaluator {
            Evaluator::Device(device) if device.runs_irradiance(self, split)? => {
                device.irradiance(self, normals, split, tick)
            }
            _ => {
                let mut all = Vec::with_capacity(normals.len());
                for piece in normals.chunks(256) {
                    all.extend(self.irradiance(piece, split));
                    tick(piece.len() as f64 / normals.len() as f64)?;
                }
                Ok(all)
            }
        }
    }

    /// What a row sends.
    fn row(&self, normal: &Normal, row: usize, split: u32) -> [f64; 3] {
        let [inner, outer] = self.reach(normal, row);
        let width = self.map.width() as i64;
        // Columns first..last are above, and beside them begin..first and last..end may be crossed.
        let (mut begin, mut end) =
            ((normal.place - outer).floor() as i64, (normal.place + outer).ceil() as i64);
        if end - begin > width {
            begin = normal.place.round() as i64 - width / 2;
            end = begin + width;
        }
        let centre = normal.place.round() as i64;
        let (mut first, mut last) =
            ((normal.place - inner).ceil() as i64, (normal.place + inner).floor() as i64);
        if inner <= 0.0 || first > last {
            (first, last) = (centre, centre);
        }
        (first, last) = (first.clamp(begin, end), last.clamp(begin, end));

        let wrap = |column: i64| column.rem_euclid(width) as usize;
        let (from, count) = (wrap(first), (last - first) as usize);
        let before_the_edge = count.min(width as usize - from);
        let mut sums = self.run(row, from, from + before_the_edge);
        add_sums(&mut sums, &self.run(row, 0, count - before_the_edge), 1.0);
        let Row { across, along, .. } = self.rows[row];
        let [x, y, z] = normal.n;
        let mut sum =
            std::array::from_fn(|c| across * (x * sums[0][c] + y * sums[1][c]) + z * along * sums[2][c]);
        for column in (begin..first).chain(last..end).map(wrap) {
            let part = self.cell(normal, row, column, split);
            let texel = self.map.texel(row, column);
            (0..3).for_each(|c| sum[c] += f64::from(texel[c]) * part);
        }
        sum
    }

    /// How many columns on each side of the normal's azimuth are surely above the surface, and beyond how many all are
    /// below: n·ω = 0 at cos(ψ − ψn) = −cot θn cot θ.
    fn reach(&self, normal: &Normal, row: usize) -> [f64; 2] {
        let reach = |[c, s]: [f64; 2]| {
            let x = -normal.n[2] * c / (normal.sin * s).max(TINY);
            x.clamp(-1.0, 1.0).acos() / self.step
        };
        let [a, b] = self.rows[row].edges.map(reach);
        [a.min(b) - MARGIN, a.max(b) + MARGIN]
    }

    /// The sums of columns `first` to before `end`.
    fn run(&self, row: usize, first: usize, end: usize) -> Sums {
        let direct = |first: usize, end: usize| {
            let mut sums = [[0.0; 3]; 3];
            for column in first..end {
                add(&mut sums, self.map.texel(row, column), &self.columns[column], self.step);
            }
            sums
        };
        let (a, b) = (first.div_ceil(BLOCK), end / BLOCK);
        if a >= b {
            return direct(first, end);
        }
        let mut sums = direct(first, a * BLOCK);
        add_sums(&mut sums, &direct(b * BLOCK, end), 1.0);
        add_sums(&mut sums, &self.sums[row * self.kept() + b], 1.0);
        add_sums(&mut sums, &self.sums[row * self.kept() + a], -1.0);
        sums
    }

    /// ∫ max(0, n·ω) dω over a cell.
    fn cell(&self, normal: &Normal, row: usize, column: usize, split: u32) -> f64 {
        let at = &self.rows[row];
        let height = |[c, s]: [f64; 2], [cos, sin]: [f64; 2]| {
            normal.n[2] * c + s * (normal.n[0] * cos + normal.n[1] * sin)
        };
        let [left, right] = [self.columns[column].edge, self.columns[column + 1].edge];
        let corners = at.edges.map(|edge| [height(edge, left), height(edge, right)]);
        let [low, high] = range(corners.as_flattened());
        if high <= 0.0 {
            return 0.0;
        }
        let [x, y] = self.columns[column].chord;
        if low >= 0.0 {
            return at.across * (normal.n[0] * x + normal.n[1] * y) + normal.n[2] * at.along * self.step;
        }
        let above = |[e, d]: [f64; 2]| {
            let [c, s] = turned(at.middle, e);
            let direction = turned(self.columns[column].middle, d);
            [height([c, s], direction), s]
        };
        let mut sum = 0.0;
        cut([self.half, 0.5 * self.step], split, &above, &mut |point, weight| {
            let [height, sin] = above(point);
            sum += weight * height * sin;
        });
        sum
    }
}

/// (cos, sin) of an angle that is larger by `by`, which is small.
fn turned([c, s]: [f64; 2], by: f64) -> [f64; 2] {
    let (sin, cos) = by.sin_cos();
    [c * cos - s * sin, s * cos + c * sin]
}

/// The nodes of what is above the horizon in a cell of parameters within ±`half`: points (θ, ψ) from its middle, and
/// their weights in the parameters' own measure. `above` gives n·ω, by which triangles are cut, and sin θ.
fn cut(
    half: [f64; 2],
    split: u32,
    above: &impl Fn([f64; 2]) -> [f64; 2],
    take: &mut impl FnMut([f64; 2], f64),
) {
    let at = |k: u32, half: f64| half * (2.0 * f64::from(k) / f64::from(split) - 1.0);
    for i in 0..split {
        for j in 0..split {
            let corner = |i: u32, j: u32| {
                let point = [at(i, half[0]), at(j, half[1])];
                Corner { point, height: above(point)[0] }
            };
            let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            triangle([a, b, c], take);
            triangle([a, c, d], take);
        }
    }
}

#[derive(Clone, Copy)]
struct Corner {
    point: [f64; 2],
    height: f64,
}

/// What is above the horizon in a triangle.
fn triangle([a, b, c]: [Corner; 3], take: &mut impl FnMut([f64; 2], f64)) {
    match [a, b, c].map(|corner| corner.height > 0.0) {
        [true, true, true] => midpoints([a.point, b.point, c.point], take),
        [false, false, false] => {}
        // The corner that is alone on its side comes first.
        [x, y, _] if x == y => alone([c, a, b], take),
        [x, _, z] if x == z => alone([b, c, a], take),
        _ => alone([a, b, c], take),
    }
}

fn alone([a, b, c]: [Corner; 3], take: &mut impl FnMut([f64; 2], f64)) {
    let between = |end: &Corner| {
        let t = a.height / (a.height - end.height);
        std::array::from_fn(|k| a.point[k] + t * (end.point[k] - a.point[k]))
    };
    let (p, q) = (between(&b), between(&c));
    if a.height > 0.0 {
        midpoints([a.point, p, q], take);
    } else {
        midpoints([p, b.point, c.point], take);
        midpoints([p, c.point, q], take);
    }
}

/// The rule of the sides' midpoints, exact to degree 2 (Strang & Fix 1973, table 4.1).
fn midpoints([a, b, c]: [[f64; 2]; 3], take: &mut impl FnMut([f64; 2], f64)) {
    let [u, v] = [b, c].map(|p| [p[0] - a[0], p[1] - a[1]]);
    let area = 0.5 * (u[0] * v[1] - u[1] * v[0]).abs();
    for [p, q] in [[a, b], [b, c], [c, a]] {
        take([0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])], area / 3.0);
    }
}

fn add(sums: &mut Sums, texel: [f32; 3], column: &Column, step: f64) {
    for (sum, factor) in sums.iter_mut().zip([column.chord[0], column.chord[1], step]) {
        (0..3).for_each(|c| sum[c] += f64::from(texel[c]) * factor);
    }
}

fn add_sums(sums: &mut Sums, more: &Sums, times: f64) {
    for (sum, more) in sums.as_flattened_mut().iter_mut().zip(more.as_flattened()) {
        *sum += times * more;
    }
}

fn plus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|c| a[c] + b[c])
}

/// The least and the largest.
pub(crate) fn range(values: &[f64]) -> [f64; 2] {
    values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &x| [low.min(x), high.max(x)])
}
