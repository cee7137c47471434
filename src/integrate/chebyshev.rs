//! Interpolates a table of integrals along its axes. The table is a smooth function of (μ, roughness), so the integrals
//! are computed at a few *sources* along each axis, Chebyshev points, and polynomials carry them to the texels: two
//! matrix products take the place of an integral for each texel.
//!
//! A polynomial is limited by the branch points of ρ off the real axis: at μ = ±iα and so, along roughness
//! r = √α, at √(±iμ) (see [`Branches`]); and at 0, where ρ has logarithms of μ and of α. In x = asinh(value/δ),
//! linear up to δ and logarithmic beyond, they keep away from the range by up to π/2 and π/4. With n Chebyshev
//! points the error falls as e^(−n q), where cosh q is the half axis of the largest ellipse with foci at the
//! range's ends that holds no branch point (Trefethen 2013, theorem 8.2): n is the least with
//!     strength · growth(q) · e^(−n q) ≤ tolerance/8
//! for the best of a few δ and q. Along μ, Schlick's (1 − μ)⁵ grows beyond the range, and asinh lets an ellipse reach far:
//! growth is its largest value there. The smallest values of an axis are sources themselves where a polynomial that reaches
//! them would take more points than there are such values.

use crate::base::tolerance::CHEBYSHEV_SHARE;
use crate::model::Branches;
use rayon::prelude::*;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// An axis whose values are interpolated between integrals at a few sources.
pub(crate) struct InterpolatedAxis {
    /// The μ, or α, of the integrals.
    pub sources: Vec<f64>,
    /// The interpolation weights: a row for each value of the axis, a column for each source.
    pub matrix: Matrix,
}

/// A matrix, stored row by row.
pub(crate) struct Matrix {
    pub rows: usize,
    pub columns: usize,
    pub values: Vec<f64>,
}

/// The largest number of sources, as a share of the values, at which interpolation pays.
const MAX_SHARE: f64 = 0.7;
/// The least value to interpolate from: below it, the roughness is the mirror's (α = 1e-12).
const SMALLEST: f64 = 1e-6;
/// The ratio of branch points below which two count as one.
const RATIO: f64 = 1.4;
/// The largest q that is used: larger ellipses may hold other singularities.
const MAX_Q: f64 = 1.5;
/// The number of ellipses that are tried for each δ.
const ELLIPSES: i32 = 8;
/// The power of 1 − μ in Schlick's Fresnel term.
const SCHLICK_POWER: i32 = 5;
/// The numbers of smallest values that may be sources themselves.
const KEPT: [usize; 9] = [0, 1, 2, 3, 4, 6, 8, 12, 16];
/// The largest number of matrix entries, and of results between two matrices: with 8 and 16 bytes each, 32 and 64 MiB,
/// which every device binds.
pub(crate) const MAX_ENTRIES: usize = 1 << 22;
/// The longest axis that takes an identity matrix, where only the other one is interpolated.
const LONGEST_IDENTITY: usize = 512;

impl InterpolatedAxis {
    /// Interpolates along roughness, for lobes seen at `mus`; `None` where that does not pay.
    pub fn along_roughness(alphas: &[f64], mus: &[f64], branches: Branches, tolerance: f64) -> Option<Self> {
        let roughness: Vec<_> = alphas.iter().map(|alpha| alpha.sqrt()).collect();
        let points =
            thinned(mus).map(|mu| [FRAC_1_SQRT_2 * mu.sqrt(); 2]).chain([[0.0; 2]]).collect::<Vec<_>>();
        let axis = Self::new(&roughness, &points, branches.strength, 0, tolerance)?;
        Some(Self { sources: axis.sources.iter().map(|r| r * r).collect(), ..axis })
    }

    /// Interpolates along μ, for lobes of `alphas`; `None` where that does not pay.
    pub fn along_mu(mus: &[f64], alphas: &[f64], branches: Branches, tolerance: f64) -> Option<Self> {
        let points = thinned(alphas).map(|alpha| [0.0, alpha]).chain([[0.0; 2]]).collect::<Vec<_>>();
        Self::new(mus, &points, branches.strength, SCHLICK_POWER, tolerance)
    }

    /// Makes every value its own source; `None` on an axis that is too long for that.
    pub fn identity(values: &[f64]) -> Option<Self> {
        let n = values.len();
        let unit = (0..n * n).map(|k| if k % (n + 1) == 0 { 1.0 } else { 0.0 });
        (n <= LONGEST_IDENTITY).then(|| Self {
            sources: values.to_vec(),
            matrix: Matrix { rows: n, columns: n, values: unit.collect() },
        })
    }

    /// Interpolates a function with these branch points that grows as (1 − value)^`power` beyond the range.
    fn new(values: &[f64], points: &[[f64; 2]], strength: f64, power: i32, tolerance: f64) -> Option<Self> {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        sorted.dedup();
        let largest = *sorted.last()?;
        let first = sorted.partition_point(|&value| value < SMALLEST);
        let splits = KEPT.iter().map(|k| first + k).filter(|&k| k < sorted.len());
        let decay = (strength / (CHEBYSHEV_SHARE * tolerance)).ln();
        let polynomial = |kept: usize| (kept, Polynomial::new([sorted[kept], largest], points, decay, power));
        let (kept, polynomial) = splits.map(polynomial).min_by_key(|(kept, p)| kept + p.n)?;
        let kept = &sorted[..kept];
        let columns = kept.len() + polynomial.n;
        if columns as f64 > MAX_SHARE * values.len() as f64
            || values.len().saturating_mul(columns) > MAX_ENTRIES
        {
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
    /// Makes a matrix of one row.
    pub fn row(values: Vec<f64>) -> Self {
        Self { rows: 1, columns: values.len(), values }
    }

    /// Computes out[c, u] = Σ M[c, n] raw[u, n], transposed, so that a second product interpolates the other axis.
    pub fn apply(&self, raw: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let sum = |row: &[f64], raw: &[[f64; 2]]| {
            row.iter().zip(raw).fold([0.0; 2], |[a, b], (m, [x, y])| [a + m * x, b + m * y])
        };
        let rows = self.values.par_chunks(self.columns);
        rows.flat_map_iter(|row| raw.chunks(self.columns).map(move |raw| sum(row, raw))).collect()
    }
}

/// An interpolating polynomial in asinh(value/δ) through n Chebyshev points.
struct Polynomial {
    n: usize,
    delta: f64,
    middle: f64,
    half: f64,
}

impl Polynomial {
    /// The polynomial with as many points as bring growth(q) e^(−n q) down to e^(−decay), for the best δ and q.
    fn new(range: [f64; 2], points: &[[f64; 2]], decay: f64, power: i32) -> Self {
        const DELTAS: i32 = 9;
        let [low, high] = range;
        let candidate = |k: i32| {
            let delta = 0.5 * low * (4.0 * high / low).powf(f64::from(k) / f64::from(DELTAS - 1));
            let [a, b] = range.map(|value| (value / delta).asinh());
            let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
            let q = points.iter().map(|&[re, im]| {
                let [x, y] = asinh([re / delta, im / delta]);
                let (x, y) = ((x - middle) / half, y / half);
                (0.5 * ((x - 1.0).hypot(y) + (x + 1.0).hypot(y))).max(1.0).acosh()
            });
            let most = q.fold(MAX_Q, f64::min);
            let growth =
                |q: f64| f64::from(power) * largest_distance_from_1(delta, middle, half, q).max(1.0).ln();
            // Where q is 0, no number of points is enough.
            let points = |q: f64| 1 + ((decay + growth(q)).max(0.0) / q).ceil().min(1e9) as usize;
            let tried = (1..=ELLIPSES).map(|k| points(most * f64::from(k) / f64::from(ELLIPSES)));
            let n = if half > 0.0 { tried.min().unwrap_or(1) } else { 1 };
            Self { n, delta, middle, half }
        };
        (1..DELTAS)
            .map(candidate)
            .fold(candidate(0), |best, other| if other.n < best.n { other } else { best })
    }

    /// The angle whose cosine is the k-th Chebyshev point, in rising order.
    fn angle(&self, k: usize) -> f64 {
        PI * (self.n - k) as f64 / self.n as f64 - 0.5 * PI / self.n as f64
    }

    /// The value at the k-th Chebyshev point.
    fn source(&self, k: usize) -> f64 {
        self.delta * (self.middle + self.half * self.angle(k).cos()).sinh()
    }

    /// Fills in the weights of the points at a value, by the barycentric formula (Berrut & Trefethen 2004, eq. 4.2, 5.3).
    fn weigh(&self, value: f64, weights: &mut [f64]) {
        let x = ((value / self.delta).asinh() - self.middle) / self.half;
        let mut sum = 0.0;
        for k in 0..self.n {
            let angle = self.angle(k);
            let distance = x - angle.cos();
            // The value is a point, or there is only one point.
            if distance == 0.0 || distance.is_nan() {
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

/// The largest |1 − δ sinh z| on the ellipse of q about the range in z.
fn largest_distance_from_1(delta: f64, middle: f64, half: f64, q: f64) -> f64 {
    const ANGLES: i32 = 12;
    let distance = |k: i32| {
        let angle = PI * f64::from(k) / f64::from(ANGLES);
        let (x, y) = (middle + half * q.cosh() * angle.cos(), half * q.sinh() * angle.sin());
        (1.0 - delta * x.sinh() * y.cos()).hypot(delta * x.cosh() * y.sin())
    };
    (0..=ANGLES).map(distance).fold(0.0, f64::max)
}

/// Computes asinh of a complex number with Im ≥ 0, from its distances to the branch points ±i.
fn asinh([re, im]: [f64; 2]) -> [f64; 2] {
    let (near, far) = (re.hypot(im - 1.0), re.hypot(im + 1.0));
    [(0.5 * (near + far)).max(1.0).acosh(), (0.5 * (far - near)).clamp(-1.0, 1.0).asin()]
}

/// The positive values, sorted, without those within [`RATIO`] of the one before.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::half_angle::MU_MIN;
    use crate::integrate::slope_rule::SlopeRule;
    use crate::model::{ALPHA_MIN_INTEGRAL, Integral, MICROFACETS, Model, Slopes};

    /// The roughness and μ of tables, some of which the strength was not measured on.
    fn tables() -> Vec<(&'static str, Vec<f64>, Vec<f64>)> {
        let centers = |n: usize| (0..n).map(|k| (k as f64 + 0.5) / n as f64).collect::<Vec<_>>();
        let nodes = |n: usize, [a, b]: [f64; 2]| -> Vec<f64> {
            (0..n).map(|k| a + (b - a) * k as f64 / (n - 1) as f64).collect()
        };
        let squared = |values: Vec<f64>| values.into_iter().map(|u| u * u).collect::<Vec<_>>();
        let cosines = |n: usize| -> Vec<f64> {
            nodes(n, [0.0, 0.5 * PI]).into_iter().map(|theta| theta.cos().max(MU_MIN)).collect()
        };
        let narrow = nodes(48, [0.23, 0.84]);
        let listed: Vec<_> = (0..60).map(|k| 0.8f64.powi(k)).collect();
        vec![
            ("128 centres", centers(128), centers(128)),
            ("64 centres", centers(64), centers(64)),
            ("300 centres", centers(300), centers(300)),
            ("nodes from 0, 1e-3", nodes(64, [0.0, 1.0]), nodes(64, [1e-3, 1.0])),
            (
                "square root",
                squared(nodes(128, [0.0, 1.0])),
                squared(nodes(128, [0.0, 1.0])).iter().map(|mu| mu.max(MU_MIN)).collect(),
            ),
            ("a scene's", narrow.clone(), nodes(40, [0.1, 0.97])),
            ("rough", nodes(40, [0.8, 1.0]), centers(100)),
            (
                "smooth",
                nodes(200, [0.0, 0.05]),
                nodes(200, [0.0, 0.05]).iter().map(|mu| mu.max(MU_MIN)).collect(),
            ),
            ("angles", centers(90), cosines(91)),
            ("listed", listed.clone(), listed),
        ]
    }

    const RANDOM_TABLES: usize = 60;

    fn slopes(model: &Model) -> Option<&'static Slopes> {
        match model.integral {
            Integral::Slopes(slopes) => Some(slopes),
            _ => None,
        }
    }

    /// Integrates (A, B) row by row to 1e-10.
    fn exact(slopes: &'static Slopes, alphas: &[f64], mus: &[f64]) -> Vec<[f64; 2]> {
        let settings: Vec<_> = alphas.iter().map(|&alpha| alpha.into()).collect();
        let rule = SlopeRule::new(slopes, mus.to_vec(), &settings, 1e-10, 0);
        let map = slopes.map(rule.tolerance);
        let integral = |texel: usize| {
            let (row, column) = (texel / mus.len(), texel % mus.len());
            let (alpha, mu) = (alphas[row], mus[column]);
            if alpha < ALPHA_MIN_INTEGRAL {
                return (slopes.mirror_limit)(mu, &settings[row]);
            }
            let mut sum = [0.0; 2];
            for (azimuths, nodes) in rule.sides(row, column) {
                for &[c, t_max, inverse, weight] in azimuths {
                    let end = (map.end)(t_max, &settings[row]);
                    for node in nodes {
                        let [a, b] = (map.integrand)(end * node.x, [c, t_max, inverse], mu, &settings[row]);
                        let weight = weight * end * node.weight;
                        sum = [sum[0] + weight * a, sum[1] + weight * b];
                    }
                }
            }
            sum
        };
        (0..alphas.len() * mus.len()).into_par_iter().map(integral).collect()
    }

    /// The largest error of some texels of a table, and the number of sources of each axis.
    fn error(model: &Model, roughness: &[f64], mus: &[f64], tolerance: f64) -> Option<(f64, [usize; 2])> {
        let slopes = slopes(model)?;
        let branches = slopes.branches?;
        let alphas: Vec<_> = roughness.iter().map(|r| r * r).collect();
        let rows = InterpolatedAxis::along_roughness(&alphas, mus, branches, tolerance);
        let columns = InterpolatedAxis::along_mu(mus, &alphas, branches, tolerance);
        let counts = [&rows, &columns].map(|s| s.as_ref().map_or(0, |s| s.sources.len()));
        let rows = rows.or_else(|| InterpolatedAxis::identity(&alphas)).unwrap();
        let columns = columns.or_else(|| InterpolatedAxis::identity(mus)).unwrap();
        // Both ends and some between.
        let some = |n: usize| {
            (0..n).filter(|k| *k < 6 || k + 4 >= n || k % (n / 12).max(1) == 0).collect::<Vec<_>>()
        };
        let (picked_rows, picked_columns) = (some(alphas.len()), some(mus.len()));
        let pick = |matrix: &Matrix, picked: &[usize]| Matrix {
            rows: picked.len(),
            columns: matrix.columns,
            values: picked
                .iter()
                .flat_map(|&k| matrix.values[k * matrix.columns..][..matrix.columns].to_vec())
                .collect(),
        };
        let raw = exact(slopes, &rows.sources, &columns.sources);
        let interpolated =
            pick(&rows.matrix, &picked_rows).apply(&pick(&columns.matrix, &picked_columns).apply(&raw));
        let values_at =
            |values: &[f64], picked: &[usize]| picked.iter().map(|&k| values[k]).collect::<Vec<_>>();
        let exact = exact(slopes, &values_at(&alphas, &picked_rows), &values_at(mus, &picked_columns));
        let difference = |(a, b): (&[f64; 2], &[f64; 2])| (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
        Some((interpolated.iter().zip(&exact).map(difference).fold(0.0, f64::max), counts))
    }

    /// The error of interpolation alone stays below an eighth of the tolerance.
    #[test]
    fn interpolation_keeps_its_share() {
        for model in MICROFACETS.iter() {
            // The other terms have the same branch points: some tables will do.
            let every = if model.name == "ggx" { 1 } else { 4 };
            for (name, roughness, mus) in tables().into_iter().step_by(every) {
                for tolerance in [1e-2, 1e-4, 1e-6] {
                    let Some((error, counts)) = error(model, &roughness, &mus, tolerance) else { continue };
                    let model = model.name;
                    assert!(
                        error <= CHEBYSHEV_SHARE * tolerance,
                        "{model}, {name} {counts:?}: {error:.1e} to {tolerance:e}"
                    );
                }
            }
        }
    }

    /// Ranges that nobody chose keep their share too: narrow ones, and such as begin near 0.
    #[test]
    fn interpolation_keeps_its_share_over_any_range() {
        let ggx = MICROFACETS.iter().find(|model| model.name == "ggx").unwrap();
        let fraction = |k: usize, step: f64| (0.37 + step * k as f64).fract();
        let mut worst = Vec::new();
        for k in 0..RANDOM_TABLES {
            // Additive recurrences of irrationals; some ranges begin at 0, and some ends are near the least.
            let end = |u: f64| if u < 0.2 { 0.0 } else { 2f64.powf(10.0 * (u - 0.2) / 0.8 - 10.0) };
            let range = |u: f64, v: f64| {
                let (a, b) = (end(u), end(v));
                [a.min(b), a.max(b).max(a.min(b) + 0.01).min(1.0)]
            };
            let roughness = range(fraction(k, 0.754_877_666), fraction(k, 0.569_840_291));
            let mu = range(fraction(k, 0.381_966_011), fraction(k, 0.671_043_607));
            let nodes = |[a, b]: [f64; 2]| -> Vec<f64> {
                (0..128).map(|k| (a + (b - a) * f64::from(k) / 127.0).clamp(0.0, 1.0)).collect()
            };
            let mus: Vec<_> = nodes(mu).into_iter().map(|mu| mu.max(MU_MIN)).collect();
            for tolerance in [1e-4, 1e-5, 1e-6] {
                let Some((error, counts)) = error(ggx, &nodes(roughness), &mus, tolerance) else { continue };
                let share = error / (CHEBYSHEV_SHARE * tolerance);
                worst.push((share, format!("{roughness:?} × {mu:?} to {tolerance:e} by {counts:?}")));
            }
        }
        worst.sort_by(|a, b| b.0.total_cmp(&a.0));
        worst.iter().take(12).for_each(|(share, table)| println!("{share:.2} {table}"));
        assert!(worst[0].0 <= 1.0, "{:?}", worst[0]);
    }

    /// `cargo test --release -- --ignored print_the_error_of_interpolation --nocapture` prints the share of its
    /// budget that each table uses, from which the strength of the branch points was chosen.
    #[test]
    #[ignore = "takes minutes; prints"]
    fn print_the_error_of_interpolation() {
        for model in MICROFACETS.iter() {
            for (name, roughness, mus) in tables() {
                for decade in 1..=8 {
                    let tolerance = 10f64.powi(-decade);
                    let Some((error, [rows, columns])) = error(model, &roughness, &mus, tolerance) else {
                        continue;
                    };
                    let share = error / (CHEBYSHEV_SHARE * tolerance);
                    println!(
                        "{}, {name}: 1e-{decade} by {rows} × {columns}, {share:.2} of the share",
                        model.name
                    );
                }
            }
        }
    }
}
