//! A table of integrals is a smooth function of (μ, roughness): they are done at a few *sources* along each axis,
//! Chebyshev points, and polynomials carry them to the texels. Two products of matrices take the place of
//! an integral each.
//!
//! A polynomial is limited by the branch points of ρ off the real axis: at μ = ±iα and so, along roughness
//! r = √α, at √(±iμ) (see [`Branches`]). In x = asinh(value/δ), linear up to δ and logarithmic beyond, they
//! keep away from the range by up to π/2 and π/4. With n Chebyshev points the error falls as e^(−n q), where
//! cosh q is the half axis of the largest ellipse with foci at the range's ends that holds no branch point
//! (Trefethen 2013, theorem 8.2): so many points as
//!     strength · e^(−n q) ≤ tolerance/8
//! asks for, with δ the best of a few. Values so near 0 that to reach them would take more points than there are of
//! them are sources themselves.

use crate::models::Branches;
use rayon::prelude::*;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// An axis whose integrals are done elsewhere.
pub(crate) struct Spread {
    /// Where: μ, or α.
    pub sources: Vec<f64>,
    /// What each value of the axis takes of each source.
    pub matrix: Matrix,
}

/// A matrix, row by row.
pub(crate) struct Matrix {
    pub rows: usize,
    pub columns: usize,
    pub values: Vec<f64>,
}

/// The error of each axis, as a share of the tolerance: the rule and rounding take the rest.
const SHARE: f64 = 1.0 / 8.0;
/// More sources than this share of the values do not pay.
const PAYS: f64 = 0.7;
/// Below it, roughness is the mirror's (α = 1e-12), and to interpolate from there means nothing.
const SMALLEST: f64 = 1e-6;
/// Branch points closer together than this ratio are as good as one.
const RATIO: f64 = 1.4;
/// Ellipses larger than e^q have other things in them.
const MOST_Q: f64 = 1.5;
/// How many of the smallest values may be sources themselves.
const KEPT: [usize; 9] = [0, 1, 2, 3, 4, 6, 8, 12, 16];
/// The longest axis that an identity carries over, where only the other one is spread.
const LONGEST_IDENTITY: usize = 512;

impl Spread {
    /// Along roughness, for lobes seen at `mus`; `None` where it does not pay.
    pub fn along_roughness(alphas: &[f64], mus: &[f64], branches: Branches, tolerance: f64) -> Option<Self> {
        let roughness: Vec<_> = alphas.iter().map(|alpha| alpha.sqrt()).collect();
        let points = thinned(mus).map(|mu| [FRAC_1_SQRT_2 * mu.sqrt(); 2]).collect::<Vec<_>>();
        let spread = Self::new(&roughness, &points, branches.strength, tolerance)?;
        Some(Self { sources: spread.sources.iter().map(|r| r * r).collect(), ..spread })
    }

    /// Along μ, for lobes of `alphas`; `None` where it does not pay.
    pub fn along_mu(mus: &[f64], alphas: &[f64], branches: Branches, tolerance: f64) -> Option<Self> {
        let points = thinned(alphas).map(|alpha| [0.0, alpha]).collect::<Vec<_>>();
        Self::new(mus, &points, branches.strength, tolerance)
    }

    /// Every value its own source, on an axis that is not too long for that.
    pub fn identity(values: &[f64]) -> Option<Self> {
        let n = values.len();
        let unit = (0..n * n).map(|k| if k % (n + 1) == 0 { 1.0 } else { 0.0 });
        (n <= LONGEST_IDENTITY).then(|| Self {
            sources: values.to_vec(),
            matrix: Matrix { rows: n, columns: n, values: unit.collect() },
        })
    }

    fn new(values: &[f64], points: &[[f64; 2]], strength: f64, tolerance: f64) -> Option<Self> {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        sorted.dedup();
        let largest = *sorted.last()?;
        let first = sorted.partition_point(|&value| value < SMALLEST);
        let splits = KEPT.iter().map(|k| first + k).filter(|&k| k < sorted.len());
        let of = |kept: usize| {
            (kept, Polynomial::new([sorted[kept], largest], points, (strength / (SHARE * tolerance)).ln()))
        };
        let (kept, polynomial) = splits.map(of).min_by_key(|(kept, p)| kept + p.n)?;
        let kept = &sorted[..kept];
        let columns = kept.len() + polynomial.n;
        if columns as f64 > PAYS * values.len() as f64 {
            return None;
        }
        let row = |&value: &f64| {
            let mut row = vec![0.0; columns];
            match kept.iter().position(|&k| k == value) {
                Some(k) => row[k] = 1.0,
                None => polynomial.weigh(value, &mut row[kept.len()..]),
            }
            row
        };
        let matrix = Matrix { rows: values.len(), columns, values: values.iter().flat_map(row).collect() };
        let sources = kept.iter().copied().chain((0..polynomial.n).map(|k| polynomial.source(k))).collect();
        Some(Self { sources, matrix })
    }
}

impl Matrix {
    /// One row.
    pub fn row(values: Vec<f64>) -> Self {
        Self { rows: 1, columns: values.len(), values }
    }

    /// out[c, u] = Σ M[c, n] raw[u, n]: transposed, so that a second product does the other axis.
    pub fn apply(&self, raw: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let sum = |row: &[f64], raw: &[[f64; 2]]| {
            row.iter().zip(raw).fold([0.0; 2], |[a, b], (m, [x, y])| [a + m * x, b + m * y])
        };
        let rows = self.values.par_chunks(self.columns);
        rows.flat_map_iter(|row| raw.chunks(self.columns).map(move |raw| sum(row, raw))).collect()
    }
}

/// Interpolation by a polynomial in asinh(value/δ).
struct Polynomial {
    n: usize,
    delta: f64,
    middle: f64,
    half: f64,
}

impl Polynomial {
    /// With as many points as bring e^(−n q) to e^(−decay).
    fn new([low, high]: [f64; 2], points: &[[f64; 2]], decay: f64) -> Self {
        const DELTAS: i32 = 9;
        let of = |k: i32| {
            let delta = 0.5 * low * (4.0 * high / low).powf(f64::from(k) / f64::from(DELTAS - 1));
            let [a, b] = [low, high].map(|value| (value / delta).asinh());
            let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
            let q = points.iter().map(|&[re, im]| {
                let [x, y] = asinh([re / delta, im / delta]);
                let (x, y) = ((x - middle) / half, y / half);
                (0.5 * ((x - 1.0).hypot(y) + (x + 1.0).hypot(y))).acosh()
            });
            let q = q.fold(MOST_Q, f64::min);
            let n = if half > 0.0 { 1 + (decay.max(0.0) / q).ceil() as usize } else { 1 };
            Self { n, delta, middle, half }
        };
        (0..DELTAS).map(of).min_by_key(|p| p.n).unwrap_or(Self {
            n: usize::MAX,
            delta: low,
            middle: 0.0,
            half: 0.0,
        })
    }

    /// An angle whose cosine is a Chebyshev point, and their sequence rises.
    fn angle(&self, k: usize) -> f64 {
        PI * (self.n - k) as f64 / self.n as f64 - 0.5 * PI / self.n as f64
    }

    fn source(&self, k: usize) -> f64 {
        self.delta * (self.middle + self.half * self.angle(k).cos()).sinh()
    }

    /// The barycentric formula (Berrut & Trefethen 2004, eq. 4.2, 5.3).
    fn weigh(&self, value: f64, weights: &mut [f64]) {
        let x = ((value / self.delta).asinh() - self.middle) / self.half;
        let mut sum = 0.0;
        for k in 0..self.n {
            let angle = self.angle(k);
            let distance = x - angle.cos();
            // One point, or on one: that is the value.
            if !(distance.abs() > 0.0) {
                weights.fill(0.0);
                weights[k] = 1.0;
                return;
            }
            weights[k] = if k % 2 == 0 { angle.sin() } else { -angle.sin() } / distance;
            sum += weights[k];
        }
        weights.iter_mut().for_each(|w| *w /= sum);
    }
}

/// asinh of a complex number with Im ≥ 0: from its distances to the branch points ±i.
fn asinh([re, im]: [f64; 2]) -> [f64; 2] {
    let (near, far) = (re.hypot(im - 1.0), re.hypot(im + 1.0));
    [(0.5 * (near + far)).max(1.0).acosh(), (0.5 * (far - near)).clamp(-1.0, 1.0).asin()]
}

/// Positive values, without those that are nearly another.
fn thinned(values: &[f64]) -> impl Iterator<Item = f64> {
    let mut sorted: Vec<_> = values.iter().copied().filter(|&value| value > 0.0).collect();
    sorted.sort_by(f64::total_cmp);
    let mut last = 0.0;
    sorted.retain(|&value| {
        let far = value >= RATIO * last;
        last = if far { value } else { last };
        far
    });
    sorted.into_iter()
}
