//! The white furnace: ρ_dh(ωi) = ∫ f cos θe dωe ≤ 1, hunted over ωi and the parameters.
//!
//! Each ρ has an error bar ([`hemisphere`](super::hemisphere)), and what is hunted is not the largest value but the
//! largest that is certain, value − bar:
//!
//! 1. a scan of incidences and settings, with wide bars; then a scan of cos θi in steps of 1/128 at the settings that may
//!    reach most, and a few incidences with small cells everywhere, and with the largest values of f as seeds;
//! 2. those that may reach most, value + bar, with narrower bars;
//! 3. a climb from the largest;
//! 4. a confirmation: charts of other widths, whose nodes are others, at directions that round otherwise. Their spread is
//!    part of the bar. No gain is reported without it.

use crate::bake::Observer;
use crate::base::error::Result;
use crate::verify::hemisphere::{Integral, Layout, Rho, refine};
use crate::verify::inputs::{settings, thetas};
use crate::verify::probe::Probe;
use crate::verify::report::{Finding, Verdict};
use crate::verify::search::Worst;
use crate::verify::sequence::Chance;
use crate::verify::{Angles, Extent, ParameterRange, Symmetry, VerifyOptions};
use std::f64::consts::{FRAC_PI_2, PI};

pub(super) const NAME: &str = "energy";

/// The share of the budget that the hunt takes, roughly.
const SHARE: u64 = 4;
/// Bars of the scan, of what may reach most, and of a confirmation; and the pairs that each ρ may take for it.
const SCAN: Effort = Effort { tolerance: 2e-3, most: 6_000 };
const CLOSE: Effort = Effort { tolerance: 5e-5, most: 40_000 };
const CLIMB: Effort = Effort { tolerance: 1e-4, most: 12_000 };
const CONFIRM: Effort = Effort { tolerance: 1e-8, most: 60_000 };
/// Pairs that a ρ of the scan takes, about.
const USUAL: u64 = 3_000;
/// Settings with a fine scan of cos θi, and its steps.
const FINE_SETTINGS: usize = 4;
const FINE: u32 = 128;
/// Incidences with small cells everywhere, and how small, rad.
const DENSE: u32 = 10;
const SMALL: f64 = 0.3;
/// The size of the cells around the largest values of f, rad.
const SEED_SIZE: f64 = 1e-3;
/// Those that are looked at closely, climbed from, and confirmed.
const CLOSELY: usize = 24;
const CLIMBS: usize = 3;
const CONFIRMED: usize = 4;
/// Rounds of a climb, and tries of a round.
const ROUNDS: usize = 12;
const TRIES: usize = 8;
/// The charts that confirm: a factor of their widths; a turn about the normal, enough to round anew, and where isotropy is
/// promised anywhere; and a step of cos θi in units of [`ROUNDING`].
const CHARTS: [(f64, f64, f64, f64); 3] =
    [(0.37, 1.3e-4, 0.7, 1.1), (1.9, -2.9e-4, 2.9, -1.7), (0.83, 4.7e-4, 4.3, 2.9)];
/// 2⁻²³, two spacings of a cosine in f32; and the step of θi at most, rad and of cos θi.
const ROUNDING: f64 = 1.2e-7;
const STEP: f64 = 2e-4;
/// A gain that is not excluded is looked into and spoken of from here on.
const CLEAR: f64 = 1e-3;

#[derive(Clone, Copy)]
struct Effort {
    tolerance: f64,
    most: usize,
}

/// An incidence, a setting, and ρ there.
pub(super) struct Incidence {
    pub rho: Rho,
    pub setting: Vec<f64>,
    pub theta_i: f64,
    pub phi_i: f64,
}

/// An integral that may be refined further.
#[derive(Clone)]
struct Place {
    integral: Integral,
    setting: Vec<f64>,
    /// Whether it was refined beyond the scan.
    is_close: bool,
}

impl Place {
    fn new(integral: Integral, setting: &[f64]) -> Self {
        Self { integral, setting: setting.to_vec(), is_close: false }
    }

    fn certain(&self) -> f64 {
        self.integral.rho().certain()
    }

    fn possible(&self) -> f64 {
        self.integral.rho().possible()
    }

    fn incidence(&self, rho: Rho) -> Incidence {
        let Integral { theta_i, phi_i, .. } = self.integral;
        Incidence { rho, setting: self.setting.clone(), theta_i, phi_i }
    }
}

/// Hunts for the largest ρ. `symmetry` is what f was found to have, `peaks` are the largest values of f.
pub(super) fn check(
    probe: &mut Probe,
    options: &VerifyOptions,
    symmetry: Symmetry,
    peaks: &[Worst],
    tolerance: f64,
    observer: &dyn Observer,
) -> Result<Finding> {
    observer.begin(NAME);
    let layout = Layout { largest: PI, stretch: 1.0, bilateral: symmetry.bilateral };
    let dense = Layout { largest: SMALL, ..layout };
    let phis = |k: usize| match symmetry.isotropic {
        true => vec![0.0],
        false => vec![0.0, FRAC_PI_2, 2.4 * k as f64],
    };
    let incidences = |thetas: &[f64]| -> Vec<[f64; 2]> {
        let with_phis = |(k, &theta): (usize, &f64)| phis(k).into_iter().map(move |phi| [theta, phi]);
        thetas.iter().enumerate().flat_map(with_phis).collect()
    };
    let mut coarse = thetas();
    // Towards grazing by decades of cos θ.
    coarse.extend((1..11).map(|k| FRAC_PI_2 - 10f64.powf(-0.5 * f64::from(k))));
    let [low, high] = probe.thetas();
    coarse.retain(|theta| (low..=high).contains(theta));
    coarse.extend([low, high].into_iter().filter(|&theta| theta > 0.0 && theta < FRAC_PI_2));
    let coarse = incidences(&coarse);
    let folds = if symmetry.bilateral { 1 } else { 2 };
    let most = options.budget / SHARE / 2 / (folds * USUAL * coarse.len() as u64);
    let settings = settings(probe.parameters(), (most as usize).clamp(4, 128));
    let mut places = Vec::new();
    for setting in &settings {
        places.extend(scan(probe, setting, &coarse, &layout)?);
        observer.advance(0.4 / settings.len() as f64)?;
    }

    places.sort_by(|a, b| b.possible().total_cmp(&a.possible()));
    let mut first: Vec<Vec<f64>> = Vec::new();
    for place in &places {
        if first.len() < FINE_SETTINGS && !first.contains(&place.setting) {
            first.push(place.setting.clone());
        }
    }
    let steps = |count: u32| -> Vec<f64> {
        let thetas = (0..count).map(|k| ((f64::from(k) + 0.5) / f64::from(count)).acos());
        thetas.filter(|theta| (low..=high).contains(theta)).collect()
    };
    for setting in &first {
        let fine = incidences(&steps(if symmetry.isotropic { FINE } else { FINE / 4 }));
        places.extend(scan(probe, setting, &fine, &layout)?);
        let few = incidences(&steps(DENSE));
        places.extend(scan(probe, setting, &few, &dense)?);
        observer.advance(0.2 / first.len() as f64)?;
    }
    for peak in peaks.iter().filter(|peak| peak.deviation.is_finite()) {
        if !probe.is_judged(&peak.angles) {
            continue;
        }
        let Angles { theta_i, phi_i, theta_e, phi_e } = peak.angles;
        for (theta, phi, theta_e, delta) in [
            (theta_i, phi_i, theta_e, peak.angles.delta_phi()),
            (theta_e, phi_e, theta_i, -peak.angles.delta_phi()),
        ] {
            let mut integral = Integral::new(theta, phi, &layout);
            integral.seed(theta_e, delta, SEED_SIZE);
            let mut place = [Place::new(integral, &peak.setting)];
            refine_all(probe, &mut place, SCAN)?;
            places.extend(place);
        }
    }

    let scanned = probe.evaluated;
    // The second round and later ones are for gains that are not excluded, while there is budget and no gain is certain.
    for round in 0.. {
        places.sort_by(|a, b| a.is_close.cmp(&b.is_close).then(b.possible().total_cmp(&a.possible())));
        let close = places.iter().filter(|place| place.is_close);
        let certain = close.map(Place::certain).fold(f64::NEG_INFINITY, f64::max);
        let is_open = |place: &&Place| !place.is_close && (round == 0 || place.possible() > 1.0 + CLEAR);
        let count = places.iter().take(CLOSELY).take_while(is_open).count();
        let spent = probe.evaluated - scanned;
        if count == 0 || round > 0 && (certain > 1.0 + tolerance || spent > options.budget / SHARE) {
            break;
        }
        refine_all(probe, &mut places[..count], CLOSE)?;
        places[..count].iter_mut().for_each(|place| place.is_close = true);
        observer.advance(0.0)?;
    }
    observer.advance(0.2)?;
    places.sort_by(|a, b| a.integral.rho().value.total_cmp(&b.integral.rho().value));
    let darkest = places.len().min(1);
    refine_all(probe, &mut places[..darkest], CONFIRM)?;
    let least = places.iter().map(|place| place.integral.rho().value).fold(f64::INFINITY, f64::min);
    // The first of equals.
    places.sort_by(|a, b| b.certain().total_cmp(&a.certain()));
    if options.search {
        for k in 0..CLIMBS.min(places.len()) {
            let found = climb(probe, &places[k], &layout, k as u64)?;
            places.push(found);
            observer.advance(0.1 / CLIMBS as f64)?;
        }
        // The first of equals.
        places.sort_by(|a, b| b.certain().total_cmp(&a.certain()));
    }
    let mut confirmed: Vec<Incidence> = Vec::new();
    for place in places.iter().take(CONFIRMED) {
        let incidence = confirm(probe, place, &dense, symmetry.isotropic)?;
        let is_enough = incidence.rho.certain() > 1.0 + tolerance || incidence.rho.possible() < 1.0;
        confirmed.push(incidence);
        observer.advance(0.1 / CONFIRMED as f64)?;
        if is_enough {
            break;
        }
    }
    let largest = confirmed.iter().rev().max_by(|a, b| a.rho.certain().total_cmp(&b.rho.certain()));
    let mut extent = Extent { of: places.len() as u64, ..Extent::default() };
    for place in places.iter().filter(|place| place.certain() > 1.0 + tolerance) {
        let theta = place.integral.theta_i;
        let incidence = Angles { theta_i: theta, phi_i: 0.0, theta_e: theta, phi_e: 0.0 };
        extent.add(probe.parameters(), &place.setting, &incidence);
    }
    let mut finding = finding(probe, largest, least, tolerance).with_extent(extent);
    let rest = places.iter().skip(confirmed.len()).map(|place| place.incidence(place.integral.rho()));
    confirmed.extend(rest);
    let open = confirmed.iter().max_by(|a, b| a.rho.possible().total_cmp(&b.rho.possible()));
    if let (Verdict::Kept, Some(open)) =
        (finding.verdict, open.filter(|open| open.rho.possible() > 1.0 + CLEAR))
    {
        finding.note = Some(format!(
            "no gain is confirmed, but one of {} is not excluded at θi = {:.6}°, where f32 directions and the budget leave {:.4} ± {}",
            bar(open.rho.possible() - 1.0),
            open.theta_i.to_degrees(),
            open.rho.value,
            bar(open.rho.estimate)
        ));
    }
    Ok(finding)
}

/// The integrals of some incidences at a setting.
fn scan(probe: &mut Probe, setting: &[f64], incidences: &[[f64; 2]], layout: &Layout) -> Result<Vec<Place>> {
    let new = |&[theta, phi]: &[f64; 2]| Integral::new(theta, phi, layout);
    let mut integrals: Vec<_> = incidences.iter().map(new).collect();
    refine(probe, setting, &mut integrals, SCAN.tolerance, SCAN.most)?;
    Ok(integrals.into_iter().map(|integral| Place::new(integral, setting)).collect())
}

/// Refines places, those of one setting together.
fn refine_all(probe: &mut Probe, places: &mut [Place], effort: Effort) -> Result<()> {
    places.sort_by(|a, b| a.setting.partial_cmp(&b.setting).unwrap_or(std::cmp::Ordering::Equal));
    for group in places.chunk_by_mut(|a, b| a.setting == b.setting) {
        let setting = group[0].setting.clone();
        let mut integrals: Vec<_> = group.iter().map(|place| place.integral.clone()).collect();
        refine(probe, &setting, &mut integrals, effort.tolerance, effort.most)?;
        group.iter_mut().zip(integrals).for_each(|(place, integral)| place.integral = integral);
    }
    Ok(())
}

/// Climbs on what is certain of ρ, over the incidence and the parameters, in steps of all magnitudes.
fn climb(probe: &mut Probe, from: &Place, layout: &Layout, number: u64) -> Result<Place> {
    let [low, high] = probe.thetas();
    let parameters = probe.parameters().to_vec();
    let is_free = parameters.iter().any(|p| p.low < p.high);
    let mut chance = Chance(number);
    let mut best = from.clone();
    for round in 0..ROUNDS {
        let mut move_by = |range: f64| {
            let size = 0.1 * range * 10f64.powf(-4.0 * chance.uniform());
            if chance.bits() & 1 == 0 { size } else { -size }
        };
        let setting = match is_free && round % 2 == 1 {
            true => {
                let moved = |(p, &value): (&ParameterRange, &f64)| {
                    p.at((p.place(value) + move_by(1.0)).clamp(0.0, 1.0))
                };
                parameters.iter().zip(&best.setting).map(moved).collect()
            }
            false => best.setting.clone(),
        };
        let Integral { theta_i, phi_i, .. } = best.integral;
        let mut integrals: Vec<_> = (0..TRIES)
            .map(|k| match k {
                0 => Integral::new(theta_i, phi_i, layout),
                _ => {
                    let theta = (theta_i + move_by(FRAC_PI_2)).clamp(low, high);
                    Integral::new(theta, phi_i + move_by(PI), layout)
                }
            })
            .collect();
        refine(probe, &setting, &mut integrals, CLIMB.tolerance, CLIMB.most)?;
        for integral in integrals {
            let place = Place::new(integral, &setting);
            if place.certain() > best.certain() {
                best = place;
            }
        }
    }
    Ok(best)
}

/// ρ by charts that share no node with the first, at directions that round otherwise.
fn confirm(probe: &mut Probe, place: &Place, dense: &Layout, isotropic: bool) -> Result<Incidence> {
    let Integral { theta_i, phi_i, .. } = place.integral;
    let mut integrals: Vec<_> = CHARTS
        .iter()
        .map(|&(stretch, near, far, steps)| {
            let turn = if isotropic { far } else { near };
            let most = STEP * theta_i.cos().max(0.0);
            let step = (steps * ROUNDING / theta_i.sin().max(ROUNDING)).clamp(-most, most);
            let theta_i = (theta_i + step).abs().min(FRAC_PI_2);
            Integral::new(theta_i, phi_i + turn, &Layout { stretch, ..*dense })
        })
        .collect();
    integrals.push(place.integral.clone());
    refine(probe, &place.setting, &mut integrals, CONFIRM.tolerance, CONFIRM.most)?;
    let rhos = || integrals.iter().map(Integral::rho);
    let best =
        rhos().min_by(|a, b| a.estimate.total_cmp(&b.estimate)).unwrap_or(Rho { value: 0.0, estimate: 0.0 });
    let spread = rhos().map(|rho| (rho.value - best.value).abs()).fold(0.0, f64::max);
    Ok(place.incidence(Rho { estimate: best.estimate + 2.0 * spread, ..best }))
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
    let doubt = if estimate > 0.0 { format!(" ± {}", bar(estimate)) } else { String::new() };
    let said = format!(
        "ρ_dh from {least:.6} to {value:.6}{doubt}: {}",
        match value - 1.0 {
            gain if gain > estimate + tolerance => format!("{:.3} % gained", 100.0 * gain),
            _ => format!("up to {:.3} % lost", 100.0 * (1.0 - least).max(0.0)),
        }
    );
    Finding::of(NAME, 1.0 + tolerance, said, Some(worst), probe)
}

/// An error bar, by one digit.
fn bar(estimate: f64) -> String {
    if estimate < 0.1 { format!("{estimate:.0e}") } else { format!("{estimate:.1}") }
}
