//! The plan: which tables, over which axes, by which rule. Pure data: printable, comparable,
//! testable without a device.

mod unmeasured;

use crate::base::error::{Error, Result};
use crate::base::precision::{INTEGRAL_F32, Precision, VALUE_F32};
use crate::model::compensation::{Compensation, Factor};
use crate::model::lobe::Lobe;
use crate::model::parameters::Parameters;
use crate::model::parameters::named;
use crate::model::{Integral, Model};
use crate::table::axis::{Axis, Variable};
use crate::table::quantity::{Evaluation, Quantity};
use crate::table::report::Choice;
use crate::table::rule::CHUNK;
use crate::table::rule::{MAX_GAUSS, MAX_GRID, MAX_SAMPLES, Rule};
use crate::table::storage::{Storage, UNORM};
use std::collections::BTreeMap;
use std::fmt;

/// One table to bake: quantity × axes × subject, and how.
#[derive(Debug, Clone, PartialEq)]
pub struct TablePlan {
    /// Unique in its plan.
    pub name: String,
    /// What is tabulated.
    pub quantity: &'static Quantity,
    /// Of what: a model's name (a basis with unit weights) or a material's.
    pub subject: String,
    /// The axes, slowest first: roughness if it is one, then the quantity's variables.
    pub axes: Vec<Axis>,
    /// The channels' names.
    pub channels: Vec<String>,
    /// The lobes whose weighted sum it is.
    pub lobes: Vec<Lobe>,
    /// The rule of its integrals.
    pub rule: Rule,
    /// The error it must not exceed, as stored: absolute for integrals, relative for values.
    pub tolerance: f64,
    /// The format that its values are rounded to.
    pub storage: Storage,
    /// What the optimiser chose: the tolerance then holds for bilinear look-ups.
    pub bilinear: Option<Choice>,
}

impl TablePlan {
    /// A basis: one model with unit weights, its components as channels.
    pub fn basis(
        name: impl Into<String>,
        quantity: &'static Quantity,
        model: &'static Model,
        roughness: Option<f64>,
        axes: Vec<Axis>,
    ) -> Result<Self> {
        let unit = [[1.0, 0.0], [0.0, 1.0]];
        let plan = Self {
            name: name.into(),
            quantity,
            subject: model.name.into(),
            axes,
            channels: model.components.iter().map(|c| c.name.to_string()).collect(),
            lobes: vec![Lobe::new(model, roughness, unit[..model.components.len()].to_vec())],
            rule: Rule::Warped,
            tolerance: DEFAULT_TOLERANCE,
            storage: Storage::F32,
            bilinear: None,
        };
        plan.checked()
    }

    /// The same table by another rule.
    pub fn with_rule(self, rule: Rule) -> Result<Self> {
        Self { rule, ..self }.checked()
    }

    /// The same of lobes with energy compensation. What comes back is not linear in F0 and F90, so that a basis must
    /// have one component.
    ///
    /// # Errors
    /// When a lobe is none of microfacets, or has several components.
    pub fn with_compensation(mut self, compensation: Compensation) -> Result<Self> {
        if compensation == Compensation::None {
            return Ok(self);
        }
        if self.is_basis() && self.channels.len() > 1 {
            return Err(Error::input(format!(
                "table \"{}\": with compensation {} is not linear in F0 and F90; tabulate a material, or take \
                 another fresnel, such as none",
                self.name, self.subject
            )));
        }
        let lobes = self.lobes.into_iter().map(|lobe| compensation.lobes(lobe));
        self.lobes = lobes.collect::<Result<Vec<_>>>()?.into_iter().flatten().collect();
        self.subject = format!("{}-{}", self.subject, compensation.name());
        self.checked()
    }

    /// The same table with some of its model's parameters, by name.
    ///
    /// # Errors
    /// When a lobe's model has none of this name, or the value is outside its range.
    pub fn with_parameters(mut self, parameters: &[(String, f64)]) -> Result<Self> {
        for lobe in &mut self.lobes {
            for (name, value) in parameters {
                lobe.set(name, *value)?;
            }
        }
        self.checked()
    }

    /// The same with all of them, each in its place.
    pub(crate) fn with_places(mut self, parameters: Parameters) -> Self {
        self.lobes.iter_mut().for_each(|lobe| lobe.parameters = parameters);
        self
    }

    /// The same table with another tolerance.
    pub fn with_tolerance(self, tolerance: f64) -> Self {
        Self { tolerance, ..self }
    }

    /// The same table in another format.
    pub fn with_storage(self, storage: Storage) -> Self {
        Self { storage, ..self }
    }

    /// What the rule may be off by: a tenth of the tolerance where rounding and look-ups take the rest.
    pub(crate) fn rule_tolerance(&self) -> f64 {
        match self.storage {
            Storage::Unorm16 => (0.1 * self.tolerance).min(UNORM_RULE),
            Storage::F16 => 0.1 * self.tolerance,
            _ if self.bilinear.is_some() => 0.1 * self.tolerance,
            _ => self.tolerance,
        }
    }

    /// The plan, if it can be carried out: axes that fit the quantity and the lobes, α in range.
    pub(crate) fn checked(self) -> Result<Self> {
        let refuse = |why: String| Err(Error::input(format!("table \"{}\": {why}", self.name)));
        let variables: Vec<_> = self.axes.iter().map(|axis| axis.variable).collect();
        let swept = variables.first() == Some(&Variable::Roughness);
        let anisotropic = self.lobes.iter().any(|lobe| lobe.model.is_anisotropic());
        let given = &variables[usize::from(swept)..];
        let wanted = self.quantity.variables(anisotropic || given.contains(&Variable::PhiI));
        if given != wanted {
            let names: Vec<_> = wanted.iter().map(|v| v.name()).collect();
            return refuse(format!(
                "{} runs over ({}), after roughness if that is an axis",
                self.quantity.name,
                names.join(", ")
            ));
        }
        for lobe in &self.lobes {
            let model = lobe.model;
            if let Some(why) = model.refused(&lobe.parameters) {
                return refuse(format!("{}: {why}", model.name));
            }
            for of in lobe.factors.iter().filter_map(Factor::albedo) {
                if let Some(why) = of.refused() {
                    return refuse(format!("{} has no albedo: {why}", of.model.name));
                }
                if of.model.shape.is_some() && !swept && of.roughness.or(lobe.roughness).is_none() {
                    return refuse(format!("the albedo of {} needs a roughness", of.model.name));
                }
            }
            if model.shape.is_some() && !swept && lobe.roughness.is_none() {
                return refuse(format!("{} needs a roughness: give a value or an axis", model.name));
            }
            let alphas = self.alphas(lobe);
            let value = self.quantity.evaluation == Evaluation::Value;
            if value && model.is_delta() {
                return refuse(format!("{} is a delta and has no values; tabulate rho_dh", model.name));
            }
            if let (false, Integral::Unbounded(why)) = (value, model.integral) {
                return refuse(format!("{} has no {}: {why}; tabulate brdf", model.name, self.quantity.name));
            }
            let Some((shape, low)) = model.shape.zip(alphas.iter().copied().reduce(f64::min)) else {
                continue;
            };
            let name = shape.name;
            if value && low < shape.least {
                return refuse(format!(
                    "{name} = {low} has no finite values (a delta in the limit); start at roughness {}",
                    shape.roughness(shape.least)
                ));
            }
            if self.rule.nodes().is_some() && low < shape.least {
                return refuse(format!(
                    "the {} rule cannot see a lobe of {name} = {low}; use the warped rule",
                    self.rule.name()
                ));
            }
        }
        if swept && !self.lobes.iter().any(|lobe| lobe.model.shape.is_some()) {
            return refuse(format!("{} has no roughness to be an axis", self.subject));
        }
        // Counts multiply beyond any integer.
        let count = |n: u64, axis: &Axis| n.checked_mul(axis.len() as u64);
        let values = self.axes.iter().try_fold(self.channels.len() as u64, count);
        let streams = self.can_stream();
        // Texels are indexed by usize, which has 32 bits on some targets.
        let most = if streams { MAX_STREAMED.min(usize::MAX as u64) } else { MAX_VALUES };
        if values.is_none_or(|n| n > most) {
            let value = self.quantity.evaluation == Evaluation::Value;
            let more = match value && !streams {
                true => {
                    format!(
                        ", or store it as f32, to {:.1e} or more: then it need not fit memory",
                        self.value_f32()
                    )
                }
                false => String::new(),
            };
            return refuse(format!("it has more than {most} values; take fewer samples{more}"));
        }
        let factors = self.factors();
        if factors > MAX_FACTORS {
            return refuse(format!(
                "its directions make {factors} pairs, and at most {MAX_FACTORS} fit every device; take fewer \
                 samples of θ or μ, or a coarser grid"
            ));
        }
        if let Err(why) = self.check_rule() {
            return refuse(why);
        }
        Ok(self)
    }

    /// Why the rule does not fit the quantity and the lobes, if it does not.
    fn check_rule(&self) -> Result<(), String> {
        let name = self.rule.name();
        if let Some([theta, phi]) = self.rule.nodes() {
            let most = if matches!(self.rule, Rule::Gauss { .. }) { MAX_GAUSS } else { MAX_GRID };
            if !(1..=most).contains(&theta) || !(2..=most).contains(&phi) || phi % 2 == 1 {
                return Err(format!(
                    "a {name} of {theta} × {phi}; give θ from 1 to {most}, and φ from 2 to {most}, even"
                ));
            }
        }
        if let Some(samples) = self.rule.samples()
            && (samples == 0 || samples > MAX_SAMPLES || samples > CHUNK && samples % CHUNK != 0)
        {
            return Err(format!(
                "{samples} samples; give 1 to {CHUNK}, or a multiple of it up to {MAX_SAMPLES}"
            ));
        }
        for Lobe { model, factors, .. } in &self.lobes {
            if !factors.is_empty()
                && self.rule != Rule::Warped
                && self.quantity.evaluation != Evaluation::Value
            {
                return Err(format!(
                    "the {name} rule does not do a lobe times a factor; use the warped rule"
                ));
            }
            let fits = match model.integral {
                Integral::Slopes(_) => model.has_samplers() || self.rule.samples().is_none(),
                Integral::Smooth(_) | Integral::Kinked(_) | Integral::Mapped(_) => {
                    self.rule.samples().is_none()
                }
                Integral::Delta(_) => matches!(self.rule, Rule::Warped | Rule::Grid { .. }),
                Integral::Unbounded(_) => self.quantity.evaluation == Evaluation::Value,
            };
            let fits = fits && (!model.is_anisotropic() || self.rule == Rule::Warped);
            if !fits {
                let what = match model.integral {
                    _ if model.is_anisotropic() => "anisotropic",
                    Integral::Delta(_) => "a delta",
                    Integral::Slopes(_) | Integral::Mapped(_) => "a lobe without samplers",
                    _ => "no microfacet lobe",
                };
                return Err(format!(
                    "{} is {what}, and nothing for the {name} rule; use the warped rule",
                    model.name
                ));
            }
        }
        Ok(())
    }

    /// Factors that an evaluator holds at once: one for each pair of directions, given or of nodes.
    fn factors(&self) -> usize {
        /// No less than any warped rule has in one of its dimensions.
        const NODES: usize = 64;
        let count = |axis: Option<&Axis>| axis.map_or(1, Axis::len);
        let nodes = self.rule.nodes().map_or(NODES, |[theta, _]| theta);
        match self.quantity.evaluation {
            Evaluation::Value => {
                count(self.axis(Variable::ThetaI)).saturating_mul(count(self.axis(Variable::ThetaE)))
            }
            Evaluation::Directional => {
                let azimuths = count(self.axis(Variable::PhiI));
                let fixed = self.axis(Variable::Mu).or_else(|| self.axis(Variable::ThetaI));
                count(fixed).saturating_mul(azimuths).saturating_mul(nodes)
            }
            Evaluation::Hemispherical => NODES.saturating_mul(nodes),
        }
    }

    /// The relative error of its values in f32: that of its lobes' models.
    pub(crate) fn value_f32(&self) -> f64 {
        self.lobes.iter().map(|lobe| self.lobe_f32(lobe)).fold(VALUE_F32, f64::max)
    }

    /// That of one lobe, at the worst of its settings.
    fn lobe_f32(&self, lobe: &Lobe) -> f64 {
        let settings = lobe.settings(&self.alphas(lobe));
        settings.iter().map(|s| lobe.model.value_f32_at(s)).fold(0.0, f64::max)
    }

    /// The least tolerance of its integrals in f32. Where α differ by a ratio, values are off by it where the half vector
    /// is near the larger one's axis, which is little of an integral until the ratio is above a hundred: measured.
    fn integral_f32(&self) -> f64 {
        let of = |lobe: &Lobe| {
            let stretched = (self.lobe_f32(lobe) / lobe.model.value_f32 / 20.0).max(1.0);
            let factors: f64 = lobe.factors.iter().map(Factor::rho_bound).product();
            let settings = lobe.settings(&self.alphas(lobe));
            let least = settings.iter().map(|s| lobe.model.integral_f32_at(s)).fold(INTEGRAL_F32, f64::max);
            least * stretched * factors.max(1.0)
        };
        self.lobes.iter().map(of).fold(INTEGRAL_F32, f64::max)
    }

    /// The least arithmetic that meets the tolerance: f32 has a floor, of some hundred roundings in an
    /// integral and of [`VALUE_F32`] in a value.
    pub fn precision(&self) -> Precision {
        let floor = match self.quantity.evaluation {
            Evaluation::Value => self.value_f32(),
            _ => self.integral_f32(),
        };
        if self.tolerance < floor { Precision::F64 } else { Precision::F32 }
    }

    /// The format that values are stored in: f64 where f32 is asked for and cannot meet the tolerance.
    pub fn stored(&self) -> Storage {
        match (self.storage, self.precision()) {
            (Storage::F32, Precision::F64) => Storage::F64,
            (storage, _) => storage,
        }
    }

    /// Whether it can be baked and written piece by piece: values, in f32 throughout.
    pub(crate) fn can_stream(&self) -> bool {
        self.quantity.evaluation == Evaluation::Value
            && self.precision() == Precision::F32
            && self.stored() == Storage::F32
    }

    /// Refuses what is too large for one piece.
    pub(crate) fn check_fits_memory(&self) -> Result<()> {
        if self.texels() as u64 * self.channels.len() as u64 <= MAX_VALUES {
            return Ok(());
        }
        Err(Error::input(format!(
            "table \"{}\": it has more than {MAX_VALUES} values, too many for one piece; take fewer samples, or \
             bake it as part of a set, which streams values in f32",
            self.name
        )))
    }

    /// Samples along each axis, slowest first.
    pub fn shape(&self) -> Vec<usize> {
        self.axes.iter().map(Axis::len).collect()
    }

    /// Number of texels.
    pub fn texels(&self) -> usize {
        self.shape().iter().product()
    }

    /// Whether it is of a model with unit weights. The subject's name does not tell: a material may be
    /// named like a model.
    pub fn is_basis(&self) -> bool {
        matches!(&self.lobes[..], [lobe] if lobe.factors.is_empty() && self.channels.iter().eq(lobe.model.components.iter().map(|c| c.name)))
    }

    /// The axis of a variable, if the table has it.
    pub fn axis(&self, variable: Variable) -> Option<&Axis> {
        self.axes.iter().find(|axis| axis.variable == variable)
    }

    /// The shape of a lobe, in its model's own measure, along the table's slowest axis; one value without a
    /// roughness axis.
    pub fn alphas(&self, lobe: &Lobe) -> Vec<f64> {
        let swept = self.axis(Variable::Roughness).map(|axis| axis.values.clone());
        let roughness = swept.unwrap_or_else(|| vec![lobe.roughness.unwrap_or(0.0)]);
        roughness.into_iter().map(|r| lobe.model.measure(r)).collect()
    }

    /// Parameters that are the same for the whole table.
    pub fn parameters(&self) -> BTreeMap<String, f64> {
        let fixed = |lobe: &Lobe| {
            let rest = named(lobe.model, &lobe.parameters);
            lobe.roughness.map(|r| ("roughness", r)).into_iter().chain(rest).collect::<Vec<_>>()
        };
        let several = self.lobes.iter().filter(|lobe| !fixed(lobe).is_empty()).count() > 1;
        let name = |k, name: &str| if several { format!("lobes[{k}].{name}") } else { name.into() };
        let lobes = self.lobes.iter().enumerate();
        lobes.flat_map(|(k, lobe)| fixed(lobe).into_iter().map(move |(n, x)| (name(k, n), x))).collect()
    }
}

/// A quarter of unorm16's step: the rule may then not lift a 1 beyond what rounds to 1.
pub(crate) const UNORM_RULE: f64 = 0.25 / UNORM;

/// The tolerance where nobody names one.
pub const DEFAULT_TOLERANCE: f64 = 1e-4;

/// The most values of a table in one piece: 1 GiB in f32, and 2 more in f64.
const MAX_VALUES: u64 = 1 << 28;

/// The most values of a table that streams, so need not fit memory: 32 GiB as stored, and the device
/// counts its quads in 32 bits.
const MAX_STREAMED: u64 = 1 << 33;

/// The most factors of a table: 32 bytes each in the 128 MiB that every device binds.
const MAX_FACTORS: usize = 1 << 22;

impl fmt::Display for TablePlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {} of {}", self.name, self.quantity.name, self.subject)?;
        for (k, axis) in self.axes.iter().enumerate() {
            let [a, b] = axis.range;
            let open = if k == 0 { " over " } else { " × " };
            write!(f, "{open}{} {} [{a:.4}, {b:.4}]", axis.variable.name(), axis.len())?;
        }
        if self.quantity.evaluation != Evaluation::Value {
            write!(f, ", {}", self.rule)?;
        }
        if self.storage != Storage::F32 {
            write!(f, ", stored as {}", self.storage.name())?;
        }
        write!(f, ", to {:e}", self.tolerance)?;
        match &self.bilinear {
            Some(choice) => write!(f, " bilinearly: {choice}"),
            None => Ok(()),
        }
    }
}
