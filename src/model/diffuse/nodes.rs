//! How many nodes a tolerance takes: what the tables of the lobes here are from.

use crate::base::half_angle::{Azimuth, Pair, off_horizon};
use crate::base::quadrature::gauss_legendre;
use crate::model::parameters::Setting;
use crate::model::{Integral, MODELS, Model};
use std::f64::consts::{FRAC_PI_2, PI};

/// Nodes beyond which nothing changes: each panel is analytic, and these are twice what 1e-10 takes.
const PLENTY: usize = 64;

/// ρ_dh(θi) by so many nodes in each panel.
fn rho(model: &Model, setting: &Setting, theta_i: f64, [theta, phi]: [usize; 2]) -> f64 {
    let kinked = matches!(model.integral, Integral::Kinked(_));
    let thetas = if kinked { vec![0.0, off_horizon(theta_i), FRAC_PI_2] } else { vec![0.0, FRAC_PI_2] };
    let deltas = if kinked { vec![0.0, FRAC_PI_2, PI] } else { vec![0.0, PI] };
    let azimuths: Vec<_> = nodes(&deltas, phi).map(|(delta, weight)| (Azimuth::new(delta), weight)).collect();
    nodes(&thetas, theta)
        .map(|(theta_e, weight)| {
            let pair = Pair::new(theta_i, theta_e);
            let ring: f64 = azimuths.iter().map(|(a, w)| w * (model.lobe)(&pair, a, setting)[0]).sum();
            2.0 * weight * theta_e.sin() * theta_e.cos() * ring
        })
        .sum()
}

/// Gauss–Legendre between the breaks.
fn nodes(breaks: &[f64], n: usize) -> impl Iterator<Item = (f64, f64)> {
    let rule = gauss_legendre(n);
    breaks.windows(2).flat_map(move |ends| {
        let (start, width) = (ends[0], ends[1] - ends[0]);
        rule.iter().map(move |node| (start + width * node.x, width * node.weight)).collect::<Vec<_>>()
    })
}

/// The largest error over θi and the roughness, at the parameters' defaults.
fn worst(model: &Model, counts: [usize; 2]) -> f64 {
    let mut worst: f64 = 0.0;
    for roughness in [0.0, 0.01, 0.05, 0.13, 0.25, 0.5, 0.75, 0.9, 0.99, 1.0] {
        let setting = Setting { alpha: model.measure(roughness), parameters: model.defaults() };
        for degrees in [0.0, 1e-3, 5.0, 20.0, 33.0, 45.0, 58.0, 70.0, 80.0, 87.0, 89.5, 89.999, 90.0] {
            let at = |counts| rho(model, &setting, f64::to_radians(degrees), counts);
            worst = worst.max((at(counts) - at([PLENTY; 2])).abs());
        }
    }
    worst
}

/// Prints the tables `COUNTS` of the lobes: for tolerances 1e-1 … 1e-10 the least count in θe and in δφ whose
/// error alone, and that of the next, is below a quarter of the tolerance.
#[test]
#[ignore = "prints tables"]
fn print_the_counts() {
    let diffuse = MODELS.iter().filter(|m| matches!(m.integral, Integral::Smooth(_) | Integral::Kinked(_)));
    for model in diffuse {
        let errors = [0, 1].map(|which| {
            let at = |n: usize| worst(model, [0, 1].map(|k| if k == which { n } else { PLENTY }));
            (1..=40).map(at).collect::<Vec<_>>()
        });
        let count = |errors: &Vec<f64>, tolerance: f64| {
            let fits = |pair: &[f64]| pair.iter().all(|error| *error < 0.25 * tolerance);
            errors.windows(2).position(fits).map_or(usize::MAX, |k| k + 1)
        };
        let row = |decade: i32| [0, 1].map(|k| count(&errors[k], 10f64.powi(-decade)));
        println!("{}: {:?}", model.name, (1..=10).map(row).collect::<Vec<_>>());
    }
}

/// The tables hold: at the last tolerance that one has, the error of both counts together is within it.
#[test]
fn the_counts_meet_their_tolerances() {
    for model in MODELS {
        let (Integral::Smooth(counts) | Integral::Kinked(counts)) = model.integral else { continue };
        for decade in [1, 3, 6, 10] {
            let tolerance = 10f64.powi(-decade);
            let error = worst(model, counts(tolerance));
            assert!(error < tolerance, "{} at {tolerance:e}: {error:e}", model.name);
        }
    }
}

/// The largest ρ_dh is what the models declare: not more, and not a hundredth less where they gain.
#[test]
fn the_bounds_are_the_largest_albedos() {
    for model in MODELS {
        if !matches!(model.integral, Integral::Smooth(_) | Integral::Kinked(_)) || model.shape.is_none() {
            continue;
        }
        let at = |k: u32, j: u32| {
            let setting =
                Setting { alpha: model.measure(f64::from(k) / 200.0), parameters: model.defaults() };
            rho(model, &setting, FRAC_PI_2 * f64::from(j) / 90.0, [16, 10])
        };
        let (mut most, mut place) = (0.0, (0, 0));
        for (k, j) in (0..=200).flat_map(|k| (0..=90).map(move |j| (k, j))) {
            let rho = at(k, j);
            if rho > most {
                (most, place) = (rho, (k, j));
            }
        }
        println!("{}: {most} at roughness {}, θi = {}°", model.name, f64::from(place.0) / 200.0, place.1);
        assert!(most <= model.rho_bound + 1e-12, "{}: {most}", model.name);
        assert!(model.rho_bound == 1.0 || most > model.rho_bound - 1e-3, "{}: {most}", model.name);
    }
}
