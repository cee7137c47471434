//! Promises of the distributions of normals: limits that they share, closed forms, and what they are known to break.

use crate::common::*;
use crate::promises::{INTEGRAL_F32, energy};
use gonio::check::Check;
use gonio::reference::{Angles, MIN_MU, Parameters, Reference, Setting};
use gonio::table::axis::Variable::{DeltaPhi, Mu, ThetaE, ThetaI};
use gonio::table::quantity::{BRDF, RHO_DH, RHO_HH, SPLIT_SUM};
use std::f64::consts::{FRAC_PI_2, PI};

/// Names and γ.
const NEW: [(&str, f64); 8] = [
    ("gtr", 1.0),
    ("gtr", 1.5),
    ("gtr", 4.0),
    ("gtr", 10.0),
    ("student-t", 2.5),
    ("student-t", 40.0),
    ("blinn-phong", 0.0),
    ("charlie", 0.0),
];

fn with_gamma(model: &dyn Reference, alpha: f64, gamma: f64) -> Setting {
    Setting::measured(model.measure(), alpha, &Parameters::named([("gamma", gamma)]).unwrap()).unwrap()
}

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

/// γ = 2 is GGX, α = 1 the same for every γ, and γ → 1 goes over into Disney's logarithm.
#[test]
fn gtr_has_the_limits_of_its_exponent() {
    let [gtr, ggx] = ["gtr", "ggx"].map(reference_model);
    for angles in directions() {
        let value = |alpha: f64, gamma: f64| gtr.brdf(&angles, &with_gamma(gtr, alpha, gamma)).unwrap()[0];
        for alpha in [1e-3, 0.1, 0.7, 1.0] {
            let exact = ggx.brdf(&angles, &with_alpha(ggx, alpha)).unwrap()[0];
            assert_near(value(alpha, 2.0), exact, 1e-11, &(angles, alpha));
            assert_near(value(alpha, 1.0 + 1e-9), value(alpha, 1.0), 1e-6, &(angles, alpha));
        }
        assert_near(value(1.0, 4.0), value(1.0, 1.0), 1e-12, &angles);
        assert_near(value(1.0 - 1e-9, 4.0), value(1.0, 4.0), 1e-7, &angles);
    }
}

/// γ = 2 is GGX; γ → ∞ goes over into Beckmann, 1/γ off; α → 0 is the mirror, and energy is conserved at every γ.
#[test]
fn student_t_has_the_limits_of_its_exponent() {
    let [student, ggx, beckmann] = ["student-t", "ggx", "beckmann"].map(reference_model);
    let with = |alpha: f64, gamma: f64| with_gamma(student, alpha, gamma);
    for angles in directions() {
        for alpha in [1e-6, 1e-3, 0.1, 0.7, 1.0] {
            let [a, b] =
                [student.brdf(&angles, &with(alpha, 2.0)), ggx.brdf(&angles, &with_alpha(ggx, alpha))];
            assert_near(a.unwrap()[0], b.unwrap()[0], 1e-12, &(angles, alpha));
        }
    }
    for (mu, alpha) in [(1.0, 0.3), (0.3, 0.3), (0.01, 0.1), (0.5, 1.0)] {
        let sum = |[a, b]: [f64; 2]| a + b;
        let exact = sum(beckmann.rho_dh(mu, &with_alpha(beckmann, alpha)));
        let off = [10.0, 20.0, 40.0].map(|gamma| sum(student.rho_dh(mu, &with(alpha, gamma))) - exact);
        assert!(off[2].abs() < 0.01 && off[2].abs() < 0.7 * off[1].abs(), "{mu}, {alpha}: {off:?}");
        for gamma in [1.6, 1.8, 3.0, 40.0] {
            let rho = |alpha: f64| sum(student.rho_dh(mu, &with(alpha, gamma)));
            assert!(rho(alpha) <= 1.0 + 1e-9, "{gamma}: {}", rho(alpha));
            // (1 − Fc) + Fc, rounded.
            assert!((rho(0.0) - 1.0).abs() <= f64::EPSILON, "{}", rho(0.0));
            // 1 − ρ falls as (α/μ)^(2γ − 2), the facets that ωi does not see from above.
            assert!(1.0 - rho(1e-4 * mu) < 1e-3, "{gamma}: {}", rho(1e-4 * mu));
        }
    }
}

/// Below Disney's least α nothing changes.
#[test]
fn gtr_takes_no_less_than_its_least_alpha() {
    let gtr = model("gtr");
    assert_eq!(gtr.measure(0.0), 1e-3);
    assert_eq!(gtr.measure(0.5), 0.25);
    let plan = basis(&SPLIT_SUM, gtr, &[0.0, 0.001f64.sqrt()], vec![listed(Mu, &[1e-3, 0.1, 0.5, 1.0])]);
    for evaluator in evaluators() {
        let table = bake(evaluator, &plan, Check::All);
        let values: Vec<_> = table.values.iter().collect();
        let (none, least) = values.split_at(values.len() / 2);
        assert_eq!(none, least);
    }
}

/// Values at γ of every kind, within the budget that stands beside the NDF.
#[test]
fn values_agree_with_the_reference_for_every_gamma() {
    let mut thetas = extreme_thetas();
    thetas.extend(golden(6, 0.1).iter().map(|u| u * FRAC_PI_2));
    let gammas =
        [("gtr", [1.0, 1.0 + 1e-7, 1.3, 2.0, 3.7, 10.0]), ("student-t", [1.6, 1.9, 2.0, 3.7, 11.0, 40.0])];
    for (name, gamma) in gammas.into_iter().flat_map(|(name, all)| all.map(|gamma| (name, gamma))) {
        let model = model(name);
        let axes =
            vec![listed(ThetaI, &thetas), listed(ThetaE, &thetas), listed(DeltaPhi, &[0.0, 1e-3, 1.0, PI])];
        let plan = basis(&BRDF, model, &EXTREME_ROUGHNESS, axes)
            .with_parameters(&[("gamma".into(), gamma)])
            .unwrap();
        for (evaluator, budget) in evaluators().into_iter().zip(value_budgets(model)) {
            let worst = bake(evaluator, &plan, Check::All).error.measured_max.unwrap();
            println!("{name}, γ = {gamma}: {worst:.1e} of {budget:.1e}");
            assert!(worst <= budget, "{name}, γ = {gamma}: {worst} of {budget}");
        }
    }
}

/// Every tolerance is met at every γ, by the arithmetic that the plan chooses: where ρ is in the hundreds, f32 has no 1e-6.
#[test]
fn integrals_meet_every_tolerance_for_every_gamma() {
    let roughness = [0.0, 0.1, 0.3, 0.6, 1.0];
    let thetas = [0.0, 0.8, 1.4, FRAC_PI_2 - 0.03, FRAC_PI_2 - 1e-3, FRAC_PI_2];
    let gammas =
        [("gtr", 1.0), ("gtr", 1.4), ("gtr", 3.0), ("gtr", 10.0), ("student-t", 1.6), ("student-t", 30.0)];
    for (name, gamma) in gammas {
        for (quantity, axes) in [
            (&RHO_DH, vec![listed(ThetaI, &thetas)]),
            (&RHO_HH, vec![]),
            (&SPLIT_SUM, vec![listed(Mu, &[1e-3, 0.2, 1.0])]),
        ] {
            let roughness = some_of(&roughness, if quantity.name == RHO_HH.name { 4 } else { 2 });
            let plan = basis(quantity, model(name), &roughness, axes);
            let plan = plan.with_parameters(&[("gamma".into(), gamma)]).unwrap();
            let tried = Tried::new(plan);
            for tolerance in some_of(&[1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8], 3) {
                // The reference adds 1e-10.
                let table = tried.assert_meets(device(), tolerance, 1e-10);
                println!("{name} {} γ = {gamma} to {tolerance:e}: {}", quantity.name, table.precision);
            }
        }
    }
}

/// As α → 0, Blinn–Phong is Beckmann: cos^p θm = e^(−p θm²/2) but for O(α² x²), x = tan²θm/α².
#[test]
fn blinn_phong_becomes_beckmann() {
    let [blinn, beckmann] = ["blinn-phong", "beckmann"].map(reference_model);
    for alpha in [1e-3, 1e-4] {
        for (theta_i, off) in [(0.0, 0.0), (0.3, 0.5), (1.2, 1.0), (0.8, 3.0)] {
            let angles = Angles { theta_i, theta_e: theta_i + off * alpha, delta_phi: 0.0, phi_i: 0.0 };
            let [a, b] =
                [blinn, beckmann].map(|model| model.brdf(&angles, &with_alpha(model, alpha)).unwrap()[0]);
            assert_near(a, b, 10.0 * alpha * alpha, &(angles, alpha));
        }
    }
}

/// ∫ D cos θm dωm = 1, by the trapezoid in ln tan θm.
#[test]
fn normals_are_normalised() {
    for (name, gamma) in NEW {
        let reference = reference_model(name);
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
                let d = reference.factors(&angles, &with_gamma(reference, alpha, gamma)).unwrap().d;
                sum += 2.0 * PI * step * d * tan * tan / (1.0 + tan * tan).powi(2);
            }
            // What is beyond 2⁻²³ is nothing; the trapezoid of a bell converges beyond f64.
            assert!((sum - 1.0).abs() < 1e-9, "{name}, γ = {gamma}, α = {alpha}: {sum}");
        }
    }
}

/// Charlie's least α: below it nothing changes, and ρ is no mirror's.
#[test]
fn charlie_is_no_mirror_at_alpha_0() {
    let charlie = model("charlie");
    let reference = reference_model("charlie");
    for angles in directions() {
        let at = |alpha: f64| reference.brdf(&angles, &with_alpha(reference, alpha)).unwrap();
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
    let rho = |name: &str, alpha: f64, gamma: f64| {
        let reference = reference_model(name);
        let [a, b] = reference.rho_dh(MIN_MU, &with_gamma(reference, alpha, gamma));
        a + b
    };
    let gtr = rho("gtr", 1e-3, 1.0);
    assert!((gtr - 144.61).abs() < 1e-2 && gtr <= energy(model("gtr")), "{gtr}");
    assert!((rho("gtr", 0.1, 1.0) - 0.9 / (0.1 * 10f64.ln())).abs() < 1e-4);
    assert!((rho("gtr", 0.1, 1.5) - 1.895).abs() < 1e-3 && rho("gtr", 0.1, 2.0) <= 1.0);
    let blinn = rho("blinn-phong", 1.0, 0.0);
    assert!((blinn - PI.sqrt()).abs() < 1e-4 && blinn <= energy(model("blinn-phong")), "{blinn}");
    let charlie = rho("charlie", 0.005, 0.0);
    assert!((charlie - 8.977).abs() < 1e-2 && charlie <= energy(model("charlie")), "{charlie}");
}
