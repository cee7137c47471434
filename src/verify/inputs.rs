//! The inputs before the search: settings of the parameters; a grid of angles that holds the extremes; and
//! low-discrepancy angles that crowd where BRDFs break.

use crate::verify::sequence::Recurrence;
use crate::verify::{Angles, ParameterRange};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

pub(super) struct Inputs {
    pub settings: Vec<Vec<f64>>,
    /// The same at each setting.
    pub grid: Vec<Angles>,
    /// With many parameters: every corner, to be looked at on a few inputs.
    pub corners: Vec<Vec<f64>>,
    /// With many parameters: the ends of each two, the others halfway, on more.
    pub pairs_of_ends: Vec<Vec<f64>>,
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
        let (corners, pairs_of_ends) = ends(parameters);
        Self {
            settings: settings(parameters, most as usize),
            grid,
            corners,
            pairs_of_ends,
            budget,
            recurrence: Recurrence::new(4),
        }
    }

    /// So many inputs of the grid, spread over all of it.
    pub fn few(&self, count: usize) -> Vec<Angles> {
        // A step with no factor of the grid's own periods.
        (0..count).map(|k| self.grid[(k * 7919 + 17) % self.grid.len()]).collect()
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

/// Parameters from which on corners are too many for the whole grid, and those up to which all are looked at.
const MANY: usize = 5;
const MOST: usize = 12;

/// All corners, and the ends of each two parameters; none where the settings have them.
fn ends(parameters: &[ParameterRange]) -> (Vec<Vec<f64>>, Vec<Vec<f64>>) {
    let free: Vec<_> = (0..parameters.len()).filter(|&k| parameters[k].low < parameters[k].high).collect();
    if free.len() < MANY {
        return (Vec::new(), Vec::new());
    }
    let setting = |ends: &[(usize, f64)]| -> Vec<f64> {
        let place = |k: usize| ends.iter().find(|end| end.0 == k).map_or(0.5, |end| end.1);
        parameters.iter().enumerate().map(|(k, parameter)| parameter.at(place(k))).collect()
    };
    let corners = (0..1usize << free.len().min(MOST)).map(|corner| {
        let end = |(bit, &k): (usize, &usize)| (k, (corner >> bit & 1) as f64);
        setting(&free.iter().take(MOST).enumerate().map(end).collect::<Vec<_>>())
    });
    let mut pairs = Vec::new();
    for (n, &a) in free.iter().enumerate() {
        for &b in &free[..n] {
            for corner in 0..4 {
                pairs.push(setting(&[(a, f64::from(corner & 1)), (b, f64::from(corner >> 1))]));
            }
        }
    }
    (corners.collect(), pairs)
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
    if free.len() < MANY && 1 << free.len() < most {
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

/// An angle that stands for a cosine of 0 to the bit, also where both directions have it.
pub(super) const HORIZON: f64 = FRAC_PI_2 + f64::EPSILON;

/// Cosines at which relations between the directions hold to the bit.
const RELATIONS: u32 = 512;

/// Extremes and nodes of θi, θe and δφ, each with each, at φi = 0 and at a φi of no symmetry: mirror pairs
/// and a hair beside them, back to the source, perpendicular, both grazing and opposite. And at many θ, what holds to
/// the bit: the mirror direction, equal directions, equal z.
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
    for k in 0..RELATIONS {
        let theta = ((f64::from(k) + 0.5) / f64::from(RELATIONS)).acos();
        for (phi_i, phi_e) in [(0.0, PI), (PI, 0.0), (2.2, 2.2 + PI), (0.0, 0.0), (2.2, 2.2), (0.3, 1.7)] {
            grid.push(Angles { theta_i: theta, phi_i, theta_e: theta, phi_e });
        }
    }
    grid
}

/// Both directions on the horizon to the bit: opposite ones; and equal, perpendicular and others.
pub(super) fn horizon() -> (Vec<Angles>, Vec<Angles>) {
    let at = |(phi_i, phi_e)| Angles { theta_i: HORIZON, phi_i, theta_e: HORIZON, phi_e };
    let opposite = [(0.0, PI), (PI, 0.0), (2.2, 2.2 + PI), (0.7, 0.7 + PI)];
    let others = [(0.0, 0.0), (2.2, 2.2), (0.0, FRAC_PI_2), (0.3, 1.7), (0.3, 3.1)];
    (opposite.map(at).to_vec(), others.map(at).to_vec())
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
