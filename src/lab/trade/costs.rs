//! What a tolerance costs: a model's integrals at the extremes, the work that the warped rule does for them, and what it
//! leaves.

use crate::bake::{Evaluator, Observer, Unobserved};
use crate::base::error::Result;
use crate::base::timings::Timings;
use crate::check;
use crate::check::Check;
use crate::integrate::rule_set::RuleSet;
use crate::model::{Integral, Model};
use crate::plan::TablePlan;
use crate::table::axis::{Axis, Variable};
use crate::table::quantity::{Quantity, RHO_DH, RHO_HH};
use rayon::prelude::*;
use serde::Serialize;
use std::f64::consts::FRAC_PI_2;

/// A model's integral at a tolerance.
#[derive(Debug, Clone, Serialize)]
pub struct Cost {
    /// The model.
    pub model: &'static str,
    /// `rho_dh` or `rho_hh`.
    pub quantity: &'static str,
    /// What was asked for, absolute.
    pub tolerance: f64,
    /// Evaluations of the integrand for a texel, their mean over the table: nodes in all directions, multiplied. Of
    /// directions that the host finds, no texel takes more.
    pub evaluations: u64,
    /// The arithmetic: `f32` or `f64`.
    pub precision: String,
    /// The largest difference to the f64 reference, over all texels and components.
    pub error: f64,
    /// Texels compared.
    pub texels: usize,
}

impl Cost {
    /// Whether the tolerance is met; NaN is not.
    pub fn is_met(&self) -> bool {
        self.error <= self.tolerance
    }
}

/// From the mirror to the widest.
const ROUGHNESS: [f64; 9] = [0.0, 1e-3, 0.01, 0.05, 0.15, 0.3, 0.5, 0.75, 1.0];
const THETAS: [f64; 9] = [0.0, 1e-3, 0.3, 0.8, 1.2, 1.5, FRAC_PI_2 - 1e-3, FRAC_PI_2 - 1e-6, FRAC_PI_2];

/// Measures ρ_dh and ρ_hh of a model, its parameters at their defaults, at each tolerance; nothing of a model that has no
/// integrals. The reference is computed once.
///
/// # Errors
/// When the device fails, or the observer stops it.
pub fn costs(
    evaluator: &Evaluator,
    model: &'static Model,
    tolerances: &[f64],
    observer: &dyn Observer,
) -> Result<Vec<Cost>> {
    let mut costs = Vec::new();
    if matches!(model.integral, Integral::Unbounded(_)) || check::reference_of_model(model).is_none() {
        return Ok(costs);
    }
    for quantity in [&RHO_DH, &RHO_HH] {
        let plan = plan(model, quantity)?;
        let share = 0.5 / plan.texels() as f64;
        let truth = (0..plan.texels()).into_par_iter().map(|texel| {
            let truth = check::reference(&plan, texel);
            observer.advance(share).map(|()| truth)
        });
        let truth = truth.collect::<Result<Vec<_>>>()?.concat();
        for &tolerance in tolerances {
            let plan = plan.clone().with_tolerance(tolerance)?;
            let table = evaluator.bake(&plan, Check::Sample(0), &mut Timings::default(), &Unobserved)?;
            let differences =
                table.values.iter().zip(&truth).map(|(value, truth): (f64, _)| (value - truth).abs());
            // f64::max loses NaN.
            let error = differences.fold(0.0, |most, x| if x > most || x.is_nan() { x } else { most });
            let evaluations = RuleSet::new(&plan, &plan.lobes()[0]).evaluations() / plan.texels() as u64;
            costs.push(Cost {
                model: model.name,
                quantity: quantity.name,
                tolerance,
                evaluations,
                precision: table.precision.to_string(),
                error,
                texels: plan.texels(),
            });
        }
    }
    Ok(costs)
}

fn plan(model: &'static Model, quantity: &'static Quantity) -> Result<TablePlan> {
    let listed = |variable| match variable {
        Variable::Roughness => Axis::listed(variable, ROUGHNESS.to_vec()),
        Variable::ThetaI => Axis::listed(variable, THETAS.to_vec()),
        _ => Axis::natural(variable, 3),
    };
    let axes = model.variables(quantity).map(listed).collect::<Result<_>>()?;
    TablePlan::basis(model.name, quantity, model, None, axes)
}
