//! Irradiance E(n) = ∫ L(ω) max(0, n·ω) dω.
//!
//! Of a map, L is constant over a cell, so a cell that is above the surface sends L n·∫ω dω, and that integral is in
//! closed form ([`DirectionCell::vector`](crate::base::radiometry::DirectionCell::vector)). In a row these are, but for two factors of the row's, L ∫(cos ψ, sin ψ, 1) dψ, whose
//! sums over columns are made once: a row costs a normal two look-ups, and beside those only columns where the horizon
//! crosses the row. There n·ω = A cos θ + B(ψ) sin θ is above 0 down each meridian from the row's border to θh, sin(θh − θm) =
//! n·ω(θm)/√(A² + B²). Between them the integral is in closed form, A ∫cos θ sin θ dθ + B ∫sin² θ dθ. Over ψ it is integrated
//! by Gauss–Legendre, on pieces between the borders of columns and where the horizon leaves the row: there it is smooth. As
//! n·ω = 0 where it is cut, a cut that is off by η costs η²/2 and no more, so the pieces' ends need no accurate arc cosine.
//!
//! Each of these terms, of a row's whole columns and of a meridian, is an integral of L max(0, n·ω), which is not negative,
//! and so a rounding below 0 is taken as 0: that only brings it nearer.
//!
//! A horizon crosses each column once, and a row's border twice: a normal costs two look-ups a row, and W + 2 H cells of a few
//! nodes in a map of W × H. On software Vulkan that is 0.1 µs a cell.
//!
//! This is the twin of `shaders/light/irradiance.wgsl`, in f64, and all that the shader is given.

use crate::bake::Evaluator;
use crate::base::error::Result;
use crate::base::radiometry::{chord, sin2};
use crate::light::{Environment, Light, dot};
use rayon::prelude::*;
use std::borrow::Cow;
use std::f64::consts::{PI, TAU};

/// Maps with fewer columns or rows are given as the same function on a finer grid, so that cells are small.
const LEAST: [usize; 2] = [64, 32];
/// Columns between sums that are kept, at most.
pub(crate) const BLOCK: usize = 16;
/// Sums that are kept, if not more columns lie between them than that: 72 bytes each.
const KEPT: usize = 1 << 19;
/// By how much a horizon's azimuth may be off, rad: what f32 makes of an arc cosine near 1, and 7e-5 of its polynomial.
const MARGIN: f64 = 1e-3;
/// The least n·ω/(…) that is divided by: rows at a pole and normals along it have no azimuth.
const TINY: f64 = 1e-30;
/// Roundings on a term's way: of n and of a sum of 16 columns, of five products and sums of them, and of the sum over
/// crossed columns, of which there are up to π/n·ω.
const ROUNDINGS: f64 = 24.0;
/// Gauss–Legendre's two nodes on [−1, 1] are ± this, of weight 1.
const NODE: f64 = 0.577_350_269_189_625_8;

/// Computes E(n) in closed form; `None` for a map, which has none.
pub fn in_closed_form(light: &Light, normal: [f64; 3]) -> Option<[f64; 3]> {
    match light {
        Light::Constant(radiance) => Some(radiance.rgb().map(|l| PI * l)),
        Light::Directional(sun) => {
            let cos = dot(normal, sun.direction()).max(0.0);
            Some(sun.irradiance().map(|e| e * cos))
        }
        Light::Disk(disk) => {
            let factor = disk.form_factor(normal);
            Some(disk.radiance().map(|l| l * factor))
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
pub(crate) struct MapColumn {
    /// (cos, sin) of ψ in its middle.
    pub middle: [f64; 2],
    /// ∫ (cos ψ, sin ψ) dψ over it.
    pub chord: [f64; 2],
}

/// For x, y and z, R, G and B each: Σ L ∫(cos ψ, sin ψ, 1) dψ.
pub(crate) type Sums = [[f64; 3]; 3];

/// A map, ready to be integrated.
pub(crate) struct PreparedMap<'a> {
    pub map: Cow<'a, Environment>,
    pub rows: Vec<Row>,
    pub columns: Vec<MapColumn>,
    /// Columns between sums that are kept.
    pub block: usize,
    /// For each row, the sums of the first 0, `block`, 2 `block`, … columns.
    pub sums: Vec<Sums>,
    /// Δψ, and half of Δθ.
    pub step: f64,
    pub half: f64,
    /// [`MARGIN`] in columns.
    pub margin: f64,
}

/// A normal in the map's frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SurfaceNormal {
    pub n: [f64; 3],
    /// sin θn.
    pub sin: f64,
    /// Its azimuth, in columns.
    pub place: f64,
}

impl<'a> PreparedMap<'a> {
    pub fn new(map: &'a Environment) -> Self {
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
            MapColumn { middle: cos_sin(0.5 * (psi[0] + psi[1])), chord: chord(psi) }
        };
        let rows = (0..map.height()).map(row).collect();
        let columns: Vec<_> = (0..map.width()).map(column).collect();
        let step = TAU / map.width() as f64;
        let block = (map.texels().len() / KEPT).next_power_of_two().clamp(1, BLOCK);
        let sums = (0..map.height()).into_par_iter().flat_map_iter(|row| {
            let mut sums = [[0.0; 3]; 3];
            let mut kept = vec![sums];
            for (column, at) in columns.iter().enumerate() {
                add(&mut sums, map.texel(row, column), at, step);
                if (column + 1) % block == 0 {
                    kept.push(sums);
                }
            }
            kept
        });
        let sums = sums.collect();
        let half = 0.5 * PI / map.height() as f64;
        Self { rows, columns, block, sums, step, half, margin: MARGIN / step, map }
    }

    /// Sums that a row has.
    pub fn kept(&self) -> usize {
        self.map.width() / self.block + 1
    }

    /// A unit vector of the world.
    pub fn normal(&self, world: [f64; 3]) -> SurfaceNormal {
        let n = self.map.turn(world);
        let place = n[1].atan2(n[0]).rem_euclid(TAU) / self.step;
        SurfaceNormal { n, sin: n[0].hypot(n[1]), place }
    }

    /// What roundings of a unit roundoff may cost E, R, G, B: of ∫ L dω, as n·ω is that of vectors of length 1, and near the
    /// horizon a difference of terms that are not small. [`ROUNDINGS`] says how many there are; sums over columns of up to
    /// a row's width are in f64 on either path.
    pub fn roundings(&self, unit: f64) -> [f64; 3] {
        let all = ROUNDINGS * unit + self.map.width() as f64 * 0.5f64.powi(53);
        self.map.total().map(|total| all * total)
    }

    /// Whether f32 holds the map's sums, with room for their products.
    pub fn fits_f32(&self) -> bool {
        let largest = self.map.texels().as_flattened().iter().fold(0.0f32, |most, &x| most.max(x));
        largest == 0.0 || (1e-20..1e30).contains(&largest)
    }

    /// E of some normals of the world, R, G, B; where the horizon crosses a row, each column has `split` pieces.
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
            Evaluator::Device(device) => device.irradiance(self, normals, split, tick),
            Evaluator::Cpu => {
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
    fn row(&self, normal: &SurfaceNormal, row: usize, split: u32) -> [f64; 3] {
        let [inner, outer] = self.reach(normal, row);
        // Columns first..last are above. The others have at most one piece each side of the normal's azimuth.
        let sure = (inner - self.margin).max(0.0);
        let whole = |x: f64| x as i64;
        let (first, last) = (whole((normal.place - sure).ceil()), whole((normal.place + sure).floor()));
        let begin = whole((normal.place - outer - self.margin).floor());
        let end = whole((normal.place + outer + self.margin).ceil());

        let width = self.map.width();
        let wrap = |column: i64| column.rem_euclid(width as i64) as usize;
        let (from, count) = (wrap(first), (last - first).max(0) as usize);
        let before_the_edge = count.min(width - from);
        let mut sums = self.run(row, from, from + before_the_edge);
        add_sums(&mut sums, &self.run(row, 0, count - before_the_edge), 1.0);
        let Row { across, along, .. } = self.rows[row];
        let [x, y, z] = normal.n;
        let whole = |c: usize| across * (x * sums[0][c] + y * sums[1][c]) + z * along * sums[2][c];
        let mut sum = std::array::from_fn(|c| whole(c).max(0.0));
        let sides = (begin..first).map(|k| (k, -1.0)).chain((last..end).map(|k| (k, 1.0)));
        for (k, side) in sides {
            let texel = self.map.texel(row, wrap(k));
            if texel != [0.0; 3] {
                let part = self.column(normal, row, (k, wrap(k)), side, [inner, outer], split);
                (0..3).for_each(|c| sum[c] += f64::from(texel[c]) * part);
            }
        }
        sum
    }

    /// Up to how many columns on each side of the normal's azimuth all of a row is above the surface, and beyond how many
    /// all is below: n·ω = 0 at cos(ψ − ψn) = −cot θn cot θ.
    fn reach(&self, normal: &SurfaceNormal, row: usize) -> [f64; 2] {
        let reach = |[c, s]: [f64; 2]| {
            let x = -normal.n[2] * c / (normal.sin * s).max(TINY);
            x.clamp(-1.0, 1.0).acos() / self.step
        };
        let [a, b] = self.rows[row].edges.map(reach);
        [a.min(b), a.max(b)]
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
        let (a, b) = (first.div_ceil(self.block), end / self.block);
        if a >= b {
            return direct(first, end);
        }
        let mut sums = direct(first, a * self.block);
        add_sums(&mut sums, &direct(b * self.block, end), 1.0);
        add_sums(&mut sums, &self.sums[row * self.kept() + b], 1.0);
        add_sums(&mut sums, &self.sums[row * self.kept() + a], -1.0);
        sums
    }

    /// ∫ max(0, n·ω) dω over a cell, of what is on one side of the normal's azimuth: up to `inner` the row is above, up to
    /// `outer` crossed. These are columns from that azimuth; offsets are columns from the cell's middle, away from it.
    fn column(
        &self,
        normal: &SurfaceNormal,
        row: usize,
        (k, column): (i64, usize),
        side: f64,
        [inner, outer]: [f64; 2],
        split: u32,
    ) -> f64 {
        let turn = 0.5 * self.map.width() as f64;
        let middle = side * (k as f64 + 0.5 - normal.place);
        let within = |place: f64| (place - middle).clamp(-0.5, 0.5);
        let [start, stop] = [0.0, turn].map(within);
        let [inner, outer] = [inner, outer].map(|place| within(place).clamp(start, stop));
        let across = |offset: f64| {
            let [cos, sin] = turned(self.columns[column].middle, side * offset * self.step);
            normal.n[0] * cos + normal.n[1] * sin
        };
        let part = |from: f64, to: f64| -> f64 {
            let end = |j: u32| from + (to - from) * f64::from(j) / f64::from(split);
            let piece =
                |j: u32| gauss([end(j), end(j + 1)], |offset| self.meridian(normal, row, across(offset)));
            if from < to { (0..split).map(piece).sum() } else { 0.0 }
        };
        self.step * (part(start, inner) + part(inner, outer))
    }

    /// ∫ max(0, n·ω) sin θ dθ over a row, n·ω = nz cos θ + B sin θ.
    fn meridian(&self, normal: &SurfaceNormal, row: usize, b: f64) -> f64 {
        let [cos, sin] = self.rows[row].middle;
        let z = normal.n[2];
        let height = (z * cos + b * sin) / z.hypot(b).max(TINY);
        // The horizon from the row's middle: below it where the normal points up.
        let q = height * height;
        let horizon = height * (1.0 + q * (1.0 / 6.0 + q * (3.0 / 40.0 + q * (15.0 / 336.0))));
        let horizon = horizon.clamp(-self.half, self.half);
        let [from, to] = if z >= 0.0 { [-self.half, horizon] } else { [-horizon, self.half] };
        let [cos, sin] = turned([cos, sin], 0.5 * (from + to));
        // sin Δθ, and ½ (Δθ − sin Δθ).
        let span = to - from;
        let q = span * span;
        let tail = 1.0 - q / 20.0 * (1.0 - q / 42.0 * (1.0 - q / 72.0));
        let (chord, bulge) = (span * (1.0 - q / 6.0 * tail), span * q / 12.0 * tail);
        (z * cos * sin * chord + b * (bulge + chord * sin * sin)).max(0.0)
    }
}

/// Gauss–Legendre of two nodes.
fn gauss([a, b]: [f64; 2], f: impl Fn(f64) -> f64) -> f64 {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    half * (f(middle - NODE * half) + f(middle + NODE * half))
}

/// (cos, sin) of an angle that is larger by `by`, at most π/64: series to their last digits.
fn turned([c, s]: [f64; 2], by: f64) -> [f64; 2] {
    let q = by * by;
    let cos = 1.0 - q * (0.5 - q * (1.0 / 24.0 - q * (1.0 / 720.0 - q / 40320.0)));
    let sin = by * (1.0 - q * (1.0 / 6.0 - q * (1.0 / 120.0 - q / 5040.0)));
    [c * cos - s * sin, s * cos + c * sin]
}

fn add(sums: &mut Sums, texel: [f32; 3], column: &MapColumn, step: f64) {
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
