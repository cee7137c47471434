//! The white furnace of a subject that has integrals of its own: ρ_dh over settings and θi at once, and then
//! ever closer around the largest.

use crate::bake::Observer;
use crate::base::error::Result;
use crate::verify::energy::{Incidence, NAME, finding};
use crate::verify::hemisphere::Rho;
use crate::verify::inputs::{settings, thetas};
use crate::verify::probe::Probe;
use crate::verify::report::Finding;
use crate::verify::sequence::Chance;
use crate::verify::{ParameterRange, Subject};
use std::f64::consts::FRAC_PI_2;

/// Settings of the scan.
const SETTINGS: usize = 64;
/// Steps of a sweep.
const SWEEP: u32 = 16;
/// Rounds of the search, each of so many settings and angles around the largest so far; the distance falls
/// by [`CLOSER`] a round, to 1e-4 of the range.
const ROUNDS: usize = 9;
const AROUND: usize = 8;
const ANGLES: usize = 16;
const CLOSER: f64 = 0.4;

/// The finding; none where the subject has no integrals.
pub(super) fn check(
    probe: &mut Probe,
    search: bool,
    tolerance: f64,
    observer: &dyn Observer,
) -> Result<Option<Finding>> {
    if !probe.has_integrals()? {
        return Ok(None);
    }
    observer.begin(NAME);
    let parameters = probe.subject.integral_parameters().to_vec();
    let channels = probe.channels();
    let mut scan = thetas();
    // Towards grazing by decades of cos θ.
    scan.extend((2..12).map(|k| FRAC_PI_2 - 10f64.powf(-0.5 * f64::from(k))));
    let [low, high] = probe.thetas();
    scan.retain(|theta| (low..=high).contains(theta));
    scan.extend([low, high]);
    let mut all = settings(&parameters, SETTINGS);
    all.extend(sweeps(&parameters));
    let mut places = places(probe.subject, &all, &scan, channels)?;
    observer.advance(0.5)?;
    let mut chance = Chance(0);
    let mut distance = 0.1;
    for _ in 0..if search { ROUNDS } else { 0 } {
        let Some(most) = largest(&places) else { break };
        let around = around(most, &parameters, distance, &mut chance);
        let from = most.theta_i / FRAC_PI_2;
        let angles = (0..=ANGLES).map(|k| {
            let step = 2.0 * k as f64 / ANGLES as f64 - 1.0;
            (FRAC_PI_2 * (from + distance * step).clamp(0.0, 1.0)).clamp(low, high)
        });
        let found = self::places(probe.subject, &around, &angles.collect::<Vec<_>>(), channels)?;
        places.extend(found);
        distance *= CLOSER;
        observer.advance(0.5 / ROUNDS as f64)?;
    }
    let least = places.iter().map(|place| place.rho.value).fold(f64::INFINITY, f64::min);
    Ok(Some(finding(probe, largest(&places), least, tolerance)))
}

/// Each parameter between its ends, the others at their upper ones: ρ_dh is linear in weights, so that a gain
/// between the ends of a shape shows with all weights at their most, and may show nowhere else.
pub(super) fn sweeps(parameters: &[ParameterRange]) -> impl Iterator<Item = Vec<f64>> {
    let free = (0..parameters.len()).filter(|&k| parameters[k].low < parameters[k].high);
    free.flat_map(move |k| {
        (1..SWEEP).map(move |j| {
            let mut setting: Vec<_> = parameters.iter().map(|parameter| parameter.high).collect();
            setting[k] = parameters[k].at(f64::from(j) / f64::from(SWEEP));
            setting
        })
    })
}

/// The largest channel at each setting and angle.
fn places(
    subject: &mut dyn Subject,
    settings: &[Vec<f64>],
    thetas: &[f64],
    channels: usize,
) -> Result<Vec<Incidence>> {
    let rho = subject.rho_dh(settings, thetas)?.unwrap_or_default();
    let inputs = settings.iter().flat_map(|setting| thetas.iter().map(move |&theta| (setting, theta)));
    Ok(inputs
        .zip(rho.chunks_exact(channels))
        .map(|((setting, theta_i), rho)| Incidence {
            // What the integral may be off by is in the tolerance.
            rho: Rho { value: rho.iter().copied().fold(f64::NEG_INFINITY, f64::max), estimate: 0.0 },
            setting: setting.clone(),
            theta_i,
            phi_i: 0.0,
        })
        .collect())
}

/// The first of the largest.
fn largest(places: &[Incidence]) -> Option<&Incidence> {
    places.iter().rev().max_by(|a, b| a.rho.value.total_cmp(&b.rho.value))
}

/// A place's setting, and others near it.
fn around(
    place: &Incidence,
    parameters: &[ParameterRange],
    distance: f64,
    chance: &mut Chance,
) -> Vec<Vec<f64>> {
    let mut settings = vec![place.setting.clone()];
    if parameters.iter().any(|parameter| parameter.low < parameter.high) {
        settings.extend((0..AROUND).map(|_| {
            let near = |(parameter, &value): (&ParameterRange, &f64)| {
                let u = parameter.place(value) + distance * (2.0 * chance.uniform() - 1.0);
                parameter.at(u.clamp(0.0, 1.0))
            };
            parameters.iter().zip(&place.setting).map(near).collect()
        }));
    }
    settings
}
