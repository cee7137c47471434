//! The plan of a table: its quantity, axes, lobes, rule and tolerance. A plan is pure data: printable, comparable,
//! testable without a device.

mod unmeasured;

use crate::base::error::{Error, Result};
use crate::base::precision::{INTEGRAL_F32, Precision, VALUE_F32};
use crate::base::tolerance::{LEAST_BEFORE_STORAGE, RULE_SHARE, Tolerance, UNORM_RULE};
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
use crate::table::storage::Storage;
use std::collections::BTreeMap;
use std::fmt;

/// The plan of one table: quantity × axes × subject, its rule, tolerance and storage.
///
/// A plan is checked when it is made and immutable from then on: each `with_…` returns another one, checked again.
#[derive(Debug, Clone, PartialEq)]
pub struct TablePlan {
    name: String,
    quantity: &'static Quantity,
    subject: String,
    axes: Vec<Axis>,
    channels: Vec<String>,
    lobes: Vec<Lobe>,
    rule: Rule,
    tolerance: Tolerance,
    storage: Storage,
    bilinear: Option<Choice>,
    decisions: Decisions,
}

/// The decisions that follow from the tolerance, made once when a plan is made (see [`tolerance`](crate::base::tolerance)).
#[derive(Debug, Clone, Copy, PartialEq)]
struct Decisions {
    /// The tolerance of the quadrature rule.
    rule_tolerance: f64,
    /// The least precision that meets the tolerance.
    precision: Precision,
    /// The format that values are stored in.
    stored: Storage,
}

impl TablePlan {
    /// Plans the table of a weighted sum of lobes, with one pair of weights of each lobe for each channel, by the warped
    /// rule, to the default tolerance, stored as f32.
    ///
    /// `axes` are the quantity's variables, slowest first, after roughness if that is one.
    ///
    /// # Errors
    /// When there is no lobe, the weights do not fit the channels, or the axes do not fit the quantity and the lobes.
    pub fn new(
        name: impl Into<String>,
        quantity: &'static Quantity,
        subject: impl Into<String>,
        channels: Vec<String>,
        lobes: Vec<Lobe>,
        axes: Vec<Axis>,
    ) -> Result<Self> {
        let decisions = Decisions { rule_tolerance: 0.0, precision: Precision::F32, stored: Storage::F32 };
        let plan = Self {
            name: name.into(),
            quantity,
            subject: subject.into(),
            axes,
            channels,
            lobes,
            rule: Rule::Warped,
            tolerance: Tolerance::DEFAULT,
            storage: Storage::F32,
            bilinear: None,
            decisions,
        };
        plan.checked()
    }

    /// Plans a basis: one model with unit weights, its components as channels.
    ///
    /// # Errors
    /// When the roughness is outside [0, 1], or the axes do not fit the quantity and the model.
    pub fn basis(
        name: impl Into<String>,
        quantity: &'static Quantity,
        model: &'static Model,
        roughness: Option<f64>,
        axes: Vec<Axis>,
    ) -> Result<Self> {
        let unit = [[1.0, 0.0], [0.0, 1.0]];
        let lobe = Lobe::new(model, roughness, unit[..model.components.len()].to_vec())?;
        let channels = model.components.iter().map(|c| c.name.to_string()).collect();
        Self::new(name, quantity, model.name, channels, vec![lobe], axes)
    }

    /// The table under another name.
    pub fn with_name(self, name: impl Into<String>) -> Self {
        Self { name: name.into(), ..self }
    }

    /// The table under another subject, the name that manifests give it.
    pub fn with_subject(self, subject: impl Into<String>) -> Self {
        Self { subject: subject.into(), ..self }
    }

    /// The table by another rule.
    ///
    /// # Errors
    /// When the rule does not fit the quantity or a lobe.
    pub fn with_rule(self, rule: Rule) -> Result<Self> {
        Self { rule, ..self }.checked()
    }

    /// The table over other axes.
    ///
    /// # Errors
    /// When the axes do not fit the quantity and the lobes.
    pub fn with_axes(self, axes: Vec<Axis>) -> Result<Self> {
        Self { axes, ..self }.checked()
    }

    /// The table of other lobes.
    ///
    /// # Errors
    /// When there is none, or the weights do not fit the channels.
    pub fn with_lobes(self, lobes: Vec<Lobe>) -> Result<Self> {
        Self { lobes, ..self }.checked()
    }

    /// The table of lobes with energy compensation. The compensated sum is not linear in F0 and F90, so a basis must have
    /// one component.
    ///
    /// # Errors
    /// When a lobe is no microfacet lobe, or has several components.
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

    /// The table with some of its models' parameters, by name.
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

    /// The table with all parameters of its lobes, each at its index.
    pub(crate) fn with_all_parameters(mut self, parameters: Parameters) -> Result<Self> {
        self.lobes = self.lobes.into_iter().map(|lobe| lobe.with_parameters(parameters)).collect();
        self.checked()
    }

    /// The table to another tolerance: the largest error of its stored values, absolute for integrals, relative for values.
    ///
    /// # Errors
    /// When it is not finite or not above 0, or the table is too large for the arithmetic that it then takes.
    pub fn with_tolerance(self, tolerance: f64) -> Result<Self> {
        let tolerance =
            Tolerance::new(tolerance).map_err(|why| why.at(format_args!("table \"{}\"", self.name)))?;
        Self { tolerance, ..self }.checked()
    }

    /// The table in another format.
    ///
    /// # Errors
    /// When the table is too large for it.
    pub fn with_storage(self, storage: Storage) -> Result<Self> {
        Self { storage, ..self }.checked()
    }

    /// The table in a layout that was chosen for bilinear look-ups.
    #[cfg(feature = "check")]
    pub(crate) fn with_layout(self, axes: Vec<Axis>, storage: Storage, choice: Choice) -> Result<Self> {
        Self { axes, storage, bilinear: Some(choice), ..self }.checked()
    }

    /// The table at other samples of its own axes, for a comparison. The plan is not checked again, as nobody bakes it.
    #[cfg(feature = "check")]
    pub(crate) fn at_samples(&self, axes: Vec<Axis>) -> Self {
        Self { axes, ..self.clone() }.decided()
    }

    /// The table by the warped rule at other samples of its own axes, to another tolerance, unrounded.
    #[cfg(feature = "check")]
    pub(crate) fn exact_at_samples(&self, axes: Vec<Axis>, tolerance: Tolerance) -> Self {
        let exact = Self {
            axes,
            rule: Rule::Warped,
            tolerance,
            storage: Storage::F32,
            bilinear: None,
            ..self.clone()
        };
        exact.decided()
    }

    /// The name, unique in a set of tables.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The quantity that is tabulated.
    pub fn quantity(&self) -> &'static Quantity {
        self.quantity
    }

    /// The subject: a model's name (a basis with unit weights) or a material's.
    pub fn subject(&self) -> &str {
        &self.subject
    }

    /// The axes, slowest first: roughness if it is one, then the quantity's variables.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// The channels' names.
    pub fn channels(&self) -> &[String] {
        &self.channels
    }

    /// The lobes whose weighted sum the table holds.
    pub fn lobes(&self) -> &[Lobe] {
        &self.lobes
    }

    /// The rule of its integrals.
    pub fn rule(&self) -> Rule {
        self.rule
    }

    /// The largest error of the stored values: absolute for integrals, relative for values.
    pub fn tolerance(&self) -> f64 {
        self.tolerance.get()
    }

    /// The storage format that was asked for; [`TablePlan::stored`] is the one that the tolerance takes.
    pub fn storage(&self) -> Storage {
        self.storage
    }

    /// The layout that was chosen for bilinear look-ups, for which the tolerance then holds.
    pub fn bilinear(&self) -> Option<&Choice> {
        self.bilinear.as_ref()
    }

    /// The tolerance of the quadrature rule, a share of the table's.
    pub(crate) fn rule_tolerance(&self) -> f64 {
        self.decisions.rule_tolerance
    }

    /// The tolerance that rounding to storage leaves to integrals: a hundredth at least, as values may round by less than
    /// their bound.
    pub(crate) fn tolerance_before_storage(&self) -> f64 {
        let tolerance = self.tolerance.get();
        (tolerance - self.storage.coarse_rounding(self.rho_bound())).max(LEAST_BEFORE_STORAGE * tolerance)
    }

    /// The bound on what the table's lobes reflect together.
    pub(crate) fn rho_bound(&self) -> f64 {
        // A lobe of multiple scattering makes up for the loss of another lobe, whose bound covers both.
        let compensates = |lobe: &Lobe| lobe.factors().iter().any(Factor::is_missing);
        let alone = self.lobes.iter().all(compensates);
        let bound = |lobe: &Lobe| {
            lobe.weights().as_flattened().iter().copied().fold(0.0, f64::max) * lobe.rho_bound()
        };
        self.lobes.iter().filter(|lobe| alone || !compensates(lobe)).map(bound).sum()
    }

    /// The least precision that meets the tolerance: f32 has a floor, of some hundred roundings in an integral and of
    /// [`VALUE_F32`] in a value.
    pub fn precision(&self) -> Precision {
        self.decisions.precision
    }

    /// The format that values are stored in: f64 where f32 is asked for and cannot meet the tolerance.
    pub fn stored(&self) -> Storage {
        self.decisions.stored
    }

    /// The plan with the decisions that follow from its tolerance.
    fn decided(mut self) -> Self {
        let tolerance = self.tolerance.get();
        let floor = if self.quantity.is_value() { self.value_f32() } else { self.integral_f32() };
        let precision = if tolerance < floor { Precision::F64 } else { Precision::F32 };
        let rule_tolerance = match self.storage {
            Storage::Unorm16 => (RULE_SHARE * tolerance).min(UNORM_RULE),
            Storage::F16 => (RULE_SHARE * tolerance).min(self.tolerance_before_storage()),
            _ if self.bilinear.is_some() => RULE_SHARE * tolerance,
            _ => tolerance,
        };
        let stored = match (self.storage, precision) {
            (Storage::F32, Precision::F64) => Storage::F64,
            (storage, _) => storage,
        };
        self.decisions = Decisions { rule_tolerance, precision, stored };
        self
    }

    /// The plan, if an evaluator can carry it out: its axes fit the quantity and the lobes, and α is in range.
    fn checked(self) -> Result<Self> {
        let this = self.decided();
        this.check()?;
        Ok(this)
    }

    /// Refuses a plan that no evaluator can carry out.
    fn check(&self) -> Result<()> {
        let refuse = |why: String| Err(Error::input(format!("table \"{}\": {why}", self.name)));
        if let Some(why) = self.quantity.refused() {
            return refuse(why);
        }
        let variables: Vec<_> = self.axes.iter().map(|axis| axis.variable()).collect();
        let swept = variables.first() == Some(&Variable::Roughness);
        let anisotropic = self.lobes.iter().any(|lobe| lobe.model().is_anisotropic());
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
        if self.lobes.is_empty() {
            return refuse("it has no lobe; give one or more".into());
        }
        if !(1..=3).contains(&self.channels.len()) {
            return refuse(format!("it has {} channels; give 1 to 3", self.channels.len()));
        }
        if let Some(lobe) = self.lobes.iter().find(|lobe| lobe.weights().len() != self.channels.len()) {
            return refuse(format!(
                "{} has weights for {} channels of {}; give one pair of weights for each channel",
                lobe.model().name,
                lobe.weights().len(),
                self.channels.len()
            ));
        }
        for lobe in &self.lobes {
            let model = lobe.model();
            if let Some(why) = model.refused(&lobe.parameters()) {
                return refuse(format!("{}: {why}", model.name));
            }
            for albedo in lobe.factors().iter().filter_map(Factor::albedo) {
                let name = albedo.model.name;
                if let Some(why) = albedo.refused() {
                    return refuse(format!("{name} has no albedo: {why}"));
                }
                if albedo.model.shape.is_some() && !swept && albedo.roughness.or(lobe.roughness()).is_none() {
                    return refuse(format!("the albedo of {name} needs a roughness"));
                }
            }
            if model.shape.is_some() && !swept && lobe.roughness().is_none() {
                return refuse(format!("{} needs a roughness: give a value or an axis", model.name));
            }
            let alphas = self.alphas(lobe);
            let value = self.quantity.is_value();
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
        if swept && !self.lobes.iter().any(|lobe| lobe.model().shape.is_some()) {
            return refuse(format!("{} has no roughness to be an axis", self.subject));
        }
        // Counts multiply beyond any integer.
        let count = |n: u64, axis: &Axis| n.checked_mul(axis.len() as u64);
        let values = self.axes.iter().try_fold(self.channels.len() as u64, count);
        let streams = self.can_stream();
        // Texels are indexed by usize, which has 32 bits on some targets.
        let limit = if streams { MAX_STREAMED.min(usize::MAX as u64) } else { MAX_VALUES };
        if values.is_none_or(|n| n > limit) {
            let value = self.quantity.is_value();
            let remedy = match value && !streams {
                true => {
                    format!(
                        ", or store it as f32, to {:.1e} or more: then it need not fit memory",
                        self.value_f32()
                    )
                }
                false => String::new(),
            };
            return refuse(format!("it has more than {limit} values; take fewer samples{remedy}"));
        }
        let pairs = self.direction_pairs();
        if pairs > MAX_PAIRS {
            return refuse(format!(
                "its directions make {pairs} pairs, and at most {MAX_PAIRS} fit every device; take fewer \
                 samples of θ or μ, or a coarser grid"
            ));
        }
        if let Err(why) = self.check_rule() {
            return refuse(why);
        }
        Ok(())
    }

    /// Checks that the rule fits the quantity and the lobes, and says why it does not.
    fn check_rule(&self) -> Result<(), String> {
        let name = self.rule.name();
        if let Some([theta, phi]) = self.rule.nodes() {
            let limit = if matches!(self.rule, Rule::Gauss { .. }) { MAX_GAUSS } else { MAX_GRID };
            if !(1..=limit).contains(&theta) || !(2..=limit).contains(&phi) || phi % 2 == 1 {
                return Err(format!(
                    "a {name} of {theta} × {phi}; give θ from 1 to {limit}, and φ from 2 to {limit}, even"
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
        for lobe in &self.lobes {
            let model = lobe.model();
            if !lobe.factors().is_empty() && self.rule != Rule::Warped && self.quantity.is_integral() {
                return Err(format!(
                    "the {name} rule does not do a lobe times a factor; use the warped rule"
                ));
            }
            let fits = match model.integral {
                Integral::Slopes(_) => model.has_samplers() || self.rule.samples().is_none(),
                Integral::Smooth(_) | Integral::Kinked(_) | Integral::Listed(_) => {
                    self.rule.samples().is_none()
                }
                Integral::Delta(_) => matches!(self.rule, Rule::Warped | Rule::Grid { .. }),
                Integral::Unbounded(_) => self.quantity.is_value(),
            };
            let fits = fits && (!model.is_anisotropic() || self.rule == Rule::Warped);
            if !fits {
                let kind = match model.integral {
                    _ if model.is_anisotropic() => "anisotropic",
                    Integral::Delta(_) => "a delta",
                    Integral::Slopes(_) | Integral::Listed(_) => "a lobe without samplers",
                    _ => "no microfacet lobe",
                };
                return Err(format!(
                    "{} is {kind}, and nothing for the {name} rule; use the warped rule",
                    model.name
                ));
            }
        }
        Ok(())
    }

    /// The number of direction pairs whose half-angle terms an evaluator holds at once, over samples and nodes.
    fn direction_pairs(&self) -> usize {
        /// No warped rule has more nodes than this in one of its dimensions.
        const NODES: usize = 64;
        let count = |axis: Option<&Axis>| axis.map_or(1, Axis::len);
        let nodes = self.rule.nodes().map_or(NODES, |[theta, _]| theta);
        match self.quantity.evaluation {
            Evaluation::Value => {
                count(self.axis(Variable::ThetaI)).saturating_mul(count(self.axis(Variable::ThetaE)))
            }
            Evaluation::Directional(_) => {
                let azimuths = count(self.axis(Variable::PhiI));
                let fixed = self.quantity.variables.first().and_then(|&zenith| self.axis(zenith));
                count(fixed).saturating_mul(azimuths).saturating_mul(nodes)
            }
            Evaluation::Hemispherical => NODES.saturating_mul(nodes),
            Evaluation::Light => 0,
        }
    }

    /// The relative error of the table's values in f32: the largest of its lobes'.
    pub(crate) fn value_f32(&self) -> f64 {
        self.lobes.iter().map(|lobe| self.lobe_value_f32(lobe)).fold(VALUE_F32, f64::max)
    }

    /// The relative error of a lobe's values in f32, at the worst of its settings.
    fn lobe_value_f32(&self, lobe: &Lobe) -> f64 {
        let settings = lobe.settings(&self.alphas(lobe));
        settings.iter().map(|s| lobe.model().value_f32_at(s)).fold(0.0, f64::max)
    }

    /// The least tolerance that the table's integrals meet in f32. Where αx and αy differ by a ratio, values are off by it
    /// where the half vector is near the larger one's axis. That is little of an integral until the ratio is above a
    /// hundred, as measured.
    fn integral_f32(&self) -> f64 {
        let lobe_floor = |lobe: &Lobe| {
            let stretched = (self.lobe_value_f32(lobe) / lobe.model().value_f32 / 20.0).max(1.0);
            let factors: f64 = lobe.factors().iter().map(Factor::rho_bound).product();
            let settings = lobe.settings(&self.alphas(lobe));
            let least = settings.iter().map(|s| lobe.model().integral_f32_at(s)).fold(INTEGRAL_F32, f64::max);
            least * stretched * factors.max(1.0)
        };
        self.lobes.iter().map(lobe_floor).fold(INTEGRAL_F32, f64::max)
    }

    /// Whether the table can be baked and written piece by piece: it must hold values, in f32 throughout.
    pub(crate) fn can_stream(&self) -> bool {
        self.quantity.is_value() && self.precision() == Precision::F32 && self.stored() == Storage::F32
    }

    /// Refuses a table that is too large for one piece.
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

    /// The number of samples along each axis, slowest first.
    pub fn shape(&self) -> Vec<usize> {
        self.axes.iter().map(Axis::len).collect()
    }

    /// The number of texels.
    pub fn texels(&self) -> usize {
        self.shape().iter().product()
    }

    /// Whether the subject is a basis, one model with unit weights. The subject's name does not tell: a material may be
    /// named like a model.
    pub fn is_basis(&self) -> bool {
        matches!(&self.lobes[..], [lobe] if lobe.factors().is_empty() && self.channels.iter().eq(lobe.model().components.iter().map(|c| c.name)))
    }

    /// The axis of a variable, if the table has one.
    pub fn axis(&self, variable: Variable) -> Option<&Axis> {
        self.axes.iter().find(|axis| axis.variable() == variable)
    }

    /// The shape of a lobe, in its model's own measure, along the table's slowest axis; one value without a
    /// roughness axis.
    pub fn alphas(&self, lobe: &Lobe) -> Vec<f64> {
        let swept = self.axis(Variable::Roughness).map(|axis| axis.values().to_vec());
        // A model without roughness has one row; a plan refuses a lobe that lacks the roughness it takes.
        let roughness = swept.unwrap_or_else(|| vec![lobe.roughness().unwrap_or(0.0)]);
        roughness.into_iter().map(|r| lobe.model().measure(r)).collect()
    }

    /// The parameters that are the same for the whole table, by name.
    pub fn parameters(&self) -> BTreeMap<String, f64> {
        let fixed = |lobe: &Lobe| {
            let rest = named(lobe.model(), &lobe.parameters());
            lobe.roughness().map(|r| ("roughness", r)).into_iter().chain(rest).collect::<Vec<_>>()
        };
        let several = self.lobes.iter().filter(|lobe| !fixed(lobe).is_empty()).count() > 1;
        let name = |k, name: &str| if several { format!("lobes[{k}].{name}") } else { name.into() };
        let lobes = self.lobes.iter().enumerate();
        lobes.flat_map(|(k, lobe)| fixed(lobe).into_iter().map(move |(n, x)| (name(k, n), x))).collect()
    }
}

/// The largest number of values of a table in one piece: 1 GiB in f32, and 2 more in f64.
const MAX_VALUES: u64 = 1 << 28;

/// The largest number of values of a streamed table, which need not fit memory: 32 GiB as stored, and the device counts
/// quads of values in 32 bits.
const MAX_STREAMED: u64 = 1 << 33;

/// The largest number of direction pairs of a table: 32 bytes each in the 128 MiB that every device binds.
const MAX_PAIRS: usize = 1 << 22;

impl fmt::Display for TablePlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {} of {}", self.name, self.quantity.name, self.subject)?;
        for (k, axis) in self.axes.iter().enumerate() {
            let [a, b] = axis.range();
            let open = if k == 0 { " over " } else { " × " };
            write!(f, "{open}{} {} [{a:.4}, {b:.4}]", axis.variable().name(), axis.len())?;
        }
        if self.quantity.is_integral() {
            write!(f, ", {}", self.rule)?;
        }
        if self.storage != Storage::F32 {
            write!(f, ", stored as {}", self.storage.name())?;
        }
        write!(f, ", to {:e}", self.tolerance.get())?;
        match &self.bilinear {
            Some(choice) => write!(f, " bilinearly: {choice}"),
            None => Ok(()),
        }
    }
}
