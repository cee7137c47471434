//! Bakes tables: evaluate, look, cross-check.

#[cfg(feature = "files")]
mod set;
#[cfg(feature = "files")]
mod stream;

#[cfg(feature = "files")]
pub use set::{Baked, Options, bake_set};
#[cfg(feature = "files")]
pub use stream::{Progress, Streaming};

use crate::check::{Check, cross_check};
use crate::cpu;
use crate::error::{Error, Result};
use crate::gpu::{Device, DeviceChoice};
use crate::plan::{Rule, TablePlan};
use crate::quantity::Evaluation;
use crate::table::{Table, TableError};
use serde::Serialize;
use std::time::Instant;

/// What evaluates tables.
pub enum Evaluator {
    /// A device, in f32.
    Device(Box<Device>),
    /// All cores, in f64.
    Cpu,
}

/// Who watches a bake, and may stop it.
pub trait Observer: Sync {
    /// A step begins: "baking ggx.split_sum".
    fn begin(&self, _step: &str) {}

    /// More of the step is done, as a share of it.
    ///
    /// # Errors
    /// To stop the bake.
    fn advance(&self, _share: f64) -> Result<()> {
        Ok(())
    }
}

/// Nobody watches.
pub struct Unobserved;

impl Observer for Unobserved {}

/// The relative error of values in f32, in units of 2⁻²⁴: factors, α and weights are rounded once each;
/// q of GGX's D takes 5 and is squared; G2/(4 μi μe) takes 6; Fc is the fifth power of what takes 4;
/// products take 4. The sum bounds the worst case, B of a lobe.
pub const VALUE_F32: f64 = 40.0 / (1 << 24) as f64;

/// The relative error of f64 values stored as f32.
pub const STORED_F32: f64 = 1.0 / (1 << 24) as f64;

/// The absolute error of integrals by the warped rule: 5e-7 of the rule itself, over α ∈ [0, 1] and
/// μ ∈ [2⁻²⁴, 1], and as much of f32.
pub const WARPED: f64 = 1e-6;

/// Where the time went, in seconds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Stages {
    /// Reading the scene and its textures, and planning.
    pub scene: f64,
    /// Finding and opening the device.
    pub device: f64,
    /// Composing and validating shaders.
    pub compose: f64,
    /// Making factors and nodes, compiling pipelines, uploading.
    pub compile: f64,
    /// Running the kernels, or the CPU path.
    pub dispatch: f64,
    /// Copying results back.
    pub readback: f64,
    /// Comparing with the reference.
    pub check: f64,
    /// Writing files.
    pub write: f64,
}

impl Evaluator {
    /// The evaluator that a choice means, with a line that says which and why.
    ///
    /// # Errors
    /// When a named device is not there.
    pub fn choose(choice: &DeviceChoice) -> Result<(Self, String)> {
        let (device, line) = Device::choose(choice)?;
        Ok((device.map_or(Self::Cpu, |device| Self::Device(Box::new(device))), line))
    }

    /// The arithmetic: `f32` or `f64`.
    pub fn precision(&self) -> &'static str {
        match self {
            Self::Device(_) => "f32",
            Self::Cpu => "f64",
        }
    }

    /// Evaluates a table and measures its error.
    ///
    /// The table comes back whatever its error is: see [`within_tolerance`].
    ///
    /// # Errors
    /// When the device fails, a value is negative or not finite, or more light leaves than the
    /// models promise.
    pub fn bake(
        &self,
        plan: &TablePlan,
        check: Check,
        stages: &mut Stages,
        observer: &dyn Observer,
    ) -> Result<Table> {
        observer.begin(&format!("baking {}", plan.name));
        let tick = |share| observer.advance(share);
        let before = stages.dispatch + stages.readback;
        let values = match self {
            Self::Device(device) => device.evaluate(plan, stages, &tick)?,
            Self::Cpu => {
                let start = Instant::now();
                let values = cpu::evaluate(plan, &tick)?;
                stages.dispatch += start.elapsed().as_secs_f64();
                values
            }
        };
        let seconds = stages.dispatch + stages.readback - before;

        observer.begin(&format!("checking {}", plan.name));
        let start = Instant::now();
        let error = cross_check(plan, &values, check, self.estimate(plan), &tick)?;
        stages.check += start.elapsed().as_secs_f64();
        let table = self.table(plan, values, error, seconds);
        table.check_sane()?;
        check_energy(plan, &table)?;
        Ok(table)
    }

    /// The table of a plan, with what was found.
    fn table(&self, plan: &TablePlan, values: Vec<f32>, error: TableError, seconds: f64) -> Table {
        Table {
            name: plan.name.clone(),
            quantity: plan.quantity.name.into(),
            unit: plan.quantity.unit.into(),
            subject: plan.subject.clone(),
            parameters: plan.parameters(),
            axes: plan.axes.clone(),
            channels: plan.channels.clone(),
            values,
            rule: if plan.quantity.evaluation == Evaluation::Value {
                "pointwise".into()
            } else {
                plan.rule.to_string()
            },
            precision: self.precision().into(),
            error,
            seconds,
        }
    }

    /// What a rule promises before anything is measured, over all parameters; the tests of
    /// convergence and of the extremes hold it. The grid rule promises nothing.
    fn estimate(&self, plan: &TablePlan) -> Option<f64> {
        if plan.quantity.evaluation == Evaluation::Value {
            return Some(if matches!(self, Self::Cpu) { STORED_F32 } else { VALUE_F32 });
        }
        (plan.rule == Rule::Warped).then_some(WARPED)
    }
}

/// Whether a table meets its tolerance, as far as it was measured.
///
/// # Errors
/// [`Error::Promise`] with the worst texel.
pub fn within_tolerance(plan: &TablePlan, table: &Table) -> Result<()> {
    let Some(measured) = table.error.measured_max.filter(|&max| max > plan.tolerance) else { return Ok(()) };
    let place: Vec<_> = table.error.worst.iter().map(|(name, value)| format!("{name} = {value}")).collect();
    let remedy = match plan.rule {
        Rule::Grid { .. } => "take a finer grid or the warped rule",
        // No table is better than the f32 that it is stored in.
        Rule::Warped if table.precision == "f32" && plan.tolerance > STORED_F32 => {
            "allow more, or bake with --device cpu, which is f64"
        }
        Rule::Warped => "allow more",
    };
    Err(Error::Promise(format!(
        "table {}: its error is {measured:.2e} where {:.0e} is allowed ({}); {remedy}",
        plan.name,
        plan.tolerance,
        place.join(", ")
    )))
}

/// No direction may send back more than the lobes' models promise (1 each where energy is conserved).
fn check_energy(plan: &TablePlan, table: &Table) -> Result<()> {
    if plan.quantity.evaluation == Evaluation::Value {
        return Ok(());
    }
    // A basis is weighed by F0 and F90 ≤ 1, so its components reflect together; RGB does not mix.
    let together = plan.is_basis();
    let bound: f64 = plan
        .lobes
        .iter()
        .map(|lobe| lobe.weights.as_flattened().iter().copied().fold(0.0, f64::max) * lobe.model.rho_bound)
        .sum();
    for texel in 0..table.texels() {
        let channels = table.texel(texel).iter().map(|&v| f64::from(v));
        let reflected = if together { channels.sum() } else { channels.fold(0.0, f64::max) };
        // Twice the tolerance, as A and B may both be off.
        if reflected > bound + 2.0 * plan.tolerance {
            return Err(Error::Promise(format!(
                "table {}: it reflects {reflected} at {}, more than the {bound} that its models promise",
                plan.name,
                table.place(texel)
            )));
        }
    }
    Ok(())
}
