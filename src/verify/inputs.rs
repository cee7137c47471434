//! The inputs before the search: settings of the parameters; a grid of angles that holds the extremes; and
//! low-discrepancy angles that crowd where BRDFs break.

use crate::verify::sequence::Recurrence;
use crate::verify::{Angles, ParameterRange};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

pub(super) struct Inputs {
    pub settings: Vec<Vec<f64>>,
    /// The same at each setting.
    pub grid: Vec<Angles>,
    /// Values that may be looked at.
    pub budget: u64,
    recurrence: Recurrence,
}

/// Settings at most, however large the budget.
const SETTINGS: u64 = 256;

impl Inputs {
    pub fn new(parameters: &[ParameterRange], budget: u64) -> Self {
        let grid = grid();
        let most = (budget / (3 * grid.len() as u64)).clamp(4, SETTINGS);
        Self { settings: settings(parameters, most as usize), grid, budget, recurrence: Recurrence::new(4) }
    }

    /// `count` low-discrepancy inputs, from number `first` of the sequence.
    pub fn scattered(&self, first: u64, count: u64) -> impl Iterator<Item = Angles> {
        (first..first + count).map(|n| {
            let mut u = self.recurrence.point(n);
            let mut next = || u.next().unwrap_or(0.5);
            place(n, [next(), next(), next(), next()])
        })
    }
}

/// Both ends of each parameter with those of the others (with many parameters one at a time), and a
/// low-discrepancy set between, so many in all.
pub(super) fn settings(parameters: &[ParameterRange], most: usize) -> Vec<Vec<f64>> {
    let free: Vec<_> = (0..parameters.len()).filter(|&k| parameters[k].low < parameters[k].high).collect();
    let setting = |u: &dyn Fn(usize) -> f64| -> Vec<f64> {
        parameters.iter().enumerate().map(|(k, parameter)| parameter.at(u(k))).collect()
    };
    let place = |k: usize| free.iter().position(|&f| f == k);
    let mut settings = Vec::new();
    if free.is_empty() {
        return vec![setting(&|_| 0.0)];
    }
    if free.len() < 5 && 1 << free.len() < most {
        for corner in 0..1usize << free.len() {
            settings.push(setting(&|k| place(k).map_or(0.0, |bit| (corner >> bit & 1) as f64)));
        }
    } else {
        for &at in &free {
            for end in [0.0, 1.0] {
                settings.push(setting(&|k| if k == at { end } else { 0.5 }));
            }
        }
    }
    let recurrence = Recurrence::new(free.len());
    let mut n = 0;
    while settings.len() < most {
        let point: Vec<_> = recurrence.point(n).collect();
        settings.push(setting(&|k| place(k).map_or(0.0, |j| point[j])));
        n += 1;
    }
    settings
}

/// The extremes of θ, and nodes between.
pub(super) fn thetas() -> Vec<f64> {
    let mut thetas = vec![1e-7, 1e-3, FRAC_PI_2 - 1e-3, FRAC_PI_2 - 1e-6];
    thetas.extend((0..=12).map(|k| FRAC_PI_2 * f64::from(k) / 12.0));
    thetas.sort_by(f64::total_cmp);
    thetas
}

/// Extremes and nodes of θi, θe and δφ, each with each, at φi = 0 and at a φi of no symmetry: mirror pairs
/// and a hair beside them, back to the source, perpendicular, both grazing and opposite.
fn grid() -> Vec<Angles> {
    let mut deltas = vec![1e-7, -1e-7, 1e-4, -1e-4, 1e-2, PI - 1e-6];
    deltas.extend((-7..=8).map(|k| PI * f64::from(k) / 8.0));
    let mut grid = Vec::new();
    for theta_i in thetas() {
        for theta_e in thetas() {
            for &delta in &deltas {
                for phi_i in [0.0, 2.2] {
                    grid.push(Angles { theta_i, phi_i, theta_e, phi_e: phi_i + PI + delta });
                }
            }
        }
    }
    grid
}

/// Input n from a point of the unit cube: in turns anywhere, near the horizon, near the mirror direction, and
/// near the normal. Nearness is spread over all magnitudes down to 1e-7.
fn place(n: u64, [a, b, c, d]: [f64; 4]) -> Angles {
    let near = |u: f64| FRAC_PI_2 * 10f64.powf(-7.0 * u);
    let signed = |u: f64, size: f64| if u < 0.5 { -size * near(2.0 * u) } else { size * near(2.0 * u - 1.0) };
    let phi_i = TAU * c;
    let (theta_i, theta_e, delta) = match n % 4 {
        0 => (FRAC_PI_2 * a, FRAC_PI_2 * b, TAU * (d - 0.5)),
        1 if n % 8 == 1 => (FRAC_PI_2 - near(a), FRAC_PI_2 * b, TAU * (d - 0.5)),
        1 => (FRAC_PI_2 - near(a), FRAC_PI_2 - near(b), signed(d, 2.0)),
        2 => (FRAC_PI_2 * a, (FRAC_PI_2 * a + signed(b, 1.0)).clamp(0.0, FRAC_PI_2), signed(d, 2.0)),
        _ => (near(a), FRAC_PI_2 * b, TAU * (d - 0.5)),
    };
    Angles { theta_i, phi_i, theta_e, phi_e: phi_i + PI + delta }
}
