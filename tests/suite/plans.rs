//! Promises of the plan: only what the scene requires, in tables and in shaders; and it is plain data,
//! made and compared without a device.

use crate::common::model;
use gonio::base::precision::Precision;
use gonio::model::MODELS;
use gonio::model::compensation::Compensation;
use gonio::plan::TablePlan;
use gonio::scene::planner::{Plan, Selection};
use gonio::scene::{Distribution, Material, MaterialLobe, Scene, Weights};
use gonio::shader::{Kernel, compose, validate};
use gonio::table::axis::{Axis, Mapping, Positions, Variable};
use gonio::table::quantity::{BRDF, RHO_DH, SPLIT_SUM};
use gonio::table::rule::Rule;

fn material(name: &str, model: &str, roughness: Option<Distribution>) -> Material {
    let lobe = MaterialLobe {
        model: model.into(),
        roughness,
        parameters: Vec::new(),
        weights: Weights::Constant([[0.5; 3], [0.0; 3]]),
        compensation: Compensation::None,
        factors: Vec::new(),
    };
    Material { name: name.into(), lobes: vec![lobe], metallic: None, base_color: None }
}

fn scene(materials: Vec<Material>) -> Scene {
    Scene { file: "test.gltf".into(), materials, ..Scene::default() }
}

fn plan(materials: Vec<Material>) -> Plan {
    Plan::new(&scene(materials), &Selection::default()).unwrap()
}

const MICROFACET: [&str; 4] = ["fn ndf(", "fn ndf_map(", "fn visibility(", "fn slope_term("];

#[test]
fn a_lambert_scene_bakes_and_composes_no_microfacet_code() {
    let plan = plan(vec![material("wall", "lambert", None)]);
    for table in &plan.tables {
        assert!(table.lobes().iter().all(|lobe| lobe.model() == model("lambert")), "{table}");
    }
    for kernel in [Kernel::Values, Kernel::Product] {
        let source = compose(kernel, Some(model("lambert")), 1, Precision::F32);
        assert!(MICROFACET.iter().all(|function| !source.contains(function)));
        assert!(!source.contains("fn fresnel("));
    }
    let why = |what: &str| plan.left_out.iter().find(|l| l.what == what).map(|l| l.why.as_str());
    assert_eq!(why("ggx"), Some("nothing in the scene uses it"));
}

#[test]
fn a_module_holds_one_kernel_and_its_model() {
    let ggx = compose(Kernel::Slopes, Some(model("ggx")), 2, Precision::F32);
    assert!(MICROFACET.iter().all(|function| ggx.contains(function)));
    for kernel in [Kernel::Values, Kernel::Slopes, Kernel::Product, Kernel::Sum] {
        let source = compose(kernel, (kernel != Kernel::Sum).then(|| model("ggx")), 3, Precision::F32);
        assert_eq!(source.matches("@compute").count(), 1, "{kernel:?}");
    }
    assert!(!compose(Kernel::Sum, None, 2, Precision::F32).contains("fn lobe("));
    assert!(!compose(Kernel::Analytic, Some(model("mirror")), 0, Precision::F32).contains("fn ndf("));
}

/// For every WebGPU device: no optional capability, but for stores by words of 64 bits, of which there is another way.
#[test]
fn every_shader_is_portable() {
    for model in MODELS {
        let kernels: &[Kernel] = match model.name {
            "ggx" => {
                &[Kernel::Values, Kernel::AddValues, Kernel::Product, Kernel::Slopes, Kernel::FineSlopes]
            }
            "mirror" => &[Kernel::Product, Kernel::Analytic],
            _ => &[Kernel::Values, Kernel::AddValues, Kernel::Product],
        };
        for &kernel in kernels {
            for channels in 1..=3 {
                for precision in [Precision::F32, Precision::F64] {
                    validate(&compose(kernel, Some(model), channels, precision), precision).unwrap();
                }
            }
        }
    }
    validate(&compose(Kernel::Sum, None, 2, Precision::F32), Precision::F32).unwrap();
    validate(&compose(Kernel::Pack, None, 0, Precision::F32), Precision::F32).unwrap();
    assert!(validate("fn main() { let x = 1u + 1.0f; }", Precision::F32).is_err(), "the gate can fail");
}

#[test]
fn tables_span_the_roughness_that_occurs() {
    let textured = Distribution::weighted((0..=30).map(|k| (0.3 + 0.01 * k as f64, 1.0))).unwrap();
    let (min, max) = (textured.min(), textured.max());
    let plan = plan(vec![material("brushed", "ggx", Some(textured))]);
    for table in &plan.tables {
        let Some(axis) = table.axis(Variable::Roughness) else { panic!("{table}") };
        assert_eq!((axis.values()[0], axis.values()[axis.len() - 1]), (min, max), "{table}");
    }
    let values = plan.tables.iter().find(|t| t.quantity() == &BRDF).unwrap();
    // Ends and quartiles of 31 equal steps.
    let quartiles = &values.axis(Variable::Roughness).unwrap().values();
    let expected = [0.3, 0.37, 0.45, 0.53, 0.6];
    assert_eq!(quartiles.len(), 5);
    assert!(quartiles.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{quartiles:?}");
    let why: Vec<_> = plan.left_out.iter().filter(|l| l.what.contains("brushed")).collect();
    assert!(why[0].why.contains("roughness varies"), "{why:?}");
}

#[test]
fn constant_materials_get_rgb_tables_too() {
    let plan = plan(vec![material("gold", "ggx", Some(Distribution::constant(0.3)))]);
    let names: Vec<_> = plan.tables.iter().map(|t| t.name()).collect();
    assert_eq!(names, ["ggx.brdf", "ggx.rho_dh", "ggx.rho_hh", "ggx.split_sum", "gold.brdf", "gold.rho_dh"]);
    assert_eq!(plan.tables[4].channels(), ["R", "G", "B"]);
    assert_eq!(plan.materials[0].tables, names);
}

#[test]
fn a_delta_has_no_values_and_the_plan_says_so() {
    for subject in
        [material("chrome", "mirror", None), material("chrome", "ggx", Some(Distribution::constant(0.0)))]
    {
        let plan = plan(vec![subject]);
        assert!(plan.tables.iter().all(|t| t.quantity() != &BRDF) && !plan.tables.is_empty());
        assert!(plan.left_out.iter().any(|l| l.what.contains("chrome.brdf") && l.why.contains("delta")));
    }
}

#[test]
fn plans_are_values() {
    let materials = || {
        vec![material("wall", "lambert", None), material("gold", "ggx", Some(Distribution::constant(0.3)))]
    };
    assert_eq!(plan(materials()), plan(materials()));
    assert_ne!(plan(materials()), plan(materials()[..1].to_vec()));

    let axes = vec![Axis::new(Variable::Mu, 4, [0.0, 1.0], Positions::Centers, Mapping::Linear).unwrap()];
    let table = TablePlan::basis("dfg", &SPLIT_SUM, model("ggx"), Some(0.5), axes.clone()).unwrap();
    assert_eq!(table.axes(), axes);
    assert_eq!((table.rule(), table.channels()), (Rule::Warped, &["A".to_string(), "B".into()][..]));
}

#[test]
fn what_cannot_be_baked_is_refused_with_the_remedy() {
    let theta = || vec![Axis::natural(Variable::ThetaI, 8).unwrap()];
    let refusal = |result: gonio::base::error::Result<TablePlan>| result.unwrap_err().to_string();
    let no_roughness = refusal(TablePlan::basis("t", &RHO_DH, model("ggx"), None, theta()));
    assert!(no_roughness.contains("needs a roughness"), "{no_roughness}");
    let wrong_axes = refusal(TablePlan::basis("t", &SPLIT_SUM, model("lambert"), None, theta()));
    assert!(wrong_axes.contains("split_sum runs over (mu)"), "{wrong_axes}");
    let table = TablePlan::basis("t", &RHO_DH, model("lambert"), None, theta()).unwrap();
    let odd = refusal(table.with_rule(Rule::Grid { theta: 8, phi: 15 }));
    assert!(odd.contains("even"), "{odd}");
}
