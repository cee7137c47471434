//! Promises of BRDF values: they agree with the f64 reference at every input, they are reciprocal, and
//! the specular peak survives f32.

use crate::common::*;
use gonio::table::axis::Variable::{DeltaPhi, ThetaE, ThetaI};

use gonio::check::Check;
use gonio::model::MODELS;
use gonio::plan::TablePlan;
use gonio::table::quantity::BRDF;
use std::f64::consts::{FRAC_PI_2, PI};

/// θ and δφ: the extremes, and a low-discrepancy set between them. δφ has its own extremes: the peak,
/// a hair from it, perpendicular, and backwards.
fn directions() -> (Vec<f64>, Vec<f64>) {
    let mut thetas = extreme_thetas();
    thetas.extend(golden(24, 0.1).iter().map(|u| u * FRAC_PI_2));
    let mut deltas = vec![0.0, 1e-7, 1e-4, 1e-2, FRAC_PI_2, PI - 1e-6, PI];
    deltas.extend(golden(20, 0.7).iter().map(|u| u * PI));
    (thetas, deltas)
}

fn everywhere() -> impl Iterator<Item = TablePlan> {
    let (thetas, deltas) = directions();
    let mut roughness = EXTREME_ROUGHNESS.to_vec();
    roughness.extend(golden(9, 0.4).iter().map(|u| 1e-3 + (1.0 - 1e-3) * u));
    MODELS.into_iter().filter(|model| !model.is_delta()).map(move |model| {
        let axes = vec![listed(ThetaI, &thetas), listed(ThetaE, &thetas), listed(DeltaPhi, &deltas)];
        basis(&BRDF, model, &roughness, axes)
    })
}

/// Every value of every model, within the budget of `promises.rs`. The CPU path adds the
/// rounding to storage alone, and 2e-8 where both directions graze and α = 1e-6, as sin θi − sin θe
/// comes from angles whose sum rounds near π.
#[test]
fn agree_with_the_reference_at_every_input() {
    for plan in everywhere() {
        for (evaluator, budget) in evaluators().into_iter().zip(value_budgets(plan.lobes()[0].model())) {
            let table = bake(evaluator, &plan, Check::All);
            assert_eq!(table.error.texels_checked, plan.texels());
            let worst = table.error.measured_max.unwrap();
            assert!(!table.rule.contains("on the CPU"), "{}", table.rule);
            println!(
                "{} {}: {worst:.2e} over {} values",
                plan.subject(),
                table.precision,
                table.values.len()
            );
            assert!(worst <= budget, "{} {}: {:?}", plan.subject(), table.precision, table.error);
        }
    }
}

/// f(ωi, ωe) = f(ωe, ωi).
#[test]
fn are_reciprocal() {
    for plan in everywhere() {
        for evaluator in evaluators() {
            let table = bake(evaluator, &plan, Check::Sample(0));
            let budget = exchange_budget(evaluator, plan.lobes()[0].model());
            let shape = table.shape();
            let [i, e, d] = shape[shape.len() - 3..] else { panic!() };
            let channels = table.channels.len();
            for outer in 0..table.texels() / (i * e * d) {
                for (a, b, k) in (0..i).flat_map(|a| (0..a).flat_map(move |b| (0..d).map(move |k| (a, b, k))))
                {
                    let at = |a, b| table.texel(((outer * i + a) * e + b) * d + k);
                    for c in 0..channels {
                        let (there, back) = (at(a, b)[c], at(b, a)[c]);
                        let budget = budget * there.max(back);
                        assert!((there - back).abs() <= budget, "{}: {there} and {back}", plan.subject());
                    }
                }
            }
        }
    }
}

/// At α = 1e-4, on a grid that holds the mirror direction, half vectors of f32 unit vectors are off by
/// their whole value; angles are not.
#[test]
fn keep_the_specular_peak() {
    let axes = vec![axis(ThetaI, 33), axis(ThetaE, 65), axis(DeltaPhi, 65)];
    let plan = TablePlan::basis("peak", &BRDF, model("ggx"), Some(0.01), axes).unwrap();
    let table = bake(device(), &plan, Check::All);
    let peak = table.value(16 * 65 * 65 + 32 * 65, 0);
    // At 45°: D = 1/(πα²), G2 = 1/(1 + 2Λ) ≈ 1, 4 μi μe = 2, 1 − Fc = 1 − (1 − cos 45°)⁵.
    let by_hand = (1.0 - (1.0 - 0.5f64.sqrt()).powi(5)) / (PI * 1e-8) / 2.0;
    assert!((peak / by_hand - 1.0).abs() < 1e-6, "{peak} and {by_hand}");
    assert!(table.error.measured_max.unwrap() <= 1e-5, "{:?}", table.error);
}

/// The comparer of this file can fail: a lobe one part in 10⁵ too rough is seen.
#[test]
fn a_wrong_table_is_seen() {
    let plan = |roughness| {
        let axes = vec![axis(ThetaI, 5), axis(ThetaE, 9), axis(DeltaPhi, 9)];
        TablePlan::basis("wrong", &BRDF, model("ggx"), Some(roughness), axes).unwrap()
    };
    let wrong = bake(device(), &plan(0.3 * (1.0 + 1e-5)), Check::Sample(0));
    let error = gonio::check::cross_check(&plan(0.3), &wrong.values, Check::All, None, &|_| Ok(())).unwrap();
    assert!(error.measured_max.unwrap() > 1e-5);
}
