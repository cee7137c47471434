//! Spherical harmonics of a light: nine coefficients, of L or of E.
//!
//! The real basis in Cartesian form, in the order l(l+1) + m (Ramamoorthi & Hanrahan 2001, "An efficient representation for
//! irradiance environment maps", eq. 3):
//!
//! ```text
//! Y = 0.282095;  0.488603 (y, z, x);  1.092548 (xy, yz), 0.315392 (3z² − 1), 1.092548 xz, 0.546274 (x² − y²)
//! ```
//!
//! L = Σ Lₖ Yₖ, Lₖ = ∫ L Yₖ dω. E(n) = Σ Âₗ Lₖ Yₖ(n) with Â = π, 2π/3, π/4 (eqs. 5, 8): the *convolved* coefficients are
//! Âₗ Lₖ. What is left out are the bands from l = 4 on (that of l = 3 is 0): of a light of one direction and E = 1 the
//! clamped cosine less its three bands, which is at most 3/32 where cos θ = 0 and there alone, so that
//!
//! ```text
//! |Σ Âₗ Lₖ Yₖ(n) − E(n)| ≤ 3/32 ∫ L dω
//! ```
//!
//! for any light, as it is a sum of such.

use crate::bake::Evaluator;
use crate::base::error::Result;
use crate::light::{Environment, Light, Sky};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Coefficients of R, G and B, in the order l(l+1) + m.
pub type Coefficients = [[f64; 3]; 9];

/// What the error of three bands is at most, of ∫ L dω: |max(0, x) − (¼ + x/2 + (5/32)(3x² − 1))| at x = 0.
pub const TRUNCATION: f64 = 3.0 / 32.0;

/// Y of a unit vector, all nine.
pub fn basis([x, y, z]: [f64; 3]) -> [f64; 9] {
    let [y0, y1, y2, y20, y22] = normalisation();
    [
        y0,
        y1 * y,
        y1 * z,
        y1 * x,
        y2 * x * y,
        y2 * y * z,
        y20 * (3.0 * z * z - 1.0),
        y2 * x * z,
        y22 * (x * x - y * y),
    ]
}

/// ½ √(1/π), ½ √(3/π), ½ √(15/π), ¼ √(5/π), ¼ √(15/π).
fn normalisation() -> [f64; 5] {
    let root = |n: f64| (n / PI).sqrt();
    [0.5 * root(1.0), 0.5 * root(3.0), 0.5 * root(15.0), 0.25 * root(5.0), 0.25 * root(15.0)]
}

/// Âₗ for each of the nine.
pub fn cosine() -> [f64; 9] {
    let [a, b, c] = [PI, 2.0 * PI / 3.0, 0.25 * PI];
    [a, b, b, b, c, c, c, c, c]
}

/// Convolves coefficients of L with the clamped cosine, which gives those of E.
pub fn convolved(coefficients: &Coefficients) -> Coefficients {
    let cosine = cosine();
    std::array::from_fn(|k| coefficients[k].map(|x| x * cosine[k]))
}

/// Sums coefficients times the basis: L from a direction, or E of a normal if they are convolved.
pub fn evaluate(coefficients: &Coefficients, direction: [f64; 3]) -> [f64; 3] {
    let basis = basis(direction);
    std::array::from_fn(|c| (0..9).map(|k| coefficients[k][c] * basis[k]).sum())
}

/// Computes the coefficients of a light's radiance on the CPU.
pub fn coefficients(light: &Light) -> Coefficients {
    match light {
        Light::Constant(radiance) => sky_coefficients(&Sky::uniform(*radiance)),
        Light::Directional(sun) => {
            let basis = basis(sun.direction());
            basis.map(|y| sun.irradiance().map(|e| e * y))
        }
        Light::Disk(disk) => {
            // Funk & Hecke: of a function about c, Lₖ = 2π Yₖ(c) ∫₀^σ L Pₗ(cos t) sin t dt, which is in closed form.
            let (sin, cos) = disk.radius().sin_cos();
            let one_minus_cos = 2.0 * (0.5 * disk.radius()).sin().powi(2);
            let bands = [one_minus_cos, 0.5 * sin * sin, 0.5 * cos * sin * sin];
            let basis = basis(disk.direction());
            std::array::from_fn(|k| {
                let band = bands[[0, 1, 1, 1, 2, 2, 2, 2, 2][k]];
                disk.radiance().map(|l| l * 2.0 * PI * band * basis[k])
            })
        }
        Light::Sky(sky) => sky_coefficients(sky),
        Light::Map(map) => MapFactors::new(map).sum(),
    }
}

/// Integrates a gradient. It depends on z alone, so only m = 0 remains: ∫ over z ∈ [0, 1] of a + (b − a) z, and of the
/// ground below.
fn sky_coefficients(sky: &Sky) -> Coefficients {
    let [y0, y1, _, y20, _] = normalisation();
    let mut coefficients = [[0.0; 3]; 9];
    (0..3).for_each(|c| {
        let (a, b, g) = (sky.horizon()[c], sky.zenith()[c] - sky.horizon()[c], sky.ground()[c]);
        coefficients[0][c] = 2.0 * PI * y0 * (a + 0.5 * b + g);
        coefficients[2][c] = 2.0 * PI * y1 * (0.5 * a + b / 3.0 - 0.5 * g);
        coefficients[6][c] = 2.0 * PI * y20 * 0.25 * b;
    });
    coefficients
}

/// Over each cell the basis is in closed form: products of powers of sin θ and cos θ, and of 1, cos and sin of φ and 2φ. A
/// coefficient is the sum over rows of a factor times one of five sums over columns.
///
/// The twin of `shaders/light/harmonics.wgsl`, in f64, and all that the shader is given.
pub(crate) struct MapFactors<'a> {
    pub map: &'a Environment,
    /// For each row that of each coefficient.
    pub rows: Vec<[f64; 9]>,
    /// For each column ∫ cos φ, sin φ, cos 2φ, sin 2φ.
    pub columns: Vec<[f64; 4]>,
    /// Δφ.
    pub step: f64,
}

impl<'a> MapFactors<'a> {
    pub fn new(map: &'a Environment) -> Self {
        let column = |column: usize| {
            let [a, b] = map.cell(0, column).phi;
            let of = |f: fn(f64) -> f64, n: f64| (f(n * b) - f(n * a)) / n;
            [of(f64::sin, 1.0), -of(f64::cos, 1.0), of(f64::sin, 2.0), -of(f64::cos, 2.0)]
        };
        let [y0, y1, y2, y20, y22] = normalisation();
        let row = |row: usize| {
            let [t0, t1] = [map.theta(row), map.theta(row + 1)];
            let cubes = |f: fn(f64) -> f64| (f(t1).powi(3) - f(t0).powi(3)) / 3.0;
            let solid = t0.cos() - t1.cos();
            let along = 0.5 * (t1.sin().powi(2) - t0.sin().powi(2));
            // ∫ of sin θ times: cos² θ, sin θ, sin θ cos θ, sin² θ.
            let cos2 = -cubes(f64::cos);
            let across = crate::base::radiometry::sin2([t0, t1]);
            let mixed = cubes(f64::sin);
            let sin2 = solid - cos2;
            [
                y0 * solid,
                y1 * across,
                y1 * along,
                y1 * across,
                0.5 * y2 * sin2,
                y2 * mixed,
                y20 * (3.0 * cos2 - solid),
                y2 * mixed,
                y22 * sin2,
            ]
        };
        Self {
            map,
            rows: (0..map.height()).map(row).collect(),
            columns: (0..map.width()).map(column).collect(),
            step: 2.0 * PI / map.width() as f64,
        }
    }

    /// The coefficients.
    pub fn sum(&self) -> Coefficients {
        /// The sum over columns that each coefficient takes: of 1, cos φ, sin φ, cos 2φ, sin 2φ.
        const OF: [usize; 9] = [0, 2, 0, 1, 4, 2, 0, 1, 3];
        let row = |row: usize| -> Coefficients {
            let mut sums = [[0.0; 3]; 5];
            for (column, &[cos, sin, cos2, sin2]) in self.columns.iter().enumerate() {
                let texel = self.map.texel(row, column).map(f64::from);
                for (sum, weight) in sums.iter_mut().zip([self.step, cos, sin, cos2, sin2]) {
                    (0..3).for_each(|c| sum[c] += weight * texel[c]);
                }
            }
            std::array::from_fn(|k| sums[OF[k]].map(|sum| self.rows[row][k] * sum))
        };
        let rows: Vec<_> = (0..self.map.height()).into_par_iter().map(row).collect();
        rows.iter().fold([[0.0; 3]; 9], |sum, row| {
            std::array::from_fn(|k| std::array::from_fn(|c| sum[k][c] + row[k][c]))
        })
    }

    /// By whichever evaluator.
    pub fn of(&self, evaluator: &Evaluator) -> Result<Coefficients> {
        match evaluator {
            Evaluator::Device(device) => device.harmonics(self),
            Evaluator::Cpu => Ok(self.sum()),
        }
    }
}
