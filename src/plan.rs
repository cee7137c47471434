//! The plan: which tables, over which axes, by which rule. Pure data: printable, comparable,
//! testable without a device.

mod requirements;

pub use requirements::{Basis, MaterialPlan, Plan, Selection};

use crate::axis::{Axis, Variable};
use crate::error::{Error, Result};
use crate::models::{ALPHA_MIN_VALUE, Model};
use crate::quantity::{Evaluation, Quantity};
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
    /// The error it must not exceed: absolute for integrals, relative for values.
    pub tolerance: f64,
}

/// A lobe of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Lobe {
    /// The model.
    pub model: &'static Model,
    /// Perceptual roughness where the table has no roughness axis; unused by models without one.
    pub roughness: Option<f64>,
    /// For each channel, the weights of the components A and B.
    pub weights: Vec<[f64; 2]>,
}

/// How integrals are done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// Where the lobe lives, up to the exact horizon: each model's own map.
    Warped,
    /// The definition: midpoints over (θ, φ), each times its cell's projected solid angle.
    Grid {
        /// Cells in θ ∈ [0, π/2].
        theta: usize,
        /// Cells in φ ∈ [0, 2π); even, as the two halves are alike.
        phi: usize,
    },
}

impl fmt::Display for Rule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Warped => f.write_str("warped"),
            Self::Grid { theta, phi } => write!(f, "grid {theta} θ × {phi} φ"),
        }
    }
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
            lobes: vec![Lobe { model, roughness, weights: unit[..model.components.len()].to_vec() }],
            rule: Rule::Warped,
            tolerance: DEFAULT_TOLERANCE,
        };
        plan.checked()
    }

    /// The same table by another rule.
    pub fn with_rule(self, rule: Rule) -> Result<Self> {
        Self { rule, ..self }.checked()
    }

    /// The same table with another tolerance.
    pub fn with_tolerance(self, tolerance: f64) -> Self {
        Self { tolerance, ..self }
    }

    /// The plan, if it can be carried out: axes that fit the quantity and the lobes, α in range.
    fn checked(self) -> Result<Self> {
        let refuse = |why: String| Err(Error::input(format!("table \"{}\": {why}", self.name)));
        let variables: Vec<_> = self.axes.iter().map(|axis| axis.variable).collect();
        let swept = variables.first() == Some(&Variable::Roughness);
        if variables[usize::from(swept)..] != *self.quantity.variables {
            let names: Vec<_> = self.quantity.variables.iter().map(|v| v.name()).collect();
            return refuse(format!(
                "{} runs over ({}), after roughness if that is an axis",
                self.quantity.name,
                names.join(", ")
            ));
        }
        for lobe in &self.lobes {
            let model = lobe.model;
            if model.has_roughness && !swept && lobe.roughness.is_none() {
                return refuse(format!("{} needs a roughness: give a value or an axis", model.name));
            }
            let alphas = self.alphas(lobe);
            let value = self.quantity.evaluation == Evaluation::Value;
            if value && model.is_delta() {
                return refuse(format!("{} is a delta and has no values; tabulate rho_dh", model.name));
            }
            let Some(low) = alphas.iter().copied().reduce(f64::min).filter(|_| model.has_roughness) else {
                continue;
            };
            if value && low < ALPHA_MIN_VALUE {
                return refuse(format!(
                    "α = {low} has no finite values (a delta in the limit); start at roughness {}",
                    ALPHA_MIN_VALUE.sqrt()
                ));
            }
            if matches!(self.rule, Rule::Grid { .. }) && low < ALPHA_MIN_VALUE {
                return refuse(format!("the grid rule cannot see a lobe of α = {low}; use the warped rule"));
            }
        }
        if swept && !self.lobes.iter().any(|lobe| lobe.model.has_roughness) {
            return refuse(format!("{} has no roughness to be an axis", self.subject));
        }
        // Counts multiply beyond any usize.
        let values = self.axes.iter().try_fold(self.channels.len(), |n, axis| n.checked_mul(axis.len()));
        let most = if self.quantity.evaluation == Evaluation::Value { MAX_STREAMED } else { MAX_VALUES };
        if values.is_none_or(|n| n > most) {
            return refuse(format!("it has more than {most} values; take fewer samples"));
        }
        let factors = self.factors();
        if factors > MAX_FACTORS {
            return refuse(format!(
                "its directions make {factors} pairs, and at most {MAX_FACTORS} fit every device; take fewer \
                 samples of θ or μ, or a coarser grid"
            ));
        }
        if let Rule::Grid { theta, phi } = self.rule {
            let hemispherical = self.quantity.evaluation == Evaluation::Hemispherical;
            let most = if hemispherical { MAX_GRID_RHO_HH } else { MAX_GRID };
            let fits = (1..=most).contains(&theta) && (2..=MAX_GRID).contains(&phi);
            if !fits || phi % 2 == 1 {
                return refuse(format!(
                    "a grid of {theta} × {phi}; give θ from 1 to {most}, and φ from 2 to {MAX_GRID}, even"
                ));
            }
        }
        Ok(self)
    }

    /// Factors that an evaluator holds at once: one for each pair of directions, given or of nodes.
    fn factors(&self) -> usize {
        /// No less than any warped rule has in one of its dimensions.
        const NODES: usize = 64;
        let count = |axis: Option<&Axis>| axis.map_or(1, Axis::len);
        let nodes = if let Rule::Grid { theta, .. } = self.rule { theta } else { NODES };
        match self.quantity.evaluation {
            Evaluation::Value => {
                count(self.axis(Variable::ThetaI)).saturating_mul(count(self.axis(Variable::ThetaE)))
            }
            Evaluation::Directional => count(self.axes.last()).saturating_mul(nodes),
            Evaluation::Hemispherical => NODES.saturating_mul(nodes),
        }
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
        matches!(&self.lobes[..], [lobe] if self.channels.iter().eq(lobe.model.components.iter().map(|c| c.name)))
    }

    /// The axis of a variable, if the table has it.
    pub fn axis(&self, variable: Variable) -> Option<&Axis> {
        self.axes.iter().find(|axis| axis.variable == variable)
    }

    /// α = roughness² of a lobe along the table's slowest axis; one value without a roughness axis.
    pub fn alphas(&self, lobe: &Lobe) -> Vec<f64> {
        let swept = self.axis(Variable::Roughness).map(|axis| axis.values.clone());
        let roughness = swept.unwrap_or_else(|| vec![lobe.roughness.unwrap_or(0.0)]);
        roughness.into_iter().map(|r| r * r).collect()
    }

    /// Parameters that are the same for the whole table.
    pub fn parameters(&self) -> BTreeMap<String, f64> {
        let fixed = |lobe: &Lobe| Some(("roughness".to_string(), lobe.roughness?));
        let several = self.lobes.iter().filter(|l| l.roughness.is_some()).count() > 1;
        self.lobes
            .iter()
            .enumerate()
            .filter_map(|(k, lobe)| {
                let (name, value) = fixed(lobe)?;
                Some((if several { format!("lobes[{k}].{name}") } else { name }, value))
            })
            .collect()
    }
}

/// The tolerance where nobody names one.
pub const DEFAULT_TOLERANCE: f64 = 1e-4;

/// The most values of a table of integrals: 1 GiB as stored, and 2 more in f64 on the CPU path.
const MAX_VALUES: usize = 1 << 28;

/// The most values of a table of values, which need not fit memory: 32 GiB as stored, and the device
/// counts its quads in 32 bits.
const MAX_STREAMED: usize = 1 << 33;

/// The most factors of a table: 32 bytes each in the 128 MiB that every device binds.
const MAX_FACTORS: usize = 1 << 22;

/// The finest grid rule: one invocation's loop must stay below what every driver runs.
pub(crate) const MAX_GRID: usize = 16_384;
/// The finest θ of a grid under the mean over directions, which one invocation sums as well.
const MAX_GRID_RHO_HH: usize = 512;

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
        write!(f, ", to {:e}", self.tolerance)
    }
}
