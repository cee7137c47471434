//! The white furnace: ρ_dh(ωi) = ∫ f cos θe dωe ≤ 1, by an integrator that knows nothing of f but where a
//! mirror would reflect.
//!
//! With (t, ψ) polar coordinates around the mirror direction m of ωi, ψ = 0 towards the horizon below it,
//!
//! ```text
//! ωe = m cos t + (u cos ψ + v sin ψ) sin t,   u = ∂m/∂θ,   v = n × u,   dωe = sin t dt dψ
//! cos θe = cos θi cos t − sin θi cos ψ sin t ≥ 0   ⇔   t ≤ t_max(ψ) = atan2(cos θi, sin θi cos ψ)
//! t = w sinh x,   x in [0, asinh(t_max/w)]:   Gauss–Legendre in x sees all magnitudes from w to t_max
//! ```
//!
//! For small cos θi the horizon jumps from t_max ≈ 0 to π at ψ = ±π/2, over a width of cos θi, so ψ is
//! mapped by a sinh around these two as well: four panels ψ = ±(π/2 ± d sinh y), d = max(cos θi, 1e-3).

use crate::bake::Observer;
use crate::base::error::Result;
use crate::base::quadrature::{Node, gauss_legendre};
use crate::verify::inputs::{settings, thetas};
use crate::verify::probe::{Probe, is_non_finite};
use crate::verify::report::Finding;
use crate::verify::search::Worst;
use crate::verify::sequence::Chance;
use crate::verify::{Angles, VerifyOptions};
use std::f64::consts::{FRAC_PI_2, PI};

pub(super) const NAME: &str = "energy";

/// The width w that nodes crowd to: lobes of width 1e-3 are seen by a third of them.
const WIDTH: f64 = 3e-4;
/// The least width of the panels' ends, as in the warped rule's azimuths.
const JUMP: f64 = 1e-3;

/// Two resolutions: nodes in x, and in each panel of ψ. Their difference is the estimate of the error.
const COARSE: [usize; 2] = [32, 12];
const FINE: [usize; 2] = [48, 16];

/// Climbs, rounds and tries of the search.
const SEEDS: usize = 4;
const ROUNDS: usize = 12;
const TRIES: usize = 4;

/// ρ_dh of one incidence, the largest over channels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rho {
    pub value: f64,
    /// How much two resolutions differ.
    pub estimate: f64,
}

impl Rho {
    /// What is more than one, for certain.
    fn certain(&self) -> f64 {
        self.value - self.estimate
    }
}

pub(super) struct Incidence {
    pub rho: Rho,
    pub setting: Vec<f64>,
    pub theta_i: f64,
    pub phi_i: f64,
}

pub(super) fn check(
    probe: &mut Probe,
    options: &VerifyOptions,
    tolerance: f64,
    observer: &dyn Observer,
) -> Result<Finding> {
    observer.begin(NAME);
    let rules = Rules::new();
    let phis: &[f64] =
        if probe.subject.symmetry().isotropic { &[0.0] } else { &[0.0, 0.5, FRAC_PI_2, 2.2, PI, 5.1] };
    let incidences: Vec<_> = thetas().into_iter().flat_map(|t| phis.iter().map(move |&p| (t, p))).collect();
    let cost = (rules.nodes() * incidences.len()) as u64;
    let settings = settings(probe.parameters(), (options.budget / 2 / cost).max(4) as usize);
    let mut places = Vec::new();
    for setting in &settings {
        for &(theta_i, phi_i) in &incidences {
            let rho = rules.rho(probe, setting, theta_i, phi_i)?;
            places.push(Incidence { rho, setting: setting.clone(), theta_i, phi_i });
        }
        observer.advance(0.8 / settings.len() as f64)?;
    }
    places.sort_by(|a, b| b.rho.certain().total_cmp(&a.rho.certain()));
    let least = places.iter().map(|place| place.rho.value).fold(f64::INFINITY, f64::min);
    if options.search {
        for k in 0..SEEDS.min(places.len()) {
            let found = climb(&rules, probe, &places[k], k as u64)?;
            places.push(found);
            observer.advance(0.2 / SEEDS as f64)?;
        }
    }
    // The first of equals.
    let largest = places.iter().rev().max_by(|a, b| a.rho.certain().total_cmp(&b.rho.certain()));
    Ok(finding(probe, largest, least, tolerance))
}

/// Climbs on ρ over the incidence and the parameters.
fn climb(rules: &Rules, probe: &mut Probe, from: &Incidence, number: u64) -> Result<Incidence> {
    let parameters = probe.parameters().to_vec();
    let mut chance = Chance(number);
    let mut worst = Incidence { rho: from.rho, setting: from.setting.clone(), ..*from };
    let mut radius = 0.1;
    for _ in 0..ROUNDS {
        let mut vain = true;
        for _ in 0..TRIES {
            let mut move_by = |size: f64| size * radius * (2.0 * chance.uniform() - 1.0);
            let theta_i = (worst.theta_i + move_by(FRAC_PI_2)).clamp(0.0, FRAC_PI_2);
            let phi_i = worst.phi_i + move_by(PI);
            let setting: Vec<_> = parameters
                .iter()
                .zip(&worst.setting)
                .map(|(p, &value)| p.at((p.place(value) + move_by(1.0)).clamp(0.0, 1.0)))
                .collect();
            let rho = rules.rho(probe, &setting, theta_i, phi_i)?;
            if rho.certain() > worst.rho.certain() {
                worst = Incidence { rho, setting, theta_i, phi_i };
                vain = false;
            }
        }
        radius *= if vain { 0.5 } else { 1.5 };
    }
    Ok(worst)
}

pub(super) fn finding(probe: &Probe, most: Option<&Incidence>, least: f64, tolerance: f64) -> Finding {
    let Some(place) = most else { return Finding::unseen(NAME, probe) };
    let Rho { value, estimate } = place.rho;
    let worst = Worst {
        deviation: place.rho.certain(),
        setting: place.setting.clone(),
        // The mirror direction stands for all of the hemisphere.
        angles: Angles {
            theta_i: place.theta_i,
            phi_i: place.phi_i,
            theta_e: place.theta_i,
            phi_e: place.phi_i + PI,
        },
    };
    let doubt = if estimate > 0.0 { format!(" ± {estimate:.0e}") } else { String::new() };
    let said = format!(
        "ρ_dh from {least:.6} to {value:.6}{doubt}: {}",
        match value - 1.0 {
            gain if gain > estimate + tolerance => format!("{:.3} % gained", 100.0 * gain),
            _ => format!("up to {:.3} % lost", 100.0 * (1.0 - least).max(0.0)),
        }
    );
    Finding::of(NAME, 1.0 + tolerance, said, Some(worst), probe)
}

/// The nodes of both resolutions.
struct Rules([[Vec<Node>; 2]; 2]);

impl Rules {
    fn new() -> Self {
        Self([COARSE, FINE].map(|counts| counts.map(gauss_legendre)))
    }

    /// Pairs of directions that one ρ takes.
    fn nodes(&self) -> usize {
        self.0.iter().map(|[x, y]| 4 * x.len() * y.len()).sum()
    }

    fn rho(&self, probe: &mut Probe, setting: &[f64], theta_i: f64, phi_i: f64) -> Result<Rho> {
        let [(coarse, mut angles), (fine, more)] =
            [0, 1].map(|k| self.0[k].each_ref()).map(|rule| hemisphere(rule, theta_i, phi_i));
        angles.extend(more);
        let channels = probe.channels();
        let values = probe.evaluate(setting, &angles)?;
        let (first, second) = values.split_at(coarse.len() * channels);
        let sum = |weights: &[f64], values: &[f32], channel: usize| -> f64 {
            let values = values.iter().skip(channel).step_by(channels);
            // What is not finite is reported as such, and must not hide the rest.
            weights
                .iter()
                .zip(values)
                .map(|(w, &v)| if is_non_finite(v) { 0.0 } else { w * f64::from(v) })
                .sum()
        };
        let rhos = (0..channels).map(|channel| {
            let (coarse, fine) = (sum(&coarse, first, channel), sum(&fine, second, channel));
            Rho { value: fine, estimate: (fine - coarse).abs() }
        });
        let largest = rhos.max_by(|a, b| a.certain().total_cmp(&b.certain()));
        Ok(largest.unwrap_or(Rho { value: 0.0, estimate: 0.0 }))
    }
}

/// Weights, with cos θe in them, and the pairs of directions.
fn hemisphere([xs, ys]: [&Vec<Node>; 2], theta_i: f64, phi_i: f64) -> (Vec<f64>, Vec<Angles>) {
    let (sin, cos) = (theta_i.sin(), theta_i.cos().max(0.0));
    let d = cos.max(JUMP);
    let panel = (FRAC_PI_2 / d).asinh();
    let (mut weights, mut angles) = (Vec::new(), Vec::new());
    for (side, towards) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
        for y in ys {
            let psi = side * (FRAC_PI_2 + towards * d * (panel * y.x).sinh());
            let dpsi = y.weight * panel * d * (panel * y.x).cosh();
            let (sin_psi, cos_psi) = psi.sin_cos();
            let end = (cos.atan2(sin * cos_psi) / WIDTH).asinh();
            for x in xs {
                let t = WIDTH * (end * x.x).sinh();
                let dt = x.weight * end * WIDTH * (end * x.x).cosh();
                let (sin_t, cos_t) = t.sin_cos();
                let mu = (cos * cos_t - sin * cos_psi * sin_t).max(0.0);
                // In the frame whose x axis is the azimuth of m: m = (sin, 0, cos), u = (cos, 0, −sin).
                let along = sin * cos_t + cos * cos_psi * sin_t;
                let across = sin_psi * sin_t;
                weights.push(mu * sin_t * dt * dpsi);
                angles.push(Angles {
                    theta_i,
                    phi_i,
                    theta_e: along.hypot(across).atan2(mu).min(FRAC_PI_2),
                    phi_e: phi_i + PI + across.atan2(along),
                });
            }
        }
    }
    (weights, angles)
}
