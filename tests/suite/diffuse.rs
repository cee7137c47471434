//! Promises of the diffuse lobes: their limits, their closed forms, and all digits where two directions graze.

use crate::common::*;
use crate::promises::VALUE_F32;
use gonio::bake::Evaluator;
use gonio::bake::points::Points;
use gonio::base::angles::Angles;
use gonio::check::Check;
use gonio::model::lobe::Lobe;
use gonio::plan::TablePlan;
use gonio::table::axis::Variable::{DeltaPhi, Mu, ThetaE, ThetaI};
use gonio::table::quantity::{BRDF, RHO_HH, SPLIT_SUM};
use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI};

/// Of Fujii's form and EON: A = 1/(1 + K1 r), the mean albedo A (1 + K2 r).
const K1: f64 = 0.5 - 2.0 / (3.0 * PI);
const K2: f64 = 2.0 / 3.0 - 28.0 / (15.0 * PI);

/// ρ_dh at cosines of one roughness and, if the model takes one, one albedo, in f64.
fn rho_dh(evaluator: &Evaluator, name: &str, roughness: f64, albedo: Option<f64>, mus: &[f64]) -> Vec<f64> {
    let plan =
        TablePlan::basis("rho", &SPLIT_SUM, model(name), Some(roughness), vec![listed(Mu, mus)]).unwrap();
    let given: Vec<_> = albedo.map(|albedo| ("albedo".into(), albedo)).into_iter().collect();
    let plan = plan.with_parameters(&given).unwrap().with_tolerance(1e-9).unwrap();
    bake(evaluator, &plan, Check::Sample(0)).values.iter().collect()
}

fn close(name: &str, value: f64, exact: f64, tolerance: f64) {
    assert!((value - exact).abs() <= tolerance, "{name}: {value}, not {exact}");
}

/// E of Fujii's form, as EON's listing 1 has it: for μ away from 0, where it cancels.
fn fujii_albedo(mu: f64, r: f64) -> f64 {
    let s = ((1.0 - mu) * (1.0 + mu)).sqrt();
    let g = s * (mu.acos() - s * mu) + 2.0 / 3.0 * ((s / mu) * (1.0 - s.powi(3)) - s);
    (1.0 + r * FRAC_1_PI * g) / (1.0 + K1 * r)
}

/// σ = 0 is Lambert, bit by bit, wherever the directions are; its albedo is 1 to the last digits.
#[test]
fn of_no_roughness_are_lambert() {
    let thetas = extreme_thetas();
    for evaluator in evaluators() {
        for name in ["oren-nayar", "fujii", "eon"] {
            let deltas = listed(DeltaPhi, &[0.0, 1e-7, 1.0, FRAC_PI_2, 2.5, PI]);
            let axes = vec![listed(ThetaI, &thetas), listed(ThetaE, &thetas), deltas];
            let plan = TablePlan::basis("smooth", &BRDF, model(name), Some(0.0), axes).unwrap();
            let table = bake(evaluator, &plan, Check::Sample(0));
            assert!(table.values.iter().all(|f| f == f64::from(FRAC_1_PI as f32)), "{name}");
            for rho in rho_dh(evaluator, name, 0.0, None, &[1e-7, 0.1, 0.7, 1.0]) {
                close(name, rho, 1.0, 1e-9);
            }
        }
    }
}

/// Oren–Nayar's ρ_dh where ωi grazes: B's term is sin²θe cos φ there, A + B/2.
#[test]
fn of_oren_nayar_are_a_and_half_of_b_at_grazing() {
    for evaluator in evaluators() {
        for roughness in [0.05, 0.1275, 0.5, 1.0] {
            let x = (FRAC_PI_2 * roughness).powi(2);
            let exact = 1.0 - 0.5 * x / (x + 0.33) + 0.225 * x / (x + 0.09);
            // The derivative by μ at 0 is about B: 1e-7 at the least cosine.
            close("oren-nayar", rho_dh(evaluator, "oren-nayar", roughness, None, &[0.0])[0], exact, 2e-7);
        }
    }
}

/// Fujii's albedo is what Portsmouth et al. give in closed form, 1 at grazing; its mean too.
#[test]
fn of_fujii_have_their_closed_forms() {
    let mus = [0.01, 0.1, 0.3, 0.5, 0.8, 0.99, 1.0];
    for evaluator in evaluators() {
        for r in [0.1, 0.5, 1.0] {
            for (rho, mu) in rho_dh(evaluator, "fujii", r, None, &mus).into_iter().zip(mus) {
                close("fujii", rho, fujii_albedo(mu, r), 1e-9);
            }
            close("fujii", rho_dh(evaluator, "fujii", r, None, &[0.0])[0], 1.0, 1e-7);
            let plan = TablePlan::basis("mean", &RHO_HH, model("fujii"), Some(r), vec![]).unwrap();
            let table = bake(evaluator, &plan.with_tolerance(1e-9).unwrap(), Check::All);
            close("fujii", table.values.get(0), (1.0 + K2 * r) / (1.0 + K1 * r), 1e-9);
        }
    }
}

/// EON's albedo is ρ E + ρₘ (1 − E), ρₘ = ρ² Ē/(1 − ρ (1 − Ē)): white reflects everything.
#[test]
fn of_eon_have_their_closed_form() {
    let mus = [0.01, 0.1, 0.3, 0.5, 0.8, 0.99, 1.0];
    for evaluator in evaluators() {
        for (r, rho) in [(0.2, 1.0), (1.0, 1.0), (1.0, 0.5), (0.5, 0.18), (1.0, 0.0)] {
            let mean = (1.0 + K2 * r) / (1.0 + K1 * r);
            let rho_m = rho * rho * mean / (1.0 - rho * (1.0 - mean));
            for (value, mu) in rho_dh(evaluator, "eon", r, Some(rho), &mus).into_iter().zip(mus) {
                let e = fujii_albedo(mu, r);
                close("eon", value, rho * e + rho_m * (1.0 - e), 1e-9);
                assert!(rho < 1.0 || (value - 1.0).abs() < 1e-9, "{value}");
            }
        }
    }
}

/// Disney's lobe at roughness 1 where ωi grazes: F90 = 3/2 + sin θe cos φ there, and ρ_dh = 785/504;
/// Frostbite's is 1/1.51 of that. At the normal (1 − μi)⁵ is 0 and F90 − 1 = r (1 + μ) − 1/2, so that ρ_dh is
/// a polynomial: with ∫ μ x⁵ = 1/42 and ∫ μ² x⁵ = 1/168 over x = 1 − μ, 1 + (r − 1/2)/21 + r/84.
#[test]
fn of_burley_and_frostbite_have_their_closed_forms() {
    for evaluator in evaluators() {
        let grazing = |name: &str| rho_dh(evaluator, name, 1.0, None, &[0.0])[0];
        // The derivative by μ is about 10 at 0, where (1 − μ)⁵ turns.
        close("burley", grazing("burley"), 785.0 / 504.0, 1e-6);
        close("frostbite", grazing("frostbite"), 785.0 / (504.0 * 1.51), 1e-6);
        for r in [0.0, 0.3, 1.0] {
            let normal = |name: &str| rho_dh(evaluator, name, r, None, &[1.0])[0];
            close("burley", normal("burley"), 1.0 + (r - 0.5) / 21.0 + r / 84.0, 1e-9);
            let factor = 1.0 - r + r / 1.51;
            close("frostbite", normal("frostbite"), factor * (1.0 + (1.5 * r - 1.0) / 21.0 + r / 84.0), 1e-9);
        }
    }
}

/// Where both directions graze, Fujii's f is 1/(1 + K1 r) times
///
/// - 1 + r cos φ sin²θ/μ on the same side: to all digits for cos φ = 1e-6, which is lost in sin²(δ/2) − cos²(δ/2);
/// - (1 − r) + r μ² (1 + …) ahead: to all digits for r = 1 and a hair below, which is lost in 1 + s and in f32's r.
#[test]
fn keep_their_digits_at_grazing() {
    for (evaluator, budget) in evaluators().into_iter().zip([VALUE_F32, 1.5 / f64::from(1 << 24)]) {
        let f = |r: f64, theta: f64, delta: f64| {
            let lobe = Lobe::new(model("fujii"), Some(r), vec![[1.0, 0.0]]).unwrap();
            let angles = Angles { theta_i: theta, phi_i: 0.0, theta_e: theta, phi_e: PI + delta };
            let (mut values, delta) = (Vec::new(), angles.delta_phi());
            Points::new(evaluator, &[lobe]).unwrap().evaluate(&[angles], &mut values).unwrap();
            (f64::from(values[0]) * PI * (1.0 + K1 * r), delta)
        };
        for gamma in [1e-2f64, 1e-4, 1e-6] {
            let (theta, mu) = (FRAC_PI_2 - gamma, (FRAC_PI_2 - gamma).cos());
            let (value, delta) = f(1.0, theta, FRAC_PI_2 + 1e-6);
            let exact = 1.0 - delta.cos() * theta.sin().powi(2) / mu;
            close("aside", value / exact, 1.0, budget);
            for rest in [0.0, 1e-12, 1e-6, 1e-3] {
                let r = 1.0 - rest;
                // 1 + s = 1 − sin²θ = μ² straight ahead.
                close("ahead", f(r, theta, 0.0).0 / ((1.0 - r) + r * mu * mu), 1.0, budget);
            }
        }
    }
}

/// ρ of EON is a parameter of its own in each channel: a material of three is three lobes, each of one channel.
#[cfg(feature = "scene")]
#[test]
fn an_eon_of_three_albedos_is_three_lobes() {
    use gonio::scene::planner::{Plan, Selection};
    let recipe =
        "[materials.clay]\nlobes = [{ model = \"eon\", roughness = 0.8, albedo = [0.9, 0.5, 0.2] }]\n";
    let scene = gonio::scene::parse_recipe("clay.toml".as_ref(), recipe.as_bytes()).unwrap();
    let table =
        TablePlan::material("clay", &gonio::table::quantity::RHO_DH, &scene, "clay", vec![axis(ThetaI, 5)]);
    let table = bake(device(), &table.unwrap(), Check::All);
    assert!(table.error.measured_max.unwrap() <= 1e-4);
    assert_eq!(Plan::new(&scene, &Selection::default()).unwrap().bases.len(), 3);
    for (channel, rho) in [0.9, 0.5, 0.2].into_iter().enumerate() {
        let basis = rho_dh(device(), "eon", 0.8, Some(rho), &[1.0])[0];
        close("clay", table.value(0, channel), basis, 1e-4);
        assert!(basis < rho, "light that is scattered twice is absorbed twice: {basis}");
    }
}
