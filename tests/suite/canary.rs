//! Promises about drivers: what the canary says of one is what shaders find on it, and no table is ever short of what a
//! driver left out of a loop.

use crate::common::*;
use gonio::backend::gpu::{ASKED_TURNS, Baker, Canary, Device};
use gonio::bake::{Evaluator, Unobserved};
use gonio::base::angles::Angles;
use gonio::base::error::Error;
use gonio::base::timings::Timings;
use gonio::check::Check;
use gonio::plan::TablePlan;
use gonio::table::axis::Variable;
use gonio::table::quantity::RHO_DH;
use gonio::table::rule::Rule;
use gonio::verify::user_shader::{UserFunction, UserShader};
use gonio::verify::{self, ParameterRange, Subject, Symmetry, Verdict, VerifyOptions};

fn opened() -> &'static Device {
    let Evaluator::Device(device) = device() else { unreachable!("common::device asserts it") };
    device
}

fn canary() -> Canary {
    let canary = opened().canary().unwrap();
    println!("{canary:?}");
    canary
}

fn shader(body: &str) -> UserShader<'static> {
    let source = format!("fn f(wi: vec3f, wo: vec3f, x: f32, y: f32) -> f32 {{ {body} }}");
    let function = UserFunction::parse("canary.wgsl", source, "f").unwrap();
    let parameters = ["x", "y"].map(|name| ParameterRange::new(name, -1e38, 1e38).unwrap()).to_vec();
    UserShader::new(opened(), function, parameters, false, Symmetry { isotropic: true, bilateral: true })
        .unwrap()
}

/// A shader without parameters to search.
fn narrow(body: &str) -> UserShader<'static> {
    let source = format!("fn f(wi: vec3f, wo: vec3f) -> f32 {{ {body} }}");
    let function = UserFunction::parse("canary.wgsl", source, "f").unwrap();
    let symmetry = Symmetry { isotropic: true, bilateral: true };
    UserShader::new(opened(), function, Vec::new(), false, symmetry).unwrap()
}

/// What a body returns for x and y, alike for every pair of directions.
fn run(body: &str, x: f64, y: f64) -> f64 {
    let mut values = Vec::new();
    let angles = [Angles { theta_i: 0.0, phi_i: 0.0, theta_e: 0.0, phi_e: 0.0 }; 100];
    shader(body).evaluate(&[x, y], &angles, &mut values).unwrap();
    assert!(values.iter().all(|value| value.to_bits() == values[0].to_bits()), "{body}: {values:?}");
    f64::from(values[0])
}

/// The same questions, put by other shaders: a user's, whose every invocation answers.
#[test]
fn shaders_find_what_the_canary_says() {
    let canary = canary();
    let (x, dropped) = (1.0 + 2f64.powi(-12), 2f64.powi(-24));
    let which = |found: f64, no: f64, yes: f64| {
        assert!(found == no || found == yes, "{found:e} is neither {no:e} nor {yes:e}");
        found == yes
    };
    let square = 1.0 + 2f64.powi(-11);
    assert_eq!(which(run("return x * x - y;", x, square), 0.0, dropped), canary.contracts);
    assert_eq!(which(run("return fma(x, x, -y);", x, square), 0.0, dropped), canary.fused_fma);
    let small = 2f64.powi(-30);
    assert_eq!(which(run("return (x + y) - y;", small, 1.0), 0.0, small), canary.reassociates);
    let (x, y) = (2f64.powi(-70), 2f64.powi(-60));
    // Bits, as what flushes a product may flush what is stored, too.
    let denormal = run("return f32(bitcast<u32>(x * y));", x, y);
    let flushed = which(denormal, f64::from((2f64.powi(-130) as f32).to_bits()), 0.0);
    assert!(!flushed || canary.flushes_denormals);
}

/// The turns of a nest are counted as those of one loop: what every driver runs has all its turns, and where a driver stops
/// loops, more are no value.
#[test]
fn nests_of_loops_are_counted() {
    // n counts, and the generator makes sure that nobody counts without turning.
    let counted = "var n = 0u; var h = 1u; for (var i = 0.0; i < x; i += 1.0) { \
                   for (var j = 0.0; j < y; j += 1.0) { h = h * 747796405u + u32(j); n += select(1u, 2u, h == 0u); } } \
                   return f32(n);";
    assert_eq!(run(counted, 60.0, 60.0), 3600.0);
    // 400 × 402 are more than lavapipe 22.3 runs.
    match canary().loop_turns {
        Some(turns) => {
            let (mut subject, mut values) = (shader(counted), Vec::new());
            let angles = [Angles { theta_i: 0.0, phi_i: 0.0, theta_e: 0.0, phi_e: 0.0 }];
            assert!(subject.evaluate(&[400.0, 400.0], &angles, &mut values).is_err());
            assert!(subject.cut_short().unwrap().contains(&turns.to_string()));
        }
        None => assert_eq!(run(counted, 400.0, 400.0), 160_000.0),
    }
}

/// ∫ cos θi dωi/π = 1 by so many azimuths, which one invocation sums.
fn grid(phi: usize) -> TablePlan {
    let plan = TablePlan::basis("fine", &RHO_DH, model("lambert"), None, vec![axis(Variable::ThetaI, 3)]);
    plan.unwrap().with_rule(Rule::Grid { theta: 8, phi }).unwrap()
}

/// Each texel is 1 where all terms are summed; each block of 32 that a driver leaves out is missing from it.
/// Rounding: half an ULP for each of 32 terms of a block, for each block, and for the 8 cells in θ.
fn assert_whole(plan: &TablePlan, terms: usize) {
    let table = bake(device(), plan, Check::Sample(0));
    let rounding = (32.0 + terms as f64 / 32.0 + 8.0) * 2f64.powi(-24);
    for texel in 0..table.texels() {
        let error = (table.texel(texel)[0] - 1.0).abs();
        assert!(error <= rounding, "{terms} terms: off by {error:e}, {rounding:e} is rounding");
    }
}

/// Up to the last turn that the driver runs a table is whole; beyond, it is refused, with the reason and the remedy.
#[test]
fn a_table_is_whole_or_refused() {
    let most = canary().known_turns() as usize;
    // A sum of n terms takes n (1 + 2/32) + 1 turns. These azimuths are few, as many as every driver runs, and as many
    // as any grid has; half of them are kept.
    for phi in [1024, 60_000, 65_536] {
        assert_whole(&grid(phi), phi / 2);
    }
    // The outer sum of ρ_dh is over θ.
    for theta in [30_000_usize, 61_000, 65_536] {
        let turns = theta + 2 * theta.div_ceil(32) + 1;
        let plan = grid(2).with_rule(Rule::Grid { theta, phi: 2 }).unwrap();
        if turns <= most {
            assert_whole(&plan, theta);
            continue;
        }
        let refused = device().bake(&plan, Check::Sample(0), &mut Timings::default(), &Unobserved);
        let Err(Error::Device(why)) = refused else { panic!("{theta} in θ: {turns} turns, {most} known") };
        for words in ["\"fine\"", &turns.to_string(), &most.to_string(), "coarser"] {
            assert!(why.contains(words), "{words} in {why}");
        }
    }
    assert!(most > 64_000 && most <= ASKED_TURNS as usize, "{most}");
}

/// On the caller's device nobody asks the driver: what every driver runs holds.
#[test]
fn an_embedded_baker_keeps_to_what_every_driver_runs() {
    let (device, queue) = opened().wgpu();
    let baker = Baker::new(device, queue);
    assert!(baker.prepare(&grid(60_000)).is_ok());
    let why = baker.prepare(&grid(65_536)).err().unwrap().to_string();
    assert!(why.contains("34817 turns") && why.contains("only 32000 are known"), "{why}");
}

/// A user's loops cannot be counted beforehand. They count themselves: where a driver may have stopped them, nothing is
/// said to be kept.
#[test]
fn a_shader_whose_loops_are_stopped_is_not_checked() {
    let verdicts = |turns: u32| {
        let body =
            format!("var f = 0.0; for (var k = 0u; k < {turns}u; k++) {{ f += 0.1 / {turns}.0; }} return f;");
        let options = VerifyOptions { budget: 1000, ..VerifyOptions::default() };
        let mut subject = narrow(&body);
        let report = verify::check(&mut subject, &options, &Unobserved).unwrap();
        report.findings.iter().map(|finding| finding.verdict).collect::<Vec<_>>()
    };
    assert!(verdicts(100).iter().all(|&verdict| verdict == Verdict::Kept));
    let stopped = if canary().loop_turns.is_some() { Verdict::Unchecked } else { Verdict::Kept };
    assert_eq!(verdicts(100_000), [stopped; 6]);
}

/// What no compiler nests or inlines is refused before a compiler sees it, in no time.
#[test]
fn a_shader_that_no_driver_compiles_is_refused() {
    let parse = |source: String| UserFunction::parse("large.wgsl", source, "brdf").unwrap_err().to_string();
    let body = |value: String| format!("fn brdf(wi: vec3f, wo: vec3f) -> f32 {{ return {value}; }}");
    let sum = parse(body(vec!["wi.z"; 100_000].join(" + ")));
    assert!(sum.starts_with("large.wgsl: an expression nests 199999 operators"), "{sum}");
    let mut calls = String::from("fn tree0(x: f32) -> f32 { return x; }\n");
    for k in 0..40 {
        calls += &format!("fn tree{}(x: f32) -> f32 {{ return tree{k}(x) + tree{k}(x + 1.0); }}\n", k + 1);
    }
    let calls = parse(calls + &body("tree40(wi.z)".into()));
    assert!(calls.contains("fn brdf has ") && calls.contains("operations"), "{calls}");
    let branches =
        parse(body(String::from("0.0; ") + &"if wi.z > 0.5 { } else ".repeat(5000) + "{ } return 0.0"));
    assert!(branches.contains("5000 branches"), "{branches}");
    // Deeper than the stack of this thread would hold.
    let deep = body(vec!["wi.z"; 30_000].join(" + "));
    assert!(UserFunction::parse("deep.wgsl", deep, "brdf").is_ok());
}

#[cfg(feature = "cli")]
mod command {
    use super::*;
    use serde_json::{Value, json};
    use std::process::{Command, Output};

    fn gonio(arguments: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_gonio")).args(arguments).output().unwrap()
    }

    /// `gonio devices` shows the canary of each, in JSON and for people.
    #[test]
    fn devices_says_what_a_driver_does() {
        let found: Value = serde_json::from_slice(&gonio(&["devices", "--json"]).stdout).unwrap();
        assert_eq!(found[0]["canary"], json!(canary()));
        assert!(found.as_array().unwrap().last().unwrap().get("canary").is_none(), "the CPU has none");
        let text = String::from_utf8(gonio(&["devices"]).stdout).unwrap();
        let loops = match canary().loop_turns {
            Some(turns) => format!("stops loops after {turns} turns"),
            None => format!("runs loops of {ASKED_TURNS} turns"),
        };
        assert!(text.contains(&loops) && text.contains("a·b + c"), "{text}");
    }

    /// What a driver would cut short is refused as the device's fault, and the CPU path bakes it.
    #[test]
    fn a_bake_beyond_the_driver_fails_and_says_why() {
        let dir = tempfile::tempdir().unwrap();
        let recipe = dir.path().join("fine.toml");
        let table =
            "[[tables]]\nquantity = 'rho_dh'\nmodel = 'lambert'\naxes = { theta_i = 3 }\ngrid = [65536, 2]\n";
        std::fs::write(&recipe, table).unwrap();
        let (recipe, out) = (recipe.to_str().unwrap(), dir.path().join("out"));
        let run = |device| gonio(&["bake", recipe, "--out", out.to_str().unwrap(), "--device", device]);
        let baked = run("auto");
        let said = String::from_utf8_lossy(&baked.stderr);
        match canary().loop_turns {
            Some(_) => assert!(baked.status.code() == Some(3) && said.contains("69633 turns"), "{said}"),
            None => assert_eq!(baked.status.code(), Some(0), "{said}"),
        }
        assert_eq!(run("cpu").status.code(), Some(0));
    }
}
