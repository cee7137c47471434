//! Promises of the distributions of normals: limits that they share, closed forms, and what they are known to break.

use crate::common::*;
use gonio::axis::Variable::Mu;
use gonio::check::Check;
use gonio::plan::INTEGRAL_F32;
use gonio::quantity::SPLIT_SUM;
use gonio::reference::{Angles, MIN_MU};
use std::f64::consts::{FRAC_PI_2, PI};

const NEW: [&str; 2] = ["blinn-phong", "charlie"];

fn directions() -> Vec<Angles> {
    let mut thetas = extreme_thetas();
    thetas.extend(golden(4, 0.3).iter().map(|u| u * FRAC_PI_2));
    let pairs = thetas.iter().flat_map(|&i| thetas.iter().map(move |&e| (i, e)));
    pairs
        .flat_map(|(theta_i, theta_e)| {
            [0.0, 1e-4, 0.3, 2.0, PI].map(|delta_phi| Angles { theta_i, theta_e, delta_phi, phi_i: 0.0 })
        })
        .collect()
}

fn assert_near(a: f64, b: f64, relative: f64, what: &dyn std::fmt::Debug) {
    assert!((a - b).abs() <= relative * a.abs().max(b.abs()) + 1e-300, "{a} is not {b}: {what:?}");
}

/// As α → 0, Blinn–Phong is Beckmann: cos^p θm = e^(−p θm²/2) but for O(α² x²), x = tan²θm/α².
#[test]
fn blinn_phong_becomes_beckmann() {
    let [blinn, beckmann] = ["blinn-phong", "beckmann"].map(|name| model(name).reference.unwrap());
    for alpha in [1e-3, 1e-4] {
        for (theta_i, off) in [(0.0, 0.0), (0.3, 0.5), (1.2, 1.0), (0.8, 3.0)] {
            let angles = Angles { theta_i, theta_e: theta_i + off * alpha, delta_phi: 0.0, phi_i: 0.0 };
            let [a, b] = [blinn, beckmann].map(|of| of.brdf(&angles, &alpha.into()).unwrap()[0]);
            assert_near(a, b, 10.0 * alpha * alpha, &(angles, alpha));
        }
    }
}

/// ∫ D cos θm dωm = 1, by the trapezoid in ln tan θm.
#[test]
fn normals_are_normalised() {
    for name in NEW {
        for alpha in [0.01, 0.1, 0.5, 1.0] {
            let (step, mut sum) = (1e-2, 0.0);
            for k in -2500..2500 {
                let tan = (f64::from(k) * step).exp();
                // Retroreflection: ωm = ωi = ωe.
                let theta = tan.atan();
                let angles = Angles { theta_i: theta, theta_e: theta, delta_phi: PI, phi_i: 0.0 };
                if theta.cos() <= 2.0 * MIN_MU {
                    break;
                }
                let d = model(name).reference.unwrap().factors(&angles, &alpha.into()).unwrap().d;
                sum += 2.0 * PI * step * d * tan * tan / (1.0 + tan * tan).powi(2);
            }
            // What is beyond 2⁻²³ is nothing; the trapezoid of a bell converges beyond f64.
            assert!((sum - 1.0).abs() < 1e-9, "{name}, α = {alpha}: {sum}");
        }
    }
}

/// Charlie's least α: below it nothing changes, and ρ is no mirror's.
#[test]
fn charlie_is_no_mirror_at_alpha_0() {
    let charlie = model("charlie");
    let reference = charlie.reference.unwrap();
    for angles in directions() {
        let at = |alpha: f64| reference.brdf(&angles, &alpha.into()).unwrap();
        assert_eq!(at(0.0), at(0.005));
        assert!(at(0.005)[0].is_finite());
    }
    let mus = [1e-3, 0.1, 0.5, 1.0];
    let table = |roughness: f64| {
        let plan = basis(&SPLIT_SUM, charlie, &[roughness], vec![listed(Mu, &mus)]);
        bake(device(), &plan, Check::All).values
    };
    let (none, least) = (table(0.0), table(0.005f64.sqrt()));
    for (a, b) in none.iter().zip(least.iter()) {
        assert!((a - b).abs() < INTEGRAL_F32 && a < 3.0);
    }
}

/// What is declared is broken, and by no more.
#[test]
fn energy_is_broken_as_declared() {
    let rho = |name: &str, alpha: f64| {
        let [a, b] = model(name).reference.unwrap().rho_dh(MIN_MU, &alpha.into());
        a + b
    };
    let blinn = rho("blinn-phong", 1.0);
    assert!((blinn - PI.sqrt()).abs() < 1e-4 && blinn <= model("blinn-phong").rho_bound, "{blinn}");
    let charlie = rho("charlie", 0.005);
    assert!((charlie - 8.977).abs() < 1e-2 && charlie <= model("charlie").rho_bound, "{charlie}");
}
