//! Promises of α → 0: integrals join the mirror's, values keep the exact peak down to α = 1e-6, and what is a
//! delta is never returned as a number.

use crate::common::*;
use crate::promises::{STORED_F32, VALUE_F32};
use gonio::bake::points::Points;
use gonio::base::angles::Angles;
use gonio::check::Check;
use gonio::model::lobe::Lobe;
use gonio::plan::TablePlan;
use gonio::table::axis::Variable::{DeltaPhi, Mu, ThetaE, ThetaI};
use gonio::table::quantity::{BRDF, SPLIT_SUM};
use std::f64::consts::{FRAC_PI_2, PI};

/// At fixed μ > 0 what is left of the difference falls as α²: slopes of a lobe are of size α, their mean is
/// 0, and the integrand is smooth in them. In f64, to 1e-9, so that four decades of α show the rate: 2 within
/// what log α adds, as GGX's slopes have an infinite variance (∫ t³/(1+t²)² dt to 1/α: α² ln(1/α), whose slope
/// is 2 − 1/ln(1/α), from 1.78 at 1e-2 to 1.91 at 1e-5).
#[test]
fn integrals_join_the_mirror_as_alpha_squared() {
    let mus = [0.05, 0.3, 0.7, 1.0];
    for evaluator in evaluators() {
        let integrals = |name: &str, alpha: f64| {
            let plan = basis(&SPLIT_SUM, model(name), &[alpha.sqrt()], vec![listed(Mu, &mus)]);
            bake(evaluator, &plan.with_tolerance(1e-9).unwrap(), Check::Sample(0))
                .values
                .iter()
                .collect::<Vec<_>>()
        };
        let mirror = integrals("mirror", 0.0);
        let gap = |alpha: f64| {
            let difference = |(a, b): (f64, &f64)| (a - b).abs();
            integrals("ggx", alpha).into_iter().zip(&mirror).map(difference).fold(0.0, f64::max)
        };
        assert_eq!(gap(0.0), 0.0, "α = 0 is the mirror");
        let gaps = [1e-2, 1e-3, 1e-4].map(gap);
        let rates = [0, 1].map(|k| (gaps[k] / gaps[k + 1]).log10());
        println!("{gaps:?}: {rates:?}");
        assert!(rates.iter().all(|rate| (1.7..2.1).contains(rate)), "{gaps:?}: {rates:?}");
        // Beyond, the rule's own 1e-9 is all there is.
        assert!(gap(1e-6) < 2e-9, "{}", gap(1e-6));
    }
}

/// At θi = θe and δφ = 0, θm = 0 and D = 1/(π α²); 1 + 2Λ = √(1 + α² tan²θ) is the same for both, so that
/// G2 = 1/√(1 + α² tan²θ): f = (1 − Fc) / (4 π α² μ² √(1 + α² tan²θ)), Fc = x⁵, x = 1 − μ
/// (and 1 − x⁵ = μ (1 + x + x² + x³ + x⁴)). With μ ≥ 2⁻²⁴ that is the horizon too. A, and A + B, which has no Fresnel, are compared. The budget of a value is in `promises.rs`; the CPU path rounds to storage alone,
/// plus what f64 loses of angles (as in tests/suite/values.rs).
///
/// The f64 nearest to π is 1.2e-16 rad from the mirror direction, and a lobe of α = 1e-6 at the horizon shows
/// it, by 2e-6: tan θm = sin θ sin(δφ/2)/μ.
#[test]
fn the_peak_is_exact_down_to_the_smallest_alpha() {
    let thetas = [0.0, 1e-7, 1e-3, 0.3, 0.8, 1.2, 1.5, FRAC_PI_2 - 1e-3, FRAC_PI_2 - 1e-6, FRAC_PI_2];
    for (evaluator, budget) in evaluators().into_iter().zip([VALUE_F32, STORED_F32 + 2e-8]) {
        let mut worst: f64 = 0.0;
        for alpha in [1e-6, 3e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.5, 1.0] {
            for theta in thetas {
                let mu = theta.cos().max(1.0 / (1 << 24) as f64);
                let tan2 = (1.0 - mu) * (1.0 + mu) / (mu * mu);
                let x = 1.0 - mu;
                let one_minus_fc = mu * (1.0 + x + x.powi(2) + x.powi(3) + x.powi(4));
                let mirror = Angles { theta_i: theta, phi_i: 0.0, theta_e: theta, phi_e: PI };
                let tan2_m = (theta.sin() * (0.5 * mirror.delta_phi()).sin() / mu).powi(2);
                let d = 1.0 / (PI * (alpha + tan2_m / alpha).powi(2));
                let all = d / (4.0 * mu * mu * (1.0 + alpha * alpha * tan2).sqrt());
                let lobe = Lobe::new(model("ggx"), Some(1.0), vec![[1.0, 0.0], [1.0, 1.0]]).unwrap();
                let mut values = Vec::new();
                Points::new(evaluator, &[lobe]).unwrap().sweep(&[alpha], &[mirror], &mut values).unwrap();
                for (&value, exact) in values.iter().zip([all * one_minus_fc, all]) {
                    let error = (f64::from(value) / exact - 1.0).abs();
                    worst = worst.max(error);
                    assert!(error <= budget, "α = {alpha}, θ = {theta}: {value:e}, not {exact:e}");
                }
            }
        }
        println!("{worst:.1e} at most");
    }
}

/// Tables, lists of points and sweeps refuse a delta and say so: none returns a large number, or 0.
#[test]
fn a_delta_is_refused() {
    let axes = || vec![axis(ThetaI, 3), axis(ThetaE, 3), axis(DeltaPhi, 3)];
    let table = |name: &str, roughness| {
        TablePlan::basis("t", &BRDF, model(name), roughness, axes()).unwrap_err().to_string()
    };
    assert!(table("mirror", None).contains("delta and has no values"), "{}", table("mirror", None));
    for roughness in [0.0, 9e-4] {
        assert!(table("ggx", Some(roughness)).contains("delta"), "{}", table("ggx", Some(roughness)));
    }
    for evaluator in evaluators() {
        let lobe = |name: &str, roughness| Lobe::new(model(name), roughness, vec![[1.0, 1.0]]).unwrap();
        let refused = Points::new(evaluator, &[lobe("mirror", None)]).err().unwrap().to_string();
        assert!(refused.contains("delta and has no values"), "{refused}");
        let mut ggx = Points::new(evaluator, &[lobe("ggx", Some(0.0))]).unwrap();
        let peak = [Angles { theta_i: 0.5, phi_i: 0.0, theta_e: 0.5, phi_e: PI }];
        let mut values = vec![7.0];
        for refused in [
            ggx.evaluate(&peak, &mut values),
            ggx.sweep(&[0.0], &peak, &mut values),
            ggx.sweep(&[0.1, 9e-7], &peak, &mut values),
        ] {
            let refused = refused.unwrap_err().to_string();
            assert!(refused.contains("delta, without values"), "{refused}");
        }
        assert_eq!(values, [7.0], "and nothing is written");
    }
}
