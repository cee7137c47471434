//! Promises of models that tell azimuths from each other, and of tables over all four angles.

use crate::common::*;
use crate::promises::{INTEGRAL_F32, STORED_F32, value_f32, value_f32_at};
use gonio::bake::{Evaluator, Unobserved};
use gonio::check::Check;
use gonio::model::Model;
use gonio::model::lobe::Lobe;
use gonio::plan::TablePlan;
use gonio::scene::parse_recipe;
use gonio::scene::planner::{Plan, Selection};
use gonio::table::axis::Variable::{Mu, PhiE, PhiI, ThetaE, ThetaI};
use gonio::table::quantity::{BRDF, Quantity, RHO_DH, RHO_HH, SPLIT_SUM};
use gonio::verify::{ParameterRange, Sum, Verdict, VerifyOptions, check};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::path::Path;

/// (aspect, strength): none, Disney's at 0.9 and back, extreme, and glTF's.
const SETTINGS: [[f64; 2]; 5] = [[1.0, 0.0], [0.19, 0.0], [5.0, 0.0], [100.0, 0.0], [1.0, 0.6]];

fn plan(
    quantity: &'static Quantity,
    model: &'static Model,
    roughness: &[f64],
    [aspect, strength]: [f64; 2],
    axes: Vec<gonio::table::axis::Axis>,
) -> TablePlan {
    let parameters = [("aspect".into(), aspect), ("strength".into(), strength)];
    basis(quantity, model, roughness, axes).with_parameters(&parameters).unwrap()
}

fn all_angles() -> Vec<gonio::table::axis::Axis> {
    let thetas = [0.0, 1e-3, 0.3, 0.8, 1.2, 1.5, FRAC_PI_2 - 1e-4, FRAC_PI_2];
    let phis = [0.0, 0.3, 1.2, FRAC_PI_2, 2.5, PI, 4.0, TAU];
    vec![listed(ThetaI, &thetas), listed(PhiI, &phis), listed(ThetaE, &thetas), listed(PhiE, &phis)]
}

/// Values over (θi, φi, θe, φe), within the budget that grows with the ratio of the α.
#[test]
fn values_agree_with_the_reference() {
    for name in ["ggx-anisotropic", "beckmann-anisotropic"] {
        for setting in SETTINGS {
            let plan = plan(&BRDF, model(name), &[0.1, 0.3, 0.9], setting, all_angles());
            let lobe = &plan.lobes()[0];
            let budgets =
                plan.alphas(lobe).into_iter().map(|alpha| value_f32_at(lobe.model(), &lobe.setting(alpha)));
            let most = budgets.fold(0.0, f64::max);
            for (evaluator, budget) in evaluators().into_iter().zip([most, STORED_F32]) {
                let table = bake(evaluator, &plan.clone().with_tolerance(0.5).unwrap(), Check::All);
                let worst = table.error.measured_max.unwrap();
                println!("{name} {setting:?} {}: {worst:.2e} of {budget:.2e}", table.precision);
                assert!(worst <= budget, "{plan}: {:?}", table.error);
            }
        }
    }
}

/// The split sum over (μ, φ) meets every tolerance; f32 or f64, as the ratio of the α asks for.
#[test]
fn integrals_meet_every_tolerance() {
    let mus = [1e-5, 1e-2, 0.2, 1.0];
    let phis = [0.0, 0.4, FRAC_PI_2, 2.0];
    for name in ["ggx-anisotropic", "beckmann-anisotropic"] {
        for setting in SETTINGS {
            let axes = vec![listed(Mu, &mus), listed(PhiI, &phis)];
            let plan = plan(&SPLIT_SUM, model(name), &[0.0, 0.03, 0.2, 1.0], setting, axes);
            let tried = Tried::new(plan);
            for tolerance in [1e-2, 1e-4, 1e-6] {
                let table = tried.assert_meets(device(), tolerance, 0.0);
                println!("{name} {setting:?} to {tolerance:e} in {}", table.precision);
            }
        }
    }
}

/// ρ_dh and ρ_hh of an aspect are those of its inverse, a quarter of a turn on; and of equal α, the isotropic model's.
#[test]
fn integrals_turn_with_the_surface() {
    let rho = |name: &str, quantity, aspect: f64, phi: &[f64]| {
        let axes = match quantity == &RHO_DH {
            true => vec![listed(ThetaI, &[0.3, 1.2]), listed(PhiI, phi)],
            false => vec![],
        };
        let plan = plan(quantity, model(name), &[0.4], [aspect, 0.0], axes);
        // The reference takes half a minute for a mean over azimuths.
        let check = if quantity == &RHO_DH { Check::All } else { Check::Sample(0) };
        let [here, there] = [device(), &Evaluator::Cpu].map(|evaluator| bake(evaluator, &plan, check));
        for (a, b) in here.values.iter().zip(there.values.iter()) {
            assert!((a - b).abs() <= INTEGRAL_F32, "{name}: {a} and {b}");
        }
        let measured = here.error.measured_max;
        assert_eq!(measured.is_some(), check == Check::All);
        assert!(measured.is_none_or(|most| most <= INTEGRAL_F32), "{:?}", here.error);
        here.values.iter().collect::<Vec<f64>>()
    };
    for name in ["ggx-anisotropic", "beckmann-anisotropic"] {
        let near = |a: Vec<f64>, b: Vec<f64>| {
            let most = a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(a.len() == b.len() && most <= 2.0 * INTEGRAL_F32, "{name}: {a:?}, {b:?}");
        };
        near(rho(name, &RHO_DH, 4.0, &[0.2]), rho(name, &RHO_DH, 0.25, &[0.2 + FRAC_PI_2]));
        near(rho(name, &RHO_DH, 4.0, &[0.2]), rho(name, &RHO_DH, 4.0, &[0.2 + PI]));
        near(rho(name, &RHO_HH, 4.0, &[]), rho(name, &RHO_HH, 0.25, &[]));
        let isotropic = model(name.trim_end_matches("-anisotropic"));
        let plan = basis(&RHO_DH, isotropic, &[0.4], vec![listed(ThetaI, &[0.3, 1.2])]);
        near(
            rho(name, &RHO_DH, 1.0, &[1.0]),
            bake(device(), &plan, Check::Sample(0)).values.iter().collect(),
        );
    }
}

/// A table over all four angles of a model that does not tell azimuths has the values of the one over δφ.
#[test]
fn isotropic_models_have_tables_over_all_angles() {
    for name in ["ggx", "lambert", "oren-nayar"] {
        let table = bake(device(), &basis(&BRDF, model(name), &[0.3], all_angles()), Check::All);
        assert!(table.error.measured_max.unwrap() <= value_f32(model(name)), "{name}: {:?}", table.error);
    }
    let thetas = vec![listed(ThetaI, &[0.3, 1.2]), listed(PhiI, &[0.0, 1.0])];
    let table = bake(device(), &basis(&RHO_DH, model("ggx"), &[0.3], thetas), Check::All);
    let values: Vec<f64> = table.values.iter().collect();
    assert_eq!(values[0..2], values[2..4]);
    assert!(table.error.measured_max.unwrap() <= INTEGRAL_F32);
}

/// `alpha = [x, y]` is the anisotropic sibling with the mean α and their aspect; what cannot be stretched says so.
#[test]
fn recipes_take_two_alphas() {
    let recipe = |text: &str| parse_recipe(Path::new("test.toml"), text.as_bytes());
    let plan = |text: &str| Plan::new(&recipe(text).unwrap(), &Selection::default()).unwrap();
    let lobe = |alpha: &str| {
        format!(
            "[materials.a]\nlobes = [{{ model = \"ggx\", masking = \"smith-separable\", alpha = {alpha} }}]"
        )
    };
    let made = plan(&lobe("[0.1, 0.4]"));
    assert_eq!(made.bases[0].model, "ggx-anisotropic-smith-separable-schlick");
    assert_eq!(made.bases[0].parameters["aspect"], 0.25);
    assert!((made.bases[0].roughness.unwrap()[0] - 0.2f64.sqrt()).abs() < 1e-15);
    let table = plan("[[tables]]\nquantity = \"rho_dh\"\nmodel = \"beckmann\"\nalpha = [0.4, 0.1]");
    assert_eq!(table.tables[0].lobes()[0].model().name, "beckmann-anisotropic");
    assert_eq!(table.tables[0].lobes()[0].parameters()[0], 4.0);
    for (text, why) in [
        (lobe("[0.1, 0.4, 0.2]"), "give two"),
        (lobe("[0.0, 0.4]"), "0"),
        (lobe("[1e-6, 1.0]"), "outside"),
        ("[[tables]]\nquantity = \"rho_dh\"\nmodel = \"charlie\"\nalpha = [0.4, 0.1]".into(), "one alpha"),
    ] {
        let error = recipe(&text).unwrap_err().to_string();
        assert!(error.contains("test.toml") && error.contains(why), "{error}");
    }
}

/// Every promise but isotropy, which is not made, at an aspect of 4.
#[test]
fn promises_are_kept() {
    for name in ["ggx-anisotropic", "beckmann-anisotropic"] {
        let lobe = Lobe::new(model(name), Some(0.5), vec![[1.0, 1.0]; 3]).unwrap();
        let parameters = [("roughness", 0.5, 0.5), ("aspect", 4.0, 4.0)]
            .map(|(n, a, b)| ParameterRange::new(n, a, b).unwrap());
        let mut subject = Sum::model(device(), lobe, parameters.to_vec()).unwrap();
        let options = VerifyOptions { budget: 100_000, search: false };
        let report = check(&mut subject, &options, &Unobserved).unwrap();
        assert!(report.find("isotropy").is_none());
        for finding in &report.findings {
            println!("{name} {}: {:?} {}", finding.property, finding.verdict, finding.said);
            assert_eq!(finding.verdict, Verdict::Kept, "{name}: {finding:?}");
        }
    }
}
