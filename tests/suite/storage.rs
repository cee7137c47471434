//! Promises of storage: values are rounded to the nearest and never clamped, the error between samples is
//! what a reader meets, and the optimiser's table is smaller and better than the usual one.

use crate::common::readers;
use crate::common::{device, listed, model, reference_model, with_alpha};
use gonio::bake::{Evaluator, Unobserved, within_tolerance};
use gonio::base::timings::Timings;
use gonio::check::Check;
use gonio::io::format::{EXR, NPY};
use gonio::io::{Provenance, TableEntry, TableSet};
use gonio::plan::TablePlan;
use gonio::scene;
use gonio::scene::planner::{Plan, Selection};
use gonio::table::Table;
use gonio::table::axis::{Axis, Mapping, Positions, Variable};
use gonio::table::quantity::{BRDF, SPLIT_SUM};
use gonio::table::storage::Storage;
use serde_json::json;
use std::path::Path;

fn dfg(mu: Axis, roughness: Axis) -> TablePlan {
    TablePlan::basis("dfg", &SPLIT_SUM, model("ggx"), None, vec![roughness, mu])
        .unwrap()
        .with_tolerance(1e-3)
        .unwrap()
}

fn sqrt_nodes(variable: Variable, count: usize) -> Axis {
    Axis::new(variable, count, [0.0, 1.0], Positions::Nodes, Mapping::Sqrt).unwrap()
}

fn bake(plan: &TablePlan, check: Check) -> gonio::Result<Table> {
    device().bake(plan, check, &mut Timings::default(), &Unobserved)
}

/// Bits of halves and of unorm16 in files are those of the nearest value, ties to even, by hand.
#[test]
fn files_hold_the_nearest_representable_value() {
    let exact = dfg(sqrt_nodes(Variable::Mu, 9), sqrt_nodes(Variable::Roughness, 7));
    let exact = bake(&exact.with_tolerance(1e-6).unwrap(), Check::Sample(0)).unwrap();
    for storage in [Storage::F16, Storage::Unorm16] {
        let plan = dfg(sqrt_nodes(Variable::Mu, 9), sqrt_nodes(Variable::Roughness, 7))
            .with_storage(storage)
            .unwrap();
        let table = bake(&plan, Check::All).unwrap();
        // The rule of a stored table may be off by a tenth of its tolerance.
        let step =
            |x: f64| if storage == Storage::F16 { x.max(1e-6) * 2f64.powi(-11) } else { 0.5 / 65535.0 };
        for (stored, value) in table.values.iter().zip(exact.values.iter()) {
            assert!((stored - value).abs() <= step(value) + 1e-4 + 1e-6, "{storage:?}: {stored} for {value}");
        }
        let npy = NPY.encode(&table, &Provenance::new()).unwrap();
        let (descr, shape, bytes) = readers::npy_raw(&npy).unwrap();
        assert_eq!(shape, [7, 9, 2]);
        let words = bytes.chunks_exact(2).map(|b| u16::from_le_bytes([b[0], b[1]]));
        let read: Vec<f64> = match storage {
            Storage::F16 => words.map(readers::half).collect(),
            _ => words.map(|k| f64::from(k) / 65535.0).collect(),
        };
        assert_eq!(descr, if storage == Storage::F16 { "<f2" } else { "<u2" });
        // A table in memory is f32: k / 65535 is off by its rounding there.
        assert!(read.iter().zip(table.values.iter()).all(|(a, b)| (a - b).abs() <= 6e-8), "{storage:?}");

        let exr = readers::exr(&EXR.encode(&table, &Provenance::new()).unwrap()).unwrap();
        assert_eq!(exr.text("gonio:storage"), storage.name());
        assert_eq!(exr.half, storage == Storage::F16);
        for (c, name) in table.channels.iter().enumerate() {
            let same = (0..table.texels()).all(|t| f64::from(exr.channels[name][t]) == table.value(t, c));
            assert!(same, "{storage:?}, {name}");
        }
        assert!(table.error.measured_max.unwrap() > 1e-6, "the error is that of the stored values");
        within_tolerance(&plan, &table).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let mut set = TableSet::create(folder.path()).unwrap();
        let files = set.write(&table, &[&NPY], &Provenance::new()).unwrap();
        let entry = json!(TableEntry::new(&table, files));
        assert_eq!(entry["storage"], json!(storage.name()));
        assert_eq!(entry["scale"].is_null(), storage == Storage::F16);
    }
}

#[test]
fn rounding_is_to_the_nearest_even() {
    let half = |x: f64| Storage::F16.round(x);
    assert_eq!(half(1.0 + 2f64.powi(-11)), 1.0, "a tie goes to the even one");
    assert_eq!(half(1.0 + 3.0 * 2f64.powi(-11)), 1.0 + 2f64.powi(-9));
    assert_eq!((half(65519.9), half(65520.0)), (65504.0, f64::INFINITY));
    assert_eq!((half(2f64.powi(-25)), half(1.01 * 2f64.powi(-25))), (0.0, 2f64.powi(-24)));
    let unorm = |x: f64| Storage::Unorm16.round(x) * 65535.0;
    assert_eq!((unorm(0.5 / 65535.0), unorm(1.5 / 65535.0), unorm(1.0)), (0.0, 2.0, 65535.0));
}

/// A peak of 1/(π α²) leaves the range of halves, and values off it fall below; neither is clamped.
#[test]
fn what_does_not_fit_is_refused_and_counted() {
    let axis = |v, values: &[f64]| listed(v, values);
    let plan = |roughness, theta: &[f64]| {
        let axes = vec![
            axis(Variable::ThetaI, &[0.3]),
            axis(Variable::ThetaE, theta),
            axis(Variable::DeltaPhi, &[0.0]),
        ];
        TablePlan::basis("peak", &BRDF, model("ggx"), Some(roughness), axes)
            .unwrap()
            .with_tolerance(1e-2)
            .unwrap()
    };
    let refusal = |plan: TablePlan, storage| {
        bake(&plan.with_storage(storage).unwrap(), Check::All).unwrap_err().to_string()
    };
    // B is what Schlick's fifth power leaves at 17°: below halves. A alone overflows.
    let overflow = refusal(plan(0.01, &[0.3]), Storage::F16);
    assert!(overflow.contains("1 of its 2 values overflow") && overflow.contains("f32"), "{overflow}");
    let underflow = refusal(plan(0.03, &[1.5]), Storage::F16);
    assert!(underflow.contains("2 of its 2 values underflow"), "{underflow}");
    let outside = refusal(plan(0.3, &[0.3]), Storage::Unorm16);
    assert!(outside.contains("1 of its 2 values are outside [0, 1]"), "{outside}");
    // Absolute errors bear underflow: counted, measured.
    let dfg = dfg(sqrt_nodes(Variable::Mu, 9), sqrt_nodes(Variable::Roughness, 7))
        .with_storage(Storage::F16)
        .unwrap();
    assert!(bake(&dfg, Check::All).unwrap().error.underflows.unwrap() > 0);
}

/// The bilinear error as a reader would find it, written again from the README's words: at a thousand
/// random places no look-up is further off than the maximum says, by the reference.
#[test]
fn the_stated_maximum_bounds_what_a_reader_meets() {
    let axes = [
        (sqrt_nodes(Variable::Mu, 24), sqrt_nodes(Variable::Roughness, 16)),
        (Axis::natural(Variable::Mu, 32).unwrap(), Axis::natural(Variable::Roughness, 32).unwrap()),
    ];
    let ggx = reference_model("ggx");
    for (mu, roughness) in axes {
        let sqrt = mu.mapping() == Mapping::Sqrt;
        let plan = dfg(mu, roughness);
        let table = bake(&plan, Check::Sample(16)).unwrap();
        let stated = table.error.interpolation.clone().unwrap();
        assert_eq!(stated.domain["mu"], [1.0 / 256.0, 1.0]);
        assert_eq!(stated.domain["roughness"], [0.05, 1.0]);
        assert!(stated.certified < 2e-6 && stated.points_checked <= 256, "{stated:?}");
        let place = |x: f64, n: usize| {
            let t = if sqrt {
                x.sqrt() * (n - 1) as f64
            } else {
                (x * n as f64 - 0.5).clamp(0.0, (n - 1) as f64)
            };
            ((t as usize).min(n - 2), t - (t as usize).min(n - 2) as f64)
        };
        let (rows, columns) = (table.axes[0].len(), table.axes[1].len());
        let mut largest: f64 = 0.0;
        for (u, v) in crate::common::golden(300, 0.1)
            .into_iter()
            .zip((0..300).map(|k| (0.5 + k as f64 * 0.7548776662).fract()))
        {
            let (mu, r) = (1.0 / 256.0 + (1.0 - 1.0 / 256.0) * u.powi(3), 0.05 + 0.95 * v * v);
            let ((x, fx), (y, fy)) = (place(mu, columns), place(r, rows));
            let truth = ggx.rho_dh(mu, &with_alpha(ggx, r * r));
            for (c, truth) in truth.into_iter().enumerate() {
                let at = |y: usize, x: usize| table.value(y * columns + x, c);
                let low = at(y, x) * (1.0 - fx) + at(y, x + 1) * fx;
                let high = at(y + 1, x) * (1.0 - fx) + at(y + 1, x + 1) * fx;
                largest = largest.max((low * (1.0 - fy) + high * fy - truth).abs());
            }
        }
        let max = stated.max.unwrap();
        assert!(largest <= max && largest > 0.2 * max, "{largest} found, {max} stated");
        assert!(stated.rms < max && stated.rms > 0.0);
    }
}

/// The demonstration of the README: a quarter of the bytes of the usual table, which misses by far.
#[test]
fn the_optimiser_meets_what_the_usual_table_does_not_in_a_quarter_of_its_bytes() {
    let scene = scene::read(Path::new("assets/demo/auto.toml")).unwrap();
    let plan = Plan::new(&scene, &Selection::default()).unwrap();
    assert_eq!(plan, Plan::new(&scene, &Selection::default()).unwrap(), "plans are pure");
    let [auto, usual] = &plan.tables[..] else { panic!("{plan}") };
    let choice = auto.bilinear().unwrap();
    let bytes = |plan: &TablePlan| plan.texels() * plan.channels().len() * plan.storage().bytes();
    assert_eq!((bytes(usual), bytes(auto)), (64 << 10, choice.chosen.bytes));
    assert!(bytes(auto) <= bytes(usual) / 4, "{choice}");
    assert!(choice.runner_up.as_ref().unwrap().bytes >= choice.chosen.bytes, "{choice}");
    for evaluator in [device(), &Evaluator::Cpu] {
        let bake =
            |plan| evaluator.bake(plan, Check::Sample(64), &mut Timings::default(), &Unobserved).unwrap();
        let (auto_table, usual_table) = (bake(auto), bake(usual));
        let max = |table: &Table| table.error.interpolation.as_ref().unwrap().max.unwrap();
        println!(
            "auto {:.2e} in {} bytes, usual {:.2e}; {choice}",
            max(&auto_table),
            bytes(auto),
            max(&usual_table)
        );
        assert!(max(&auto_table) <= 1e-3 && max(&usual_table) > 1e-3);
        within_tolerance(auto, &auto_table).unwrap();
        // And the promise is looked at: half of it is not met.
        assert!(within_tolerance(&auto.clone().with_tolerance(5e-4).unwrap(), &auto_table).is_err());
    }
}

#[test]
fn recipes_say_what_auto_and_storage_may_be() {
    let parse = |axes: &str, rest: &str| {
        let text = format!("[[tables]]\nquantity = \"split_sum\"\nmodel = \"ggx\"\naxes = {axes}\n{rest}");
        scene::parse_recipe(Path::new("r.toml"), text.as_bytes())
            .and_then(|scene| Plan::new(&scene, &Selection::default()))
    };
    let plan =
        parse("{ mu = \"auto\", roughness = { count = \"auto\", range = [0.3, 0.8] } }", "tolerance = 1e-2")
            .unwrap();
    assert_eq!(plan.tables[0].axis(Variable::Roughness).unwrap().range(), [0.3, 0.8]);
    let plan = parse(
        "{ mu = \"auto\", roughness = { count = 48, positions = \"nodes\", mapping = \"sqrt\" } }",
        "tolerance = 2e-2
storage = \"f16\"",
    )
    .unwrap();
    assert_eq!((plan.tables[0].storage(), plan.tables[0].axes()[0].len()), (Storage::F16, 48));
    let refusal = |axes, rest| parse(axes, rest).unwrap_err().to_string();
    let why = refusal("{ mu = 8, roughness = 8 }", "storage = \"u8\"");
    assert!(why.contains("u8") && why.contains("unorm16"), "{why}");
    let why = refusal("{ mu = \"auto\", roughness = \"auto\" }", "tolerance = 1e-9");
    assert!(why.contains("up to 512"), "{why}");
}

/// Half floats round by more than the usual tolerance: asked for without one, they get a tolerance that they can meet.
#[test]
fn half_floats_have_a_tolerance_of_their_own() {
    let dir = tempfile::tempdir().unwrap();
    let recipe = dir.path().join("r.toml");
    for (more, tolerance) in
        [("storage = 'f16'", 1e-3), ("", 1e-4), ("storage = 'f16'\ntolerance = 1e-4", 1e-4)]
    {
        let axes = "axes = { mu = 8, roughness = 8 }";
        std::fs::write(
            &recipe,
            format!("[[tables]]\nmodel = 'ggx'\nquantity = 'split_sum'\n{axes}\n{more}\n"),
        )
        .unwrap();
        let plan =
            gonio::scene::planner::Plan::new(&gonio::scene::read(&recipe).unwrap(), &Default::default())
                .unwrap();
        assert_eq!(plan.tables[0].tolerance(), tolerance, "{more}");
    }
}
