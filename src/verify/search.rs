//! The hunt for the input that breaks a promise worst: a scan, then a climb from the worst places found.

use crate::bake::Observer;
use crate::base::error::Result;
use crate::verify::inputs::Inputs;
use crate::verify::probe::Probe;
use crate::verify::sequence::Chance;
use crate::verify::{Angles, Extent, ParameterRange, Property};
use std::f64::consts::{FRAC_PI_2, PI};

/// An input and how far it is from a promise.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Worst {
    pub deviation: f64,
    pub setting: Vec<f64>,
    pub angles: Angles,
}

/// Places to climb from, apart from each other by [`APART`] of the range of an angle or a parameter.
const SEEDS: usize = 16;
const APART: f64 = 0.08;
/// A climb: so many rounds of so many tries; it ends early after so many rounds in vain.
const ROUNDS: usize = 40;
const TRIES: usize = 256;
const VAIN: usize = 8;
/// Steps of a climb are spread over all magnitudes between these shares of the range: a basin of any size
/// is descended, with no size to be tuned.
const LARGEST_STEP: f64 = 0.3;
const DECADES: f64 = 7.0;
/// Inputs of the scan in one go.
const BATCH: u64 = 1 << 14;
/// Inputs of the grid at every corner of many parameters, where there are up to so many; and at the ends of each two.
const FEW: usize = 64;
const CORNERS: usize = 256;
const MORE: usize = 512;
/// The candidates of a batch.
const CANDIDATES: usize = 4;

/// The worst inputs of a property, the worst first; none where no input says anything.
pub(super) fn hunt(
    property: &mut dyn Property,
    probe: &mut Probe,
    inputs: &Inputs,
    search: bool,
    extent: &mut Extent,
    observer: &dyn Observer,
) -> Result<Vec<Worst>> {
    let mut seeds = Seeds::default();
    let share = if search { 0.8 } else { 1.0 };
    let size = orbit_size(property);
    let each = inputs.budget / size / inputs.settings.len() as u64;
    let scattered = each.saturating_sub(inputs.grid.len() as u64);
    for (k, setting) in inputs.settings.iter().enumerate() {
        judge(property, probe, setting, inputs.grid.clone(), &mut seeds, extent)?;
        let (mut first, end) = (k as u64 * scattered, (k as u64 + 1) * scattered);
        while first < end {
            let count = BATCH.min(end - first);
            judge(property, probe, setting, inputs.scattered(first, count).collect(), &mut seeds, extent)?;
            first += count;
            observer.advance(0.0)?;
        }
        observer.advance(share / inputs.settings.len() as f64)?;
    }
    let count = |settings: &[Vec<f64>], most: usize| {
        let each = inputs.budget / 8 / size / settings.len().max(1) as u64;
        (each as usize).clamp(8, most)
    };
    let (few, more) = (count(&inputs.corners, FEW), count(&inputs.pairs_of_ends, MORE));
    // A dispatch for each of thousands of settings is for what is seen in one value.
    let is_single = size == 1;
    for setting in inputs.corners.iter().filter(|_| is_single || inputs.corners.len() <= CORNERS) {
        judge(property, probe, setting, inputs.few(few), &mut seeds, extent)?;
    }
    for setting in &inputs.pairs_of_ends {
        judge(property, probe, setting, inputs.few(more), &mut seeds, extent)?;
    }
    if search {
        let starts = seeds.0.clone();
        for (k, seed) in starts.iter().enumerate() {
            let found = climb(property, probe, seed, k as u64)?;
            seeds.0.push(found);
            observer.advance((1.0 - share) / starts.len() as f64)?;
        }
    }
    // Stable: the first of equals.
    seeds.0.sort_by(|a, b| b.deviation.total_cmp(&a.deviation));
    Ok(seeds.0)
}

/// Evaluates the orbits of some inputs at a setting and keeps the worst.
fn judge(
    property: &mut dyn Property,
    probe: &mut Probe,
    setting: &[f64],
    inputs: Vec<Angles>,
    seeds: &mut Seeds,
    extent: &mut Extent,
) -> Result<()> {
    let deviations = deviations(property, probe, setting, &inputs)?;
    extent.of += inputs.len() as u64;
    for (input, _) in inputs.iter().zip(&deviations).filter(|(_, deviation)| **deviation > property.limit()) {
        extent.add(probe.parameters(), setting, input);
    }
    let mut order: Vec<_> = (0..inputs.len()).filter(|&k| deviations[k] > f64::NEG_INFINITY).collect();
    // The first of equals: inputs on the grid are the easiest to read.
    order.sort_by(|&a, &b| deviations[b].total_cmp(&deviations[a]));
    let mut added = 0;
    for k in order {
        let worst = Worst { deviation: deviations[k], setting: setting.to_vec(), angles: inputs[k] };
        added += usize::from(seeds.add(worst, probe.parameters()));
        if added == CANDIDATES || seeds.is_full_of_worse(deviations[k]) {
            break;
        }
    }
    Ok(())
}

fn orbit_size(property: &dyn Property) -> u64 {
    let mut orbit = Vec::new();
    property.orbit(Angles { theta_i: 0.0, phi_i: 0.0, theta_e: 0.0, phi_e: 0.0 }, &mut orbit);
    orbit.len() as u64
}

fn deviations(
    property: &mut dyn Property,
    probe: &mut Probe,
    setting: &[f64],
    inputs: &[Angles],
) -> Result<Vec<f64>> {
    let mut orbits = Vec::new();
    inputs.iter().for_each(|&input| property.orbit(input, &mut orbits));
    let values = probe.evaluate(setting, &orbits)?;
    let size = orbits.len() / inputs.len().max(1);
    let (orbits, values) = (orbits.chunks_exact(size), values.chunks_exact(size * probe.channels()));
    Ok(orbits
        .zip(values)
        .map(|(orbit, values)| match probe.is_judged(&orbit[0]) {
            true => property.judge(&*probe.subject, setting, orbit, values),
            false => f64::NEG_INFINITY,
        })
        .collect())
}

/// The worst inputs so far, the worst first, none near another.
#[derive(Default)]
struct Seeds(Vec<Worst>);

impl Seeds {
    /// Takes an input if it is among the worst, in the place of lesser ones near it.
    fn add(&mut self, worst: Worst, parameters: &[ParameterRange]) -> bool {
        let place = Coordinates::of(&worst, parameters);
        let near = |other: &Worst| Coordinates::of(other, parameters).distance(&place) < APART;
        if self.0.iter().any(|other| other.deviation >= worst.deviation && near(other)) {
            return false;
        }
        self.0.retain(|other| !near(other));
        let at = self.0.partition_point(|other| other.deviation >= worst.deviation);
        self.0.insert(at, worst);
        self.0.truncate(SEEDS);
        at < SEEDS
    }

    fn is_full_of_worse(&self, deviation: f64) -> bool {
        self.0.len() == SEEDS && self.0[SEEDS - 1].deviation >= deviation
    }
}

/// Climbs from an input: tries around the worst so far, some of its coordinates moved at a time.
fn climb(property: &mut dyn Property, probe: &mut Probe, seed: &Worst, number: u64) -> Result<Worst> {
    let parameters = probe.parameters().to_vec();
    let free: Vec<_> = (0..parameters.len()).filter(|&k| parameters[k].low < parameters[k].high).collect();
    let mut chance = Chance(number);
    let mut worst = seed.clone();
    let mut vain = 0;
    for round in 0..ROUNDS {
        let place = Coordinates::of(&worst, &parameters);
        // A setting is shared by the tries of a round; every other round moves it.
        let mut moved = place.clone();
        if round % 2 == 1 && !free.is_empty() {
            for &k in &free {
                if free.len() == 1 || chance.bits() & 1 == 0 {
                    moved.setting[k] = (moved.setting[k] + step(&mut chance)).clamp(0.0, 1.0);
                }
            }
        }
        let setting = match moved.setting == place.setting {
            true => worst.setting.clone(),
            false => parameters.iter().zip(&moved.setting).map(|(p, &u)| p.at(u)).collect(),
        };
        let mut tries = vec![worst.angles];
        tries.extend((1..TRIES).map(|_| moved.near(&mut chance).angles()));
        let deviations = deviations(property, probe, &setting, &tries)?;
        vain += 1;
        for (&angles, deviation) in tries.iter().zip(deviations) {
            if deviation > worst.deviation {
                worst = Worst { deviation, setting: setting.clone(), angles };
                vain = 0;
            }
        }
        if vain == VAIN || worst.deviation == f64::INFINITY {
            break;
        }
    }
    Ok(worst)
}

/// A step of any magnitude, either way.
fn step(chance: &mut Chance) -> f64 {
    let size = LARGEST_STEP * 10f64.powf(-DECADES * chance.uniform());
    if chance.bits() & 1 == 0 { size } else { -size }
}

/// An input's coordinates, each of range 1 or so: θi, φi, θe, δφ and the parameters.
#[derive(Debug, Clone)]
struct Coordinates {
    angles: [f64; 4],
    setting: Vec<f64>,
}

impl Coordinates {
    fn of(worst: &Worst, parameters: &[ParameterRange]) -> Self {
        let Angles { theta_i, phi_i, theta_e, phi_e } = worst.angles;
        Self {
            angles: [theta_i / FRAC_PI_2, phi_i / PI, theta_e / FRAC_PI_2, wrap((phi_e - phi_i - PI) / PI)],
            setting: parameters.iter().zip(&worst.setting).map(|(p, &value)| p.place(value)).collect(),
        }
    }

    fn angles(&self) -> Angles {
        let [theta_i, phi_i, theta_e, delta] = self.angles;
        let theta = |u: f64| if u >= 1.0 { FRAC_PI_2 } else { FRAC_PI_2 * u };
        Angles {
            theta_i: theta(theta_i),
            phi_i: PI * phi_i,
            theta_e: theta(theta_e),
            phi_e: PI * (phi_i + 1.0 + delta),
        }
    }

    /// The largest difference of a coordinate.
    fn distance(&self, other: &Self) -> f64 {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| self.angles[k] - other.angles[k]);
        let angles = a.abs().max(0.5 * wrap(b).abs()).max(c.abs()).max(0.5 * wrap(d).abs());
        let setting = self.setting.iter().zip(&other.setting).map(|(a, b)| (a - b).abs());
        setting.fold(angles, f64::max)
    }

    /// Some of the angles moved; θi and θe also together, along the mirror directions.
    fn near(&self, chance: &mut Chance) -> Self {
        let mut place = self.clone();
        let which = chance.bits() % 16;
        if which == 0 {
            let both = step(chance);
            place.angles[0] += both;
            place.angles[2] += both;
        }
        for k in (0..4).filter(|k| which >> k & 1 == 1) {
            place.angles[k] += step(chance);
        }
        for k in [0, 2] {
            place.angles[k] = place.angles[k].clamp(0.0, 1.0);
        }
        for k in [1, 3] {
            place.angles[k] = wrap(place.angles[k]);
        }
        place
    }
}

/// Into (−1, 1], in half turns.
fn wrap(x: f64) -> f64 {
    x - 2.0 * ((x - 1.0) / 2.0).ceil()
}
