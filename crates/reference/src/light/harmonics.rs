//! Spherical harmonics of a light by their definition: ∫ L Y dω, Y of associated Legendre polynomials.

use crate::light::source::{GAUSS, Source, unit_vector};
use crate::light::{Cell, Light};
use std::f64::consts::{PI, SQRT_2};

/// R, G and B of nine coefficients, in the order l(l+1) + m.
pub type Harmonics = [[f64; 3]; 9];

/// Three nodes of Gauss–Legendre miss sin 3θ by 1e-9 of a part of a cell that is no wider, rad.
const WIDEST: f64 = 0.1;

/// Lₖ = ∫ L Yₖ dω of a light, cell by cell; of one from a single direction E Yₖ there.
pub fn harmonics(light: &Light) -> Harmonics {
    if let Light::Directional { direction: [x, y, z], irradiance } = *light {
        return basis(x.hypot(y).atan2(z), y.atan2(x)).map(|y| irradiance.map(|e| e * y));
    }
    let Some(source) = Source::new(light) else { return [[f64::NAN; 3]; 9] };
    let mut sum = [[0.0; 3]; 9];
    for cell in source.cells() {
        let parts = |[a, b]: [f64; 2]| ((b - a) / WIDEST).ceil().max(1.0) as usize;
        let [down, across] = [parts(cell.theta), parts(cell.phi)];
        for k in 0..down * across {
            let part = Cell {
                theta: piece(cell.theta, k / across, down),
                phi: piece(cell.phi, k % across, across),
                ..cell
            };
            add(&source, &part, &mut sum);
        }
    }
    sum
}

fn piece([a, b]: [f64; 2], k: usize, of: usize) -> [f64; 2] {
    [k, k + 1].map(|k| a + (b - a) * k as f64 / of as f64)
}

fn add(source: &Source, cell: &Cell, sum: &mut Harmonics) {
    let middle = |[a, b]: [f64; 2]| (0.5 * (a + b), 0.5 * (b - a));
    let ((t, dt), (p, dp)) = (middle(cell.theta), middle(cell.phi));
    for (x, wx) in GAUSS {
        let theta = t + dt * x;
        let light = source.radiance(cell, theta);
        for (y, wy) in GAUSS {
            let world = source.to_world(unit_vector(theta, p + dp * y));
            let weight = wx * wy * dt * dp * theta.sin();
            let basis = basis(world.x.hypot(world.y).atan2(world.z), world.y.atan2(world.x));
            for (sum, y) in sum.iter_mut().zip(basis) {
                (0..3).for_each(|c| sum[c] += weight * y * light[c]);
            }
        }
    }
}

/// The real basis (Green 2003, "Spherical harmonic lighting", eq. 6; without the phase (−1)ᵐ): K Pₗᵐ(cos θ) times 1, √2 cos mφ, or
/// √2 sin |m|φ of negative m.
fn basis(theta: f64, phi: f64) -> [f64; 9] {
    let (s, c) = theta.sin_cos();
    // P of (l, |m|), and (l − |m|)!/(l + |m|)!.
    let legendre = |l: i32, m: i32| match (l, m) {
        (0, _) => (1.0, 1.0),
        (1, 0) => (c, 1.0),
        (1, _) => (s, 0.5),
        (_, 0) => (0.5 * (3.0 * c * c - 1.0), 1.0),
        (_, 1) => (3.0 * s * c, 1.0 / 6.0),
        _ => (3.0 * s * s, 1.0 / 24.0),
    };
    let y = |l: i32, m: i32| {
        let (p, ratio) = legendre(l, m.abs());
        let k = (f64::from(2 * l + 1) / (4.0 * PI) * ratio).sqrt();
        let around = match m {
            0 => 1.0,
            1.. => SQRT_2 * (f64::from(m) * phi).cos(),
            _ => SQRT_2 * (f64::from(-m) * phi).sin(),
        };
        k * p * around
    };
    [(0, 0), (1, -1), (1, 0), (1, 1), (2, -2), (2, -1), (2, 0), (2, 1), (2, 2)].map(|(l, m)| y(l, m))
}
