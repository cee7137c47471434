//! What the tests share: one device for the process, and short ways to tables.

#[cfg(feature = "files")]
pub mod readers;

use crate::promises::{STORED_F32, VALUE_F32, integral_f32, value_f32};
use gonio::backend::gpu::{DeviceChoice, INSTALL};
use gonio::bake::{Evaluator, Unobserved};
use gonio::base::precision::Precision;
use gonio::base::timings::Timings;
use gonio::check::{Check, reference, reference_of_model};
use gonio::model;
use gonio::model::Model;
use gonio::plan::TablePlan;
use gonio::reference::{Parameters, Reference, Setting};
use gonio::table::Table;
use gonio::table::axis::{Axis, Mapping, Positions, Variable};
use gonio::table::quantity::{Quantity, RHO_DH, RHO_HH};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};
use std::path::PathBuf;
use std::sync::OnceLock;

/// The device under test. There must be one: a suite that skips proves nothing.
pub fn device() -> &'static Evaluator {
    static DEVICE: OnceLock<Evaluator> = OnceLock::new();
    DEVICE.get_or_init(|| {
        let (evaluator, line) = Evaluator::choose(&DeviceChoice::Auto).unwrap();
        assert!(matches!(evaluator, Evaluator::Device(_)), "no device to test on. {INSTALL}");
        println!("tested on {line}");
        evaluator
    })
}

/// Both evaluators.
/// Whether tests take all of their cases, as `scripts/test.sh --long` has them, rather than a few of each kind.
pub fn is_thorough() -> bool {
    std::env::var_os("GONIO_THOROUGH").is_some()
}

/// All of a list where tests are thorough, else every `step`-th and the last.
pub fn some_of<T: Copy>(all: &[T], step: usize) -> Vec<T> {
    let last = all.len().saturating_sub(1);
    let is_taken = |k: usize| is_thorough() || k.is_multiple_of(step) || k == last;
    (0..all.len()).filter(|&k| is_taken(k)).map(|k| all[k]).collect()
}

pub fn evaluators() -> [&'static Evaluator; 2] {
    [device(), &Evaluator::Cpu]
}

pub fn model(name: &str) -> &'static Model {
    model::find(name).unwrap()
}

/// The f64 reference of the model of this name.
pub fn reference_model(name: &str) -> &'static dyn Reference {
    reference_of_model(model(name)).unwrap()
}

/// A setting of a reference by α, all parameters at their defaults.
pub fn with_alpha(model: &dyn Reference, alpha: f64) -> Setting {
    Setting::measured(model.measure(), alpha, &Parameters::DEFAULT).unwrap()
}

pub fn axis(variable: Variable, count: usize) -> Axis {
    Axis::natural(variable, count).unwrap()
}

pub fn nodes(variable: Variable, count: usize, range: [f64; 2]) -> Axis {
    Axis::new(variable, count, range, Positions::Nodes, Mapping::Linear).unwrap()
}

/// The given values, sorted, without repeats.
pub fn listed(variable: Variable, values: &[f64]) -> Axis {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values.dedup();
    Axis::listed(variable, values).unwrap()
}

/// A basis over `axes`, after a roughness axis if the model has one, as exact as f32 is.
pub fn basis(
    quantity: &'static Quantity,
    model: &'static Model,
    roughness: &[f64],
    axes: Vec<Axis>,
) -> TablePlan {
    let swept = model.shape.map(|_| listed(Variable::Roughness, roughness));
    let axes = swept.into_iter().chain(axes).collect();
    let plan = TablePlan::basis("test", quantity, model, None, axes).unwrap();
    let exact = [integral_f32(model), value_f32(model)]
        .into_iter()
        .find(|&t| plan.clone().with_tolerance(t).unwrap().precision() == Precision::F32);
    plan.with_tolerance(exact.unwrap()).unwrap()
}

pub fn bake(evaluator: &Evaluator, plan: &TablePlan, check: Check) -> Table {
    evaluator.bake(plan, check, &mut Timings::default(), &Unobserved).unwrap()
}

/// A table that is tried at many tolerances, and its texels by the reference, which integrates once.
pub struct Tried {
    plan: TablePlan,
    truth: Vec<Vec<f64>>,
}

impl Tried {
    pub fn new(plan: TablePlan) -> Self {
        let truth = (0..plan.texels()).into_par_iter().map(|texel| reference(&plan, texel)).collect();
        Self { plan, truth }
    }

    /// The table at a tolerance, which no texel may miss by more than `beyond`.
    pub fn assert_meets(&self, evaluator: &Evaluator, tolerance: f64, beyond: f64) -> Table {
        let plan = self.plan.clone().with_tolerance(tolerance).unwrap();
        let table = bake(evaluator, &plan, Check::Sample(0));
        for (texel, truth) in self.truth.iter().enumerate() {
            for (value, truth) in table.texel(texel).into_iter().zip(truth) {
                let error = (value - truth).abs();
                let set = &plan.lobes()[0].parameters();
                // NaN is no number that is small enough.
                let place = table.coordinates(texel);
                assert!(
                    error <= tolerance + beyond,
                    "{plan} ({}) {set:?}: {value}, {truth} at {place}",
                    table.precision
                );
            }
        }
        assert!(
            table.error.estimate.is_none_or(|estimate| estimate <= tolerance),
            "{plan}: {:?}",
            table.error
        );
        table
    }
}

/// A file of the sample data, which are too large for the repository: tests of it are ignored unless asked for, and fail
/// without it.
pub fn sample_data(file: &str) -> PathBuf {
    let data = std::env::var_os("GONIO_DATA").map(PathBuf::from);
    let path = data
        .expect("set GONIO_DATA to the folder of the sample data: CONTRIBUTING.md says what is in it")
        .join(file);
    assert!(path.exists(), "{} is not there; CONTRIBUTING.md says what is in GONIO_DATA", path.display());
    path
}

/// A reproducible sequence in [0, 1): the additive recurrence of the golden section.
pub fn golden(n: usize, seed: f64) -> Vec<f64> {
    (0..n).map(|k| (seed + k as f64 * 0.618_033_988_749_894_9).fract()).collect()
}

/// The relative errors of a model's values: on a device, and in f64 as stored in f32. What the reference and the
/// CPU path round differently where both directions graze, 1e-8 each, is as much more as a model's values are
/// more sensitive than most.
pub fn value_budgets(model: &Model) -> [f64; 2] {
    [value_f32(model), STORED_F32 + 2e-8 * value_f32(model) / VALUE_F32]
}

/// What an exchange of ωi and ωe may change of a model's values, relative. It exchanges operands of commutative sums and
/// products: no bit, but for the rounding to storage; unless a driver contracts a·b + c, so that of two products one is
/// not rounded, and which one changes: then each of both is within its budget of the same f.
pub fn exchange_budget(evaluator: &Evaluator, model: &Model) -> f64 {
    match evaluator {
        Evaluator::Device(device) if device.canary().unwrap().contracts => 2.0 * value_f32(model),
        _ => 2.0 * f64::from(f32::EPSILON),
    }
}

/// The extremes of θ, rad.
pub fn extreme_thetas() -> Vec<f64> {
    let right = std::f64::consts::FRAC_PI_2;
    vec![0.0, 1e-7, 1e-3, 0.3, 0.8, right - 1e-3, right - 1e-6, right]
}

/// The extremes of roughness whose lobes have values: α from 1e-6 to 1.
pub const EXTREME_ROUGHNESS: [f64; 7] =
    [1e-3, 1e-2, 0.031_622_776_601_683_79, 0.1, 0.316_227_766_016_837_9, 0.7, 1.0];

/// θi, θe and δφ at their extremes, and some between.
pub fn extreme_angles() -> Vec<Axis> {
    let mut thetas = extreme_thetas();
    thetas.extend(golden(6, 0.1).iter().map(|u| u * FRAC_PI_2));
    let mut deltas = vec![0.0, 1e-7, 1e-4, 1e-2, FRAC_PI_2, PI - 1e-6, PI];
    deltas.extend(golden(5, 0.7).iter().map(|u| u * PI));
    let thetas = |variable| listed(variable, &thetas);
    vec![thetas(Variable::ThetaI), thetas(Variable::ThetaE), listed(Variable::DeltaPhi, &deltas)]
}

/// ρ_dh and ρ_hh of a Fresnel term on models with and without a lobe meet each tolerance, on both evaluators; `with`
/// gives it its parameters.
pub fn assert_term_meets_every_tolerance(models: [&'static Model; 2], with: impl Fn(TablePlan) -> TablePlan) {
    let roughness = [0.0, 1e-2, 0.15, 0.4, 0.7, 1.0];
    let thetas = [0.0, 0.5, 1.0, 1.3, 1.5, FRAC_PI_2 - 1e-3, FRAC_PI_2];
    for of in models {
        for (quantity, axes) in [(&RHO_DH, vec![listed(Variable::ThetaI, &thetas)]), (&RHO_HH, vec![])] {
            let tried = Tried::new(with(basis(quantity, of, &roughness, axes)));
            for (tolerance, evaluator) in
                [1e-2, 1e-4, 1e-6].into_iter().flat_map(|t| evaluators().map(|evaluator| (t, evaluator)))
            {
                tried.assert_meets(evaluator, tolerance, 0.0);
            }
        }
    }
}

/// An engine's device with these limits; `None` where the adapter has less.
pub fn engine(limits: gonio::wgpu::Limits) -> Option<(gonio::wgpu::Device, gonio::wgpu::Queue)> {
    let wanted = gonio::backend::gpu::adapters().into_iter().next()?;
    let instance = gonio::wgpu::Instance::new(gonio::wgpu::InstanceDescriptor::new_without_display_handle());
    let all = pollster::block_on(instance.enumerate_adapters(gonio::wgpu::Backends::PRIMARY));
    let adapter = all.into_iter().find(|adapter| adapter.get_info() == wanted.info)?;
    let descriptor = gonio::wgpu::DeviceDescriptor { required_limits: limits, ..Default::default() };
    pollster::block_on(adapter.request_device(&descriptor)).ok()
}
