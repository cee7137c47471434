//! Bakes tables: evaluates, certifies and checks them.

/// Compares with the reference where the feature `check` is on; without it the estimate is all that is known.
#[cfg_attr(not(feature = "check"), path = "unmeasured.rs")]
mod measured;
pub mod points;

pub use crate::table::Check;

use crate::backend::cpu;
use crate::backend::gpu::{Device, DeviceChoice};
use crate::base::error::{Error, Result};
use crate::base::precision::{Precision, STORED_F32, VALUE_F32};
use crate::base::timings::Stopwatch;
use crate::base::timings::Timings;
use crate::base::tolerance::{CERTIFY_RATIO, ENERGY_SLACK, FINEST, KEPT_SHARE};
use crate::integrate::rule_set::has_listed_directions;
use crate::integrate::scale::factor_error;
use crate::plan::TablePlan;
use crate::table::quantity::Limits;
use crate::table::rule::Rule;
use crate::table::storage::{Storage, Stored};
use crate::table::{Table, TableError, Values};
use measured::table_error;

/// The evaluator of tables: a device or the CPU path.
pub enum Evaluator {
    /// A device, in f32, or in f64 where it has that.
    Device(Box<Device>),
    /// The CPU path: all cores, in f64.
    Cpu,
}

/// An observer of a bake, which may stop it.
pub trait Observer: Sync {
    /// Hears that a step begins: "baking ggx.split_sum".
    fn begin(&self, _step: &str) {}

    /// Hears that a further share of the step is done.
    ///
    /// # Errors
    /// An error stops the bake.
    fn advance(&self, _share: f64) -> Result<()> {
        Ok(())
    }
}

/// The observer that does nothing.
pub struct Unobserved;

impl Observer for Unobserved {}

impl Evaluator {
    /// The evaluator that a choice means, with a line that says which and why.
    ///
    /// # Errors
    /// When a named device is not there.
    pub fn choose(choice: &DeviceChoice) -> Result<(Self, String)> {
        let (device, line) = Device::choose(choice)?;
        Ok((device.map_or(Self::Cpu, |device| Self::Device(Box::new(device))), line))
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
        timings: &mut Timings,
        observer: &dyn Observer,
    ) -> Result<Table> {
        let computed = self.compute(plan, check, timings, observer)?;
        observer.begin(&format!("checking {}", plan.name()));
        let start = Stopwatch::start();
        let table = computed.check(plan, check, &|share| observer.advance(share));
        timings.check += start.seconds();
        table
    }

    /// Evaluates a table, and certifies its integrals by a second rule if anything is to be checked.
    pub(crate) fn compute(
        &self,
        plan: &TablePlan,
        check: Check,
        timings: &mut Timings,
        observer: &dyn Observer,
    ) -> Result<Computed> {
        plan.check_fits_memory()?;
        observer.begin(&format!("baking {}", plan.name()));
        let tick = |share| observer.advance(share);
        let before = timings.dispatch + timings.readback;
        let path = self.path(plan);
        let mut values = path.evaluate(plan, timings, &tick)?;
        let seconds = timings.dispatch + timings.readback - before;
        let mut estimate = path.estimate(plan);
        if check != Check::Sample(0) && plan.rule() == Rule::Warped && plan.quantity().is_integral() {
            // The finest rule has none beyond it to be checked by: comparing it with itself proves nothing.
            let finest = plan.rule_tolerance() <= FINEST;
            estimate = match finest {
                true => None,
                false => Some(self.certify(plan, &mut values, timings, &tick)?),
            };
        }
        Ok(Computed { values, estimate, origin: self.origin(plan, seconds) })
    }

    /// Certifies a table by the rule of a tenth of its tolerance, in the precision that this one takes: f32 would add its own
    /// rounding to what it judges. Texels that differ by more than half the tolerance take the finer rule's value, which the
    /// next rule then checks. Returns the largest difference that is left, with what the finer rule may itself be off; it
    /// counts values that no further rule has checked.
    fn certify(
        &self,
        plan: &TablePlan,
        values: &mut Values,
        timings: &mut Timings,
        tick: &(impl Fn(f64) -> Result<()> + Sync),
    ) -> Result<f64> {
        const TRIES: i32 = 3;
        let mut spent = Timings::default();
        let mut bound = 0.0;
        for finer in 1..=TRIES {
            let second = plan.clone().with_tolerance(plan.tolerance() * CERTIFY_RATIO.powi(finer))?;
            let certain = self.path(&second).evaluate(&second, &mut spent, tick)?;
            let limit = KEPT_SHARE * plan.tolerance_before_storage();
            let replacement = values.replace_beyond(limit, &certain, plan.channels().len());
            bound = replacement.kept.max(replacement.replaced) + second.rule_tolerance().max(FINEST);
            if replacement.replaced == 0.0 {
                break;
            }
        }
        timings.compose += spent.compose;
        timings.compile += spent.compile;
        timings.certify += spent.dispatch + spent.readback;
        Ok(bound)
    }

    /// The origin of the table of a plan: its rule, precision and seconds.
    pub(crate) fn origin(&self, plan: &TablePlan, seconds: f64) -> Origin {
        let path = self.path(plan);
        Origin { rule: path.rule(plan, self), precision: path.precision(), seconds }
    }

    /// The path that evaluates a plan: in f64 where its tolerance asks for it, and on the CPU where the device has no f64.
    /// The CPU evaluates all values in f64, as a device stores values in f32 only; and integrals over directions that the
    /// host finds, as the upload of a direction costs more than its evaluation.
    pub(crate) fn path(&self, plan: &TablePlan) -> Path<'_> {
        let integral = plan.quantity().is_integral();
        match (self, plan.precision()) {
            (_, precision) if has_listed_directions(plan) => Path::Cpu(precision),
            (Self::Device(device), Precision::F32) => Path::Device(device, Precision::F32),
            (Self::Device(device), Precision::F64) if device.has_f64() && integral => {
                Path::Device(device, Precision::F64)
            }
            (_, precision) => Path::Cpu(precision),
        }
    }
}

/// A table's values before they are checked, which takes no device.
pub(crate) struct Computed {
    values: Values,
    /// The error that the rule promises, or that was found between two rules.
    estimate: Option<f64>,
    origin: Origin,
}

/// The origin of a table: its rule, precision and seconds.
pub(crate) struct Origin {
    rule: String,
    precision: Precision,
    seconds: f64,
}

impl Computed {
    /// Rounds the values to their storage format, and measures the error.
    pub(crate) fn check(
        self,
        plan: &TablePlan,
        check: Check,
        tick: &(impl Fn(f64) -> Result<()> + Sync),
    ) -> Result<Table> {
        let Self { values, estimate, origin } = self;
        let Stored { values, underflows, rounding } = plan
            .stored()
            .store(values, plan.quantity().error)
            .map_err(|why| Error::Promise(format!("table {}: {why}", plan.name())))?;
        // The estimate of wider formats has been found with their rounding.
        let rounding = (plan.stored().bytes() < Storage::F32.bytes()).then_some(rounding);
        let estimate = estimate.map(|estimate| estimate + rounding.unwrap_or(0.0));
        let mut error = table_error(plan, &values, check, estimate, tick)?;
        error.underflows = (plan.storage() == Storage::F16).then_some(underflows);
        error.rounding = rounding;
        let table = origin.table(plan, values, error);
        table.check_sane()?;
        check_energy(plan, &table)?;
        Ok(table)
    }
}

impl Origin {
    /// Makes the table of a plan from its values and its error.
    pub(crate) fn table(self, plan: &TablePlan, values: Values, error: TableError) -> Table {
        Table {
            name: plan.name().into(),
            quantity: plan.quantity(),
            subject: plan.subject().into(),
            parameters: plan.parameters(),
            axes: plan.axes().to_vec(),
            channels: plan.channels().to_vec(),
            values,
            rule: self.rule,
            storage: plan.stored(),
            bilinear: plan.bilinear().cloned(),
            precision: self.precision,
            error,
            seconds: self.seconds,
        }
    }
}

/// An evaluator and the precision of its result.
#[derive(Clone, Copy)]
pub(crate) enum Path<'a> {
    Device(&'a Device, Precision),
    /// The CPU path, always in f64; the precision is the one that was asked for.
    Cpu(Precision),
}

impl Path<'_> {
    fn evaluate(
        self,
        plan: &TablePlan,
        timings: &mut Timings,
        tick: &(impl Fn(f64) -> Result<()> + Sync),
    ) -> Result<Values> {
        match self {
            Self::Device(device, precision) => device.evaluate(plan, precision, timings, tick),
            Self::Cpu(_) => {
                let start = Stopwatch::start();
                let values = cpu::evaluate(plan, tick)?;
                timings.dispatch += start.seconds();
                Ok(Values::F64(values))
            }
        }
    }

    /// The error that is promised before anything is measured: the budget of values, or the tolerance of the warped rule.
    /// The other rules promise nothing.
    pub(crate) fn estimate(self, plan: &TablePlan) -> Option<f64> {
        if plan.quantity().is_integral() {
            return (plan.rule() == Rule::Warped).then_some(plan.rule_tolerance());
        }
        let factors = factor_error(plan);
        Some(
            factors
                + match self {
                    Self::Device(..) => plan.value_f32(),
                    Self::Cpu(Precision::F32) => STORED_F32,
                    // sin θi − sin θe, where both graze: their half sum is rounded near π/2; and what values make of it.
                    Self::Cpu(Precision::F64) => 1e-8 * plan.value_f32() / VALUE_F32,
                },
        )
    }

    /// The rule in words, with the CPU named where the evaluator is a device.
    fn rule(self, plan: &TablePlan, evaluator: &Evaluator) -> String {
        let rule = if plan.quantity().is_value() { "pointwise".into() } else { plan.rule().to_string() };
        match (self, evaluator) {
            (Self::Cpu(_), Evaluator::Device(_)) => {
                let why = if has_listed_directions(plan) {
                    "the host finds the directions"
                } else {
                    "f32 cannot meet the tolerance"
                };
                format!("{rule}, on the CPU: {why}")
            }
            _ => rule,
        }
    }

    /// The arithmetic that it computes in.
    fn precision(self) -> Precision {
        match self {
            Self::Device(_, precision) => precision,
            Self::Cpu(_) => Precision::F64,
        }
    }
}

/// Whether a table meets its tolerance, as far as it was measured.
///
/// # Errors
/// [`Error::Promise`] with the worst texel.
pub fn within_tolerance(plan: &TablePlan, table: &Table) -> Result<()> {
    if plan.bilinear().is_some()
        && let Some(between) = &table.error.interpolation
        && let Some(max) = between.max.filter(|&max| max > plan.tolerance())
    {
        return Err(Error::Promise(format!(
            "table {}: bilinear look-ups are off by {} where {:e} is allowed ({:?}); allow more, or \
             give counts in place of auto",
            plan.name(),
            beyond(max, plan.tolerance()),
            plan.tolerance(),
            between.worst
        )));
    }
    // Measured against the reference, or between two rules: whichever is worse.
    let certified = plan.rule() == Rule::Warped && plan.quantity().is_integral();
    let between = table.error.estimate.filter(|_| certified);
    let measured = table.error.measured_max.unwrap_or(0.0);
    let largest = measured.max(between.unwrap_or(0.0));
    if largest <= plan.tolerance() {
        return Ok(());
    }
    // The texel of the number: of the difference between two rules none is known.
    let mut worst = match measured == largest {
        true => table.error.worst.iter().map(|(name, value)| format!("{name} = {value}")).collect(),
        false => vec!["by a finer rule".to_string()],
    };
    if let Some(rounding) = table.error.rounding {
        let rest = (largest - rounding).max(0.0);
        worst.push(format!(
            "{rounding:.3e} of it by storage as {}, {rest:.1e} by the rest",
            table.storage.name()
        ));
    }
    let remedy = match plan.rule() {
        Rule::Grid { .. } => "take a finer grid or the warped rule",
        Rule::Gauss { .. } | Rule::Hammersley { .. } | Rule::Vndf { .. } | Rule::Random { .. } => {
            "take more nodes or samples, or the warped rule"
        }
        Rule::Warped if table.storage.bytes() < Storage::F32.bytes() => "allow more, or store it as f32",
        // No table is better than the f32 that it is stored in.
        Rule::Warped if table.precision == Precision::F32 && plan.tolerance() > STORED_F32 => {
            "allow more, or bake with the device \"cpu\", which is f64"
        }
        Rule::Warped => "allow more",
    };
    Err(Error::Promise(format!(
        "table {}: its error is {} where {:e} is allowed ({}); {remedy}",
        plan.name(),
        beyond(largest, plan.tolerance()),
        plan.tolerance(),
        worst.join(", ")
    )))
}

/// A number above a limit, in the digits that tell it from the limit, and three at least.
fn beyond(value: f64, limit: f64) -> String {
    let digits =
        (2..=16).find(|&digits| format!("{value:.digits$e}").parse::<f64>().is_ok_and(|x| x > limit));
    format!("{value:.*e}", digits.unwrap_or(16))
}

/// Refuses a table that reflects more in some direction than the lobes' models promise (1 each where energy is conserved).
fn check_energy(plan: &TablePlan, table: &Table) -> Result<()> {
    if plan.quantity().limits != Limits::Reflectance {
        return Ok(());
    }
    // A basis is weighed by F0 and F90 ≤ 1, so its components reflect together; RGB does not mix.
    let together = plan.is_basis();
    let bound = plan.rho_bound();
    for texel in 0..table.texels() {
        let channels = table.texel(texel).into_iter();
        let reflected = if together { channels.sum() } else { channels.fold(0.0, f64::max) };
        if reflected > bound + ENERGY_SLACK * plan.tolerance() {
            return Err(Error::Promise(format!(
                "table {}: it reflects {reflected} at {}, more than the {bound} that its models promise",
                plan.name(),
                table.coordinates(texel)
            )));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model;
    use crate::model::compensation::Compensation;
    use crate::table::axis::{Axis, Variable};
    use crate::table::quantity::{Evaluation, FixedDirection, Quantity, RHO_DH};

    /// ρ_hd = ∫ f cos θi dωi with ωe fixed. The bake needs no more than this description of it.
    static RHO_HD: Quantity = Quantity {
        name: "rho_hd",
        symbol: "ρ_hd",
        summary: "hemispherical-directional reflectance",
        variables: &[Variable::ThetaE],
        anisotropic_variables: &[Variable::ThetaE, Variable::PhiI],
        evaluation: Evaluation::Directional(FixedDirection::Exitant),
        ..RHO_DH
    };

    /// Half floats meet their default tolerance and any that is above their rounding, with the check and by the plan alone;
    /// below, the refusal tells the rounding from the rest.
    #[test]
    fn half_floats_meet_what_their_rounding_allows() {
        let ggx = model::find("ggx").unwrap();
        let axes =
            vec![Axis::natural(Variable::Roughness, 3).unwrap(), Axis::natural(Variable::Mu, 5).unwrap()];
        let plan = TablePlan::basis("t", &crate::table::quantity::SPLIT_SUM, ggx, None, axes).unwrap();
        let bake = |tolerance: f64, check| {
            let plan = plan.clone().with_storage(Storage::F16).unwrap().with_tolerance(tolerance).unwrap();
            let table = Evaluator::Cpu.bake(&plan, check, &mut Timings::default(), &Unobserved).unwrap();
            (within_tolerance(&plan, &table), table)
        };
        for (tolerance, check) in
            [1e-3, 2.5e-4].into_iter().flat_map(|t| [(t, Check::Sample(0)), (t, Check::All)])
        {
            let (verdict, table) = bake(tolerance, check);
            assert!(verdict.is_ok(), "{tolerance}, {check:?}: {verdict:?}");
            assert!(table.error.measured_max <= table.error.estimate, "{:?}", table.error);
        }
        let why = bake(1e-4, Check::All).0.unwrap_err().to_string();
        assert!(why.contains("of it by storage as f16"), "{why}");
    }

    /// A new quantity is planned, integrated and compared with the reference by its description alone, and is ρ_dh of
    /// a reciprocal model. A lobe times Turquin's factor is not reciprocal: there the fixed direction decides.
    #[test]
    fn a_quantity_is_what_its_description_says() {
        let bake = |quantity: &'static Quantity, kind: Compensation| {
            let ggx = model::find("ggx-smith-correlated-none").unwrap();
            let axes = vec![Axis::natural(quantity.variables[0], 5).unwrap()];
            let plan = TablePlan::basis("t", quantity, ggx, Some(0.8), axes).unwrap();
            let plan = plan.with_compensation(kind).unwrap();
            let table = Evaluator::Cpu.bake(&plan, Check::All, &mut Timings::default(), &Unobserved).unwrap();
            assert!(table.error.measured_max.unwrap() <= plan.tolerance(), "{:?}", table.error);
            table.values
        };
        assert_eq!(bake(&RHO_HD, Compensation::None), bake(&RHO_DH, Compensation::None));
        assert_ne!(bake(&RHO_HD, Compensation::Turquin), bake(&RHO_DH, Compensation::Turquin));
    }
}
