//! Promises of the other methods and of `gonio trade`: each converges to the reference at its rate, on the
//! device as on the CPU path, and the measurement says what it did.

use crate::common::*;
use gonio::bake::{Evaluator, Unobserved};
use gonio::base::precision::Precision;
use gonio::lab::trade::{Cost, TradeOptions, costs, measure};
use gonio::plan::TablePlan;
use gonio::shader::{Kernel, compose, validate};
use gonio::table::axis::{Axis, Mapping, Positions, Variable};
use gonio::table::quantity::{RHO_DH, RHO_HH, SPLIT_SUM};
use gonio::table::rule::Rule;
use gonio::table::storage::Storage;
use std::process::Command;

fn rough(count: usize, mus: usize) -> TablePlan {
    let range =
        |variable, count| Axis::new(variable, count, [0.5, 1.0], Positions::Nodes, Mapping::Linear).unwrap();
    let axes = vec![range(Variable::Roughness, count), range(Variable::Mu, mus)];
    TablePlan::basis("dfg", &SPLIT_SUM, model("ggx"), None, axes).unwrap()
}

fn rules(n: usize) -> [Rule; 3] {
    [Rule::Hammersley { samples: n }, Rule::Vndf { samples: n }, Rule::Random { samples: n }]
}

/// The largest and the root mean square difference to the reference.
fn errors(evaluator: &Evaluator, plan: &TablePlan, rule: Rule) -> [f64; 2] {
    let table = bake(evaluator, &plan.clone().with_rule(rule).unwrap(), gonio::check::Check::All);
    [table.error.measured_max.unwrap(), table.error.measured_rms.unwrap()]
}

/// Random sampling converges as N^−½: 64 times the samples are 8 times as good in rms. Over 6 × 7 texels of
/// 2 channels that rms is itself known to about 15 %, so a factor of 5 to 12 holds it at several of its
/// deviations. Hammersley's points do better on smooth integrands, up to N⁻¹: 5 to 100.
#[test]
fn sampling_converges_at_its_rate() {
    let plan = rough(6, 7);
    for (few, many) in rules(128).into_iter().zip(rules(8192)) {
        let gain = errors(device(), &plan, few)[1] / errors(device(), &plan, many)[1];
        println!("{few}: {gain:.1}");
        let most = if matches!(few, Rule::Random { .. }) { 12.0 } else { 100.0 };
        assert!(gain > 5.0 && gain < most, "{few}: {gain}");
    }
}

/// No weight of VNDF sampling exceeds 1 (F G2/G1), so its variance is below ¼ and the error at N random
/// samples below 5 · ½ N^−½ in five deviations.
#[test]
fn random_sampling_is_as_good_as_its_variance() {
    let [max, _] = errors(device(), &rough(6, 7), Rule::Random { samples: 4096 });
    assert!(max < 2.5 / 64.0 && max > 1e-4, "{max}");
}

/// Gauss–Legendre over angles converges geometrically once it sees the lobe, to f32 sums (5e-7, as the warped
/// rule's); at α ≥ ¼ and away from grazing 128 nodes in θ do.
#[test]
fn gauss_converges_to_rounding() {
    let error = |theta| errors(device(), &rough(4, 5), Rule::Gauss { theta, phi: 2 * theta })[0];
    let (coarse, fine) = (error(8), error(128));
    println!("{coarse:e} {fine:e}");
    assert!(fine <= 1e-6 && coarse > 1e3 * fine, "{coarse:e} {fine:e}");
}

/// The device does in f32 what the CPU path does in f64, draw by draw: the sum's blocks keep 1e-6, and a
/// sample that falls across the horizon counts next to nothing there. Random numbers are the same integers;
/// rounded to f32 near 0 and 1 and through the cosine's series they differ by 1e-7.
#[test]
fn the_device_and_the_cpu_agree() {
    let axes =
        vec![listed(Variable::Roughness, &EXTREME_ROUGHNESS), listed(Variable::Mu, &[1e-4, 0.03, 0.4, 1.0])];
    let plan = TablePlan::basis("dfg", &SPLIT_SUM, model("ggx"), None, axes).unwrap();
    for rule in rules(2048) {
        let plan = plan.clone().with_rule(rule).unwrap();
        let [a, b] = evaluators()
            .map(|e| bake(e, &plan.clone().with_tolerance(1.0).unwrap(), gonio::check::Check::Sample(0)));
        for (texel, (x, y)) in a.values.iter().zip(b.values.iter()).enumerate() {
            assert!((x - y).abs() < 2e-5, "{rule}: {x} and {y} at {}", a.coordinates(texel / 2));
        }
    }
}

/// ρ_hh sums directions and chunks of samples at once, and α = 0 is the mirror by every sampler.
#[test]
fn means_and_mirrors_are_sampled_too() {
    let axes = vec![listed(Variable::Roughness, &[0.0, 0.5, 1.0])];
    let plan = TablePlan::basis("mean", &RHO_HH, model("ggx"), None, axes).unwrap();
    for evaluator in evaluators() {
        for rule in rules(2048) {
            let table = bake(evaluator, &plan.clone().with_rule(rule).unwrap(), gonio::check::Check::All);
            // 5 · ½ N^−½ as above for one direction; the mean of 40 is better.
            assert!(table.error.measured_max.unwrap() < 0.055, "{rule}: {:?}", table.error);
            let ggx = reference_model("ggx");
            let mirror = ggx.rho_hh(&with_alpha(ggx, 0.0));
            assert!((table.values.get(0) - mirror[0]).abs() < 1e-6, "{rule}: {:?}", table.values);
        }
    }
}

#[test]
fn what_a_rule_cannot_do_is_refused() {
    let theta = || vec![axis(Variable::ThetaI, 4)];
    let lambert = TablePlan::basis("t", &RHO_DH, model("lambert"), None, theta()).unwrap();
    let mirror = TablePlan::basis("t", &RHO_DH, model("mirror"), None, theta()).unwrap();
    let refusal = |plan: &TablePlan, rule| plan.clone().with_rule(rule).unwrap_err().to_string();
    for rule in rules(64) {
        assert!(refusal(&lambert, rule).contains("no microfacet lobe"));
        assert!(refusal(&mirror, rule).contains("a delta"));
    }
    assert!(lambert.clone().with_rule(Rule::Gauss { theta: 8, phi: 16 }).is_ok());
    for samples in [0, 1500, 1 << 23] {
        let why = refusal(&rough(2, 2), Rule::Vndf { samples });
        assert!(why.contains("a multiple"), "{why}");
    }
    assert!(refusal(&rough(2, 2), Rule::Gauss { theta: 5000, phi: 8 }).contains("1 to 4096"));
}

#[test]
fn every_shader_is_portable() {
    for kernel in [Kernel::Ndf, Kernel::Vndf, Kernel::Random] {
        validate(&compose(kernel, Some(model("ggx")), 0, Precision::F32), Precision::F32).unwrap();
    }
    for kernel in [Kernel::Fill, Kernel::MultiplyAdd] {
        validate(&compose(kernel, None, 0, Precision::F32), Precision::F32).unwrap();
    }
}

/// Times apart, two measurements are the same; and the budget decides what is whole.
#[test]
fn a_measurement_repeats_but_for_its_times() {
    let options = TradeOptions { budget: 0.05, check_all: false };
    let plan = rough(8, 8);
    let of = || {
        let trade = measure(&plan, device(), &options, &Unobserved).unwrap();
        let points = trade.points.iter();
        points
            .map(|p| (p.method, p.setting.clone(), p.texels, p.evaluations, p.max_error, p.storage))
            .collect::<Vec<_>>()
    };
    let points = of();
    assert_eq!(points, of());
    for method in ["warped", "gauss", "grid", "hammersley", "vndf", "random"] {
        assert!(points.iter().any(|p| p.0 == method), "{method}");
    }
    let warped = |storages: &[Storage]| -> Vec<_> {
        points.iter().filter(|p| p.0 == "warped" && storages.contains(&p.5)).collect()
    };
    for storages in [&[Storage::F32, Storage::F64][..], &[Storage::F16], &[Storage::Unorm16]] {
        let warped = warped(storages);
        assert!(warped.windows(2).all(|w| w[0].3 <= w[1].3), "tighter costs more: {warped:?}");
    }
    let warped = warped(&[Storage::F32, Storage::F64]);
    assert!(warped.len() >= 6);
    // Tolerances as asked, 1e-7 excepted, which f32 does not reach.
    assert!(warped.iter().take(6).all(|p| p.4 <= p.1.parse().unwrap()), "{warped:?}");
}

/// Narrow storage halves the bytes, keeps the tolerance that it was asked with and is told by its rounding: where the rule
/// is much finer than that, the error is of its size. A format that rounds by more than a tolerance is no way to it.
#[test]
fn storage_is_a_dimension() {
    let options = TradeOptions { budget: 0.05, check_all: true };
    let trade = measure(&rough(8, 8), device(), &options, &Unobserved).unwrap();
    let values = 8 * 8 * 2;
    let find = |setting: &str, storage| {
        trade.points.iter().find(|p| p.method == "warped" && p.setting == setting && p.storage == storage)
    };
    for (storage, rounding, finest) in [(Storage::F16, 1.0 / 4096.0, 3), (Storage::Unorm16, 0.5 / 65535.0, 5)]
    {
        for decade in 1..=9 {
            let setting = format!("1e-{decade}");
            let Some(point) = find(&setting, storage) else {
                assert!(decade > finest, "{setting} as {}", storage.name());
                continue;
            };
            let tolerance = 10f64.powi(-decade);
            assert!(decade <= finest && point.max_error <= tolerance, "{point:?}");
            assert_eq!((point.bytes, point.precision), (2 * values, "f32"));
            let computed = find(&setting, Storage::F32).unwrap();
            assert!(computed.bytes == 4 * values && computed.evaluations <= point.evaluations, "{point:?}");
            // The rule may be off by a tenth of the tolerance, and f32 by 1e-6. Of 64 values of A, which lie anywhere
            // between two neighbours, some are rounded by three quarters of the most: less than half takes no rounding.
            if decade == finest {
                let range = 0.5 * rounding..rounding + 0.1 * tolerance + 1e-6;
                assert!(range.contains(&point.max_error), "{point:?}");
            }
        }
    }
    let stored =
        |p: &&gonio::lab::trade::Point| p.storage.bytes() == if p.precision == "f64" { 8 } else { 4 };
    let whole = trade.points.iter().filter(stored).count();
    assert_eq!(trade.points.len(), whole + 3 + 5);
    assert!(trade.points.iter().all(|p| stored(&p) || p.method == "warped" && !p.on_front));
}

/// What a format does not hold is left out with the reason, and not clamped: Burley's lobe reflects more than 1.
#[test]
fn storage_that_does_not_fit_is_left_out() {
    let axes = vec![axis(Variable::Roughness, 6), axis(Variable::ThetaI, 6)];
    let plan = TablePlan::basis("t", &RHO_DH, model("burley"), None, axes).unwrap();
    let trade =
        measure(&plan, device(), &TradeOptions { budget: 0.05, check_all: true }, &Unobserved).unwrap();
    let refused = |what: &&String| what.contains("as unorm16") && what.contains("outside [0, 1]");
    assert_eq!(trade.left_out.iter().filter(refused).count(), 5, "{:?}", trade.left_out);
    assert!(trade.points.iter().all(|p| p.storage != Storage::Unorm16));
    assert!(trade.points.iter().any(|p| p.storage == Storage::F16));
}

#[test]
fn the_command_writes_its_three_files() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("new");
    let run = |more: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_gonio"));
        command
            .args(["trade", "--size", "8", "--budget", "0.05s", "--out"])
            .arg(&out)
            .args(more)
            .output()
            .unwrap()
    };
    let output = run(&["--json", "--check", "all"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let file = std::fs::read_to_string(out.join("trade.json")).unwrap();
    assert_eq!(json, serde_json::from_str::<serde_json::Value>(&file).unwrap());
    let points = json["trade"]["points"].as_array().unwrap();
    let csv = std::fs::read_to_string(out.join("trade.csv")).unwrap();
    assert_eq!(csv.lines().count(), points.len() + 1);
    let columns = csv.lines().next().unwrap().split(',').count();
    assert!(csv.lines().all(|line| line.split(',').count() == columns));
    let picture = image::open(out.join("trade.png")).unwrap();
    assert!(picture.width() >= 800);
    let mut names: Vec<_> = std::fs::read_dir(&out).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["trade.csv", "trade.json", "trade.png"]);

    // The front by its definition: who is not on it is beaten by somebody. Who trades exactness for bytes is no part
    // of it.
    let whole = |p: &serde_json::Value| p["storage"] == "f32" || p["storage"] == "f64";
    assert!(points.iter().all(|p| whole(p) || p["on_front"] == false));
    let points: Vec<_> = points.iter().filter(|p| whole(p)).collect();
    let number = |p: &serde_json::Value, key: &str| p[key].as_f64().unwrap();
    let beaten = |p: &serde_json::Value| {
        points.iter().filter(|q| q["extrapolated"] == false).any(|q| {
            let (t, e) = ("table_seconds", "max_error");
            number(q, t) <= number(p, t)
                && number(q, e) <= number(p, e)
                && (number(q, t) < number(p, t) || number(q, e) < number(p, e))
        })
    };
    assert!(points.iter().any(|p| p["on_front"] == true) && points.iter().any(|p| p["on_front"] == false));
    for p in points.iter().filter(|p| p["extrapolated"] == false) {
        assert_eq!(p["on_front"] == true, !beaten(p), "{p}");
    }
    assert!(points.iter().filter(|p| p["extrapolated"] == true).all(|p| p["on_front"] == false));

    for (bad, words) in [(["--budget", "soon"], "60s"), (["--quantity", "brdf"], "no methods to compare")] {
        let output = Command::new(env!("CARGO_BIN_EXE_gonio"))
            .args(["trade", "--size", "4", "--out"])
            .arg(&out)
            .args(bad)
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2));
        assert!(String::from_utf8_lossy(&output.stderr).contains(words), "{bad:?}");
    }
}

/// What tolerances cost is measured: each is met by what was counted, a finer one takes no less and a much finer one more,
/// and what has no integrals has no costs.
#[test]
fn what_tolerances_cost_is_measured() {
    let tolerances = [1e-2, 1e-4, 1e-6];
    for name in ["lambert", "oren-nayar", "ggx", "phong", "mirror"] {
        let costs = costs(device(), model(name), &tolerances, &Unobserved).unwrap();
        assert_eq!(costs.len(), 6);
        for of_quantity in costs.chunks(3) {
            for cost in of_quantity {
                assert!(
                    cost.error <= cost.tolerance
                        && cost.is_met()
                        && cost.texels >= 1
                        && cost.evaluations >= 1,
                    "{cost:?}"
                );
            }
            assert!(of_quantity.is_sorted_by_key(|cost| cost.evaluations), "{of_quantity:?}");
        }
        if ["ggx", "phong"].contains(&name) {
            assert!(costs[2].evaluations > 2 * costs[0].evaluations, "{costs:?}");
            // By the nodes of the coarsest the finest is not met: the errors are no constants.
            assert!(costs[0].error > tolerances[2], "{costs:?}");
        }
        assert!(!Cost { error: f64::NAN, ..costs[0].clone() }.is_met());
        assert!(!Cost { error: 2.0 * costs[0].tolerance, ..costs[0].clone() }.is_met());
    }
    assert!(costs(device(), model("ward"), &tolerances, &Unobserved).unwrap().is_empty());
}

/// The command says the same to people and machines, and refuses tolerances without `--costs`.
#[test]
fn the_command_prints_what_tolerances_cost() {
    let gonio =
        |arguments: &[&str]| Command::new(env!("CARGO_BIN_EXE_gonio")).args(arguments).output().unwrap();
    let output =
        gonio(&["models", "lambert", "--costs", "--tolerance", "1e-3", "1e-5", "--json", "--device", "cpu"]);
    assert!(output.status.success(), "{output:?}");
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let costs = json["costs"].as_array().unwrap();
    assert_eq!(costs.len(), 4);
    assert_eq!(json["device"]["name"], "cpu");
    assert!(costs.iter().all(|cost| cost["error"].as_f64().unwrap() <= cost["tolerance"].as_f64().unwrap()));
    let output = gonio(&["models", "lambert", "--tolerance", "1e-3"]);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
}
