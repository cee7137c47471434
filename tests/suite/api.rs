//! The library's types cannot be wrong: what a recipe would refuse, the API refuses when the value is made, with a remedy.

use crate::common::model;
use gonio::backend::gpu::Device;
use gonio::bake::points::Points;
use gonio::bake::{Evaluator, Unobserved};
use gonio::base::angles::Angles;
use gonio::base::timings::Timings;
use gonio::base::tolerance::Tolerance;
use gonio::check::Check;
use gonio::model::lobe::Lobe;
use gonio::model::{Integral, Model, Roughness};
use gonio::plan::TablePlan;
use gonio::shader::register;
use gonio::table::axis::{Axis, Variable};
use gonio::table::quantity::{BRDF, RHO_DH, SPLIT_SUM};

fn theta_i() -> Axis {
    Axis::natural(Variable::ThetaI, 8).unwrap()
}

fn rho_dh() -> TablePlan {
    TablePlan::basis("t", &RHO_DH, model("ggx"), Some(0.5), vec![theta_i()]).unwrap()
}

/// The message of an input error, which names the remedy.
fn refused<T>(result: gonio::Result<T>, remedy: &str) -> String {
    match result {
        Err(gonio::Error::Input(why)) => {
            assert!(why.contains(remedy), "no remedy \"{remedy}\" in: {why}");
            why
        }
        Err(other) => panic!("not an input error: {other}"),
        Ok(_) => panic!("taken, where \"{remedy}\" is the remedy"),
    }
}

#[test]
fn a_tolerance_is_a_number_above_0() {
    for tolerance in [f64::NAN, f64::INFINITY, 0.0, -1e-4] {
        let why = refused(rho_dh().with_tolerance(tolerance), "give a number above 0");
        assert!(why.contains("table \"t\""), "{why}");
        refused(Tolerance::new(tolerance), "give a number above 0");
    }
    assert_eq!(rho_dh().with_tolerance(1e-6).unwrap().tolerance(), 1e-6);
}

/// What `axes.clear()` and `axes.pop()` did to a checked plan.
#[test]
fn a_plan_has_the_axes_of_its_quantity() {
    refused(rho_dh().with_axes(Vec::new()), "runs over (theta_i)");
    let brdf = [Variable::ThetaI, Variable::ThetaE, Variable::DeltaPhi];
    let mut axes: Vec<_> = brdf.map(|variable| Axis::natural(variable, 4).unwrap()).to_vec();
    let plan = TablePlan::basis("t", &BRDF, model("ggx"), Some(0.5), axes.clone()).unwrap();
    axes.pop();
    refused(plan.with_axes(axes), "runs over (theta_i, theta_e, delta_phi)");
}

/// What `lobes.clear()` did: a table of zeros.
#[test]
fn a_plan_has_a_lobe_and_weights_for_each_channel() {
    refused(rho_dh().with_lobes(Vec::new()), "give one or more");
    let gray = Lobe::new(model("ggx"), Some(0.5), vec![[1.0, 1.0]]).unwrap();
    refused(rho_dh().with_lobes(vec![gray]), "one pair of weights for each channel");
    refused(Lobe::new(model("ggx"), Some(0.5), vec![[f64::NAN, 1.0]]), "give a finite number");
    let many = vec![String::from("x"); 4];
    let lobe = Lobe::new(model("ggx"), Some(0.5), vec![[1.0, 1.0]; 4]).unwrap();
    refused(TablePlan::new("t", &RHO_DH, "s", many, vec![lobe], vec![theta_i()]), "give 1 to 3");
}

/// Roughness 7, −0.5 and NaN were baked and "verified".
#[test]
fn a_roughness_is_from_0_to_1() {
    for roughness in [7.0, -0.5, f64::NAN, f64::INFINITY, 1.0 + f64::EPSILON] {
        refused(Roughness::new(roughness), "give one in [0, 1]");
        let why = refused(Lobe::new(model("ggx"), Some(roughness), vec![[1.0, 1.0]]), "give one in [0, 1]");
        assert!(why.contains("ggx"), "{why}");
        let axes = vec![theta_i()];
        refused(TablePlan::basis("t", &RHO_DH, model("ggx"), Some(roughness), axes), "give one in [0, 1]");
        let mut lobe = Lobe::new(model("ggx"), None, vec![[1.0, 1.0]]).unwrap();
        refused(lobe.set("roughness", roughness), "outside [0, 1]");
    }
}

/// A missing roughness made a mirror.
#[test]
fn a_missing_roughness_is_said() {
    let lobe = Lobe::new(model("ggx"), None, vec![[1.0, 1.0]]).unwrap();
    refused(lobe.setting_at(None), "give a value or an axis");
    assert!(!lobe.is_delta());
    let mu = Axis::natural(Variable::Mu, 4).unwrap();
    refused(TablePlan::basis("t", &SPLIT_SUM, model("ggx"), None, vec![mu]), "give a value or an axis");
    let mut points = Points::new(&Evaluator::Cpu, &[lobe]).unwrap();
    let pair = Angles { theta_i: 0.1, phi_i: 0.0, theta_e: 0.2, phi_e: 3.0 };
    refused(points.evaluate(&[pair], &mut Vec::new()), "needs a roughness");
}

/// Names of parameters work as in recipes: `alpha`, `sigma`, `eta`, …
#[test]
fn parameters_go_by_their_names() {
    let mut lobe = Lobe::new(model("ggx"), None, vec![[1.0, 1.0]]).unwrap();
    lobe.set("alpha", 0.25).unwrap();
    assert_eq!(lobe.roughness(), Some(0.5));
    refused(lobe.set("alpha", 1.5), "outside [0, 1]");
    refused(lobe.set("sigma", 0.1), "ggx has no parameter \"sigma\"");
    let mut rough = Lobe::new(model("oren-nayar"), None, vec![[1.0, 0.0]]).unwrap();
    rough.set("sigma", std::f64::consts::FRAC_PI_2).unwrap();
    assert_eq!(rough.roughness(), Some(1.0));
}

/// A model of an embedder's own is checked when it is registered.
#[test]
fn a_model_is_built_and_not_written() {
    let whole = || {
        Model::builder("api-test")
            .describe("Lambert's law again", "Lambert 1760")
            .component("albedo", Some(1.0))
            .shader(
                "api/test",
                "fn lobe(p: Pair, a: Azimuth, alpha: real, row: real) -> real2 { return real2(INV_PI, 0.0); }
                 fn lobe_row(p: Pair, alpha: real) -> real { return 0.0; }",
            )
            .twin(|_, _, _| [std::f64::consts::FRAC_1_PI, 0.0])
            .integral(Integral::Smooth(|_| [16, 2]))
            .rho_bound(1.0)
    };
    refused(register(Model::builder("api-test")), "give both");
    refused(register(Model::builder("No Word")), "lower-case letters");
    refused(register(whole().component("b", None).component("c", None)), "give one or two");
    refused(register(whole().rho_bound(f64::NAN)), "give a number above 0");
    refused(register(whole().parameter("x", "", "", [1.0, 0.0], None)), "no interval");
    refused(register(whole().parameter("x", "", "", [0.0, 1.0], Some(2.0))), "outside [0, 1]");
    let model = register(whole()).unwrap();
    refused(register(whole()), "give yours another name");
    let plan = TablePlan::basis("t", &RHO_DH, model, None, vec![theta_i()]).unwrap();
    let table = Evaluator::Cpu.bake(&plan, Check::Sample(0), &mut Timings::default(), &Unobserved).unwrap();
    assert!(table.values.iter().all(|rho| (rho - 1.0).abs() < 1e-4), "{:?}", table.values);
}

/// An engine's own device bakes, evaluates points and keeps its handlers: what gonio causes comes back as an error.
#[test]
fn an_engines_device_does_what_ours_does() {
    let Some((device, queue)) = crate::common::engine(gonio::wgpu::Limits::default()) else {
        panic!("no device to test on. {}", gonio::backend::gpu::INSTALL)
    };
    let foreign = Evaluator::Device(Box::new(Device::from_wgpu(&device, &queue)));
    let bake = |evaluator: &Evaluator, plan: &TablePlan| {
        evaluator.bake(plan, Check::Sample(16), &mut Timings::default(), &Unobserved).unwrap()
    };
    let ours = crate::common::device();
    let axes = vec![Axis::natural(Variable::Roughness, 8).unwrap(), Axis::natural(Variable::Mu, 8).unwrap()];
    let plan = TablePlan::basis("dfg", &SPLIT_SUM, model("ggx"), None, axes).unwrap();
    assert_eq!(bake(&foreign, &plan).values, bake(ours, &plan).values);

    let lobe = Lobe::new(model("ggx"), Some(0.3), vec![[1.0, 1.0]]).unwrap();
    let pairs = [Angles { theta_i: 0.5, phi_i: 0.0, theta_e: 0.4, phi_e: 3.0 }];
    let values = |evaluator| {
        let mut values = Vec::new();
        Points::new(evaluator, std::slice::from_ref(&lobe)).unwrap().evaluate(&pairs, &mut values).unwrap();
        values
    };
    assert_eq!(values(&foreign), values(ours));

    // A lost device is an error, and no panic.
    device.destroy();
    let failed = foreign.bake(&plan, Check::Sample(0), &mut Timings::default(), &Unobserved);
    assert!(matches!(failed, Err(gonio::Error::Device(_))), "{failed:?}");
}

/// Radiance and irradiance are finite and not negative, directions are unit vectors.
#[test]
fn a_light_that_is_none_cannot_be_built() {
    use gonio::light::{Directional, Disk, Radiance, Sky};
    const UP: [f64; 3] = [0.0, 0.0, 1.0];
    const WHITE: [f64; 3] = [1.0; 3];
    for wrong in [[-1.0, 0.0, 0.0], [0.0, f64::NAN, 0.0], [0.0, 0.0, f64::INFINITY]] {
        refused(Radiance::new(wrong), "give finite numbers from 0 up");
        refused(Directional::new(UP, wrong), "give finite numbers from 0 up");
        refused(Disk::new(UP, 0.1, wrong), "give finite numbers from 0 up");
        refused(Sky::new(wrong, WHITE, WHITE), "give finite numbers from 0 up");
        refused(Sky::new(WHITE, wrong, WHITE), "give finite numbers from 0 up");
        refused(Sky::new(WHITE, WHITE, wrong), "give finite numbers from 0 up");
    }
    for wrong in [[0.0; 3], [0.0, 0.0, 2.0], [f64::NAN, 0.0, 1.0]] {
        refused(Directional::new(wrong, WHITE), "give a unit vector");
        refused(Disk::new(wrong, 0.1, WHITE), "give a unit vector");
    }
    for wrong in [0.0, -0.1, 2.0, f64::NAN] {
        refused(Disk::new(UP, wrong, WHITE), "outside (0, π/2]");
    }
    assert_eq!(Disk::new(UP, 0.1, WHITE).unwrap().radius(), 0.1);
    assert_eq!(Sky::new(WHITE, [0.5; 3], [0.0; 3]).unwrap().horizon(), [0.5; 3]);
}
