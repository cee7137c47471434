//! From what a scene says to what must be baked: bases, not colours; ranges that occur, not all.

use crate::base::error::{Error, Result};
use crate::base::tolerance::Tolerance;
use crate::check::layout_search::optimise;
use crate::model;
use crate::model::compensation::{Compensation, Factor};
use crate::model::lobe::Lobe;
use crate::model::parameters::Parameters;
use crate::model::parameters::named;
use crate::model::{Integral, MODELS, Model};
use crate::plan::TablePlan;
use crate::scene::{
    Distribution, LeftOut, Material, MaterialLobe, Scene, SubjectRequest, TableRequest, Weights,
};
use crate::table::axis::{Axis, Mapping, Positions, Variable};
use crate::table::quantity;
use crate::table::quantity::{BRDF, Quantity, RHO_DH};
use crate::table::rule::Rule;
use crate::table::storage::Storage;
use serde::Serialize;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::f64::consts::FRAC_PI_2;
use std::{fmt, mem};

/// Everything that a scene requires, and what it does not.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The bases that the scene's materials are sums of.
    pub bases: Vec<Basis>,
    /// The materials as weights on bases.
    pub materials: Vec<MaterialPlan>,
    /// The tables to bake.
    pub tables: Vec<TablePlan>,
    /// The error that no table may exceed, where a table does not name its own.
    pub tolerance: f64,
    /// What is not baked, and why.
    pub left_out: Vec<LeftOut>,
    /// What the user should know before trusting the tables.
    pub warnings: Vec<String>,
}

/// A basis: a model and the roughness that the scene's materials give it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Basis {
    /// The model's name.
    pub model: String,
    /// [min, max] of its perceptual roughness.
    pub roughness: Option<[f64; 2]>,
    /// Its other parameters.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub parameters: BTreeMap<&'static str, f64>,
}

/// A material: f = Σ weights · basis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MaterialPlan {
    /// Its name.
    pub name: String,
    /// [min, max] of its perceptual roughness.
    pub roughness: Option<[f64; 2]>,
    /// [min, max] of its metalness, where the scene's format has one.
    pub metallic: Option<[f64; 2]>,
    /// The bases and their weights: numbers, or formulas where textures decide.
    pub weights: Vec<BasisWeight>,
    /// What ρ_dh of the material may reach; above 1 its format does not conserve energy.
    pub rho_bound: f64,
    /// The tables that evaluate it.
    pub tables: Vec<String>,
}

/// What a material multiplies a basis's components with.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BasisWeight {
    /// The model's name.
    pub basis: String,
    /// Its other parameters.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub parameters: BTreeMap<&'static str, f64>,
    /// The weight of each component, by the component's name.
    pub components: BTreeMap<String, Weight>,
    /// What the basis is multiplied with beside, in words; E is a directional albedo.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub factors: Vec<String>,
}

/// One weight.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Weight {
    /// RGB.
    Constant([f64; 3]),
    /// A formula, in the words of the scene's format.
    Textured(String),
}

/// What the user picks out of what the scene requires.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Selection {
    /// Only this material, and the bases that it uses.
    pub material: Option<String>,
    /// Only this quantity.
    pub quantity: Option<String>,
    /// In place of the tolerances of the scene and of its tables.
    pub tolerance: Option<f64>,
}

/// Why a model that the scene does not use is left out.
pub const UNUSED: &str = "nothing in the scene uses it";

/// Twice the rounding of half floats, rounded up.
const HALF_TOLERANCE: f64 = 1e-3;
/// Resolution of the default tables.
const ROUGHNESS: usize = 32;
const MU: usize = 64;
const THETA: usize = 64;
/// θi on n nodes and θe on 2n − 1 put every mirror pair on the grid.
const VALUE_GRID: [usize; 3] = [33, 65, 65];
/// The same of θi, θe and φe; φi has steps of two of φe over a quarter of a turn: every mirror pair is on the grid.
const ANISOTROPIC_GRID: [usize; 3] = [17, 33, 65];
const PHI: usize = 9;

impl Plan {
    /// What `scene` requires, as far as `selection` lets it.
    ///
    /// # Errors
    /// When the selection names what is not there, or a requested table cannot be baked.
    pub fn new(scene: &Scene, selection: &Selection) -> Result<Self> {
        let quantity = selection.quantity.as_deref().map(quantity::find).transpose()?;
        let tolerance = selection.tolerance.or(scene.tolerance).unwrap_or(Tolerance::DEFAULT.get());
        let materials: Vec<_> = match &selection.material {
            Some(name) => vec![scene.material(name)?],
            None => scene.materials.iter().collect(),
        };

        let mut plan = Self {
            bases: Vec::new(),
            materials: Vec::new(),
            tables: Vec::new(),
            tolerance,
            left_out: scene.left_out.clone(),
            warnings: scene.warnings.clone(),
        };
        // Names are names of files, and some file systems ignore case.
        let given = scene.tables.iter().filter_map(|request| request.name.as_deref());
        let mut names = FreeNames { taken: given.map(str::to_lowercase).collect(), next: HashMap::new() };
        let by_name: HashMap<_, _> = scene.materials.iter().map(|m| (m.name.as_str(), m)).collect();
        if scene.tables.is_empty() {
            plan.require_defaults(&materials, tolerance)?;
            plan.tables = mem::take(&mut plan.tables)
                .into_iter()
                .map(|table| {
                    let name = names.take(table.name());
                    table.with_name(name)
                })
                .collect();
        } else {
            for request in &scene.tables {
                let wanted = match (&request.subject, &selection.material) {
                    (SubjectRequest::Material(name), Some(only)) => name == only,
                    (SubjectRequest::Basis { .. }, Some(_)) => false,
                    (_, None) => true,
                };
                if wanted {
                    let mut table = requested(request, scene, &by_name, selection.tolerance)
                        .map_err(|e| e.at(&request.place))?;
                    if request.name.is_none() {
                        let name = names.take(table.name());
                        table = table.with_name(name);
                    }
                    plan.tables.push(table);
                }
            }
        }
        if let Some(only) = quantity {
            plan.tables.retain(|table| table.quantity() == only);
            for other in quantity::of_a_brdf().filter(|&other| other != only) {
                plan.leave_out(other.name, "the selection asks for another quantity");
            }
        }
        // Of materials `describe` says it.
        let is_material = |table: &TablePlan| by_name.contains_key(table.subject());
        let tables = plan.tables.iter().filter(|table| table.is_basis() || !is_material(table));
        let mut bases = Bases::default();
        for lobe in tables.flat_map(|table| table.lobes()) {
            bases.require(lobe.model(), &lobe.parameters(), None);
        }
        plan.describe(&materials, &mut bases)?;
        plan.bases = bases.list;
        for model in MODELS {
            if !plan.bases.iter().any(|basis| basis.model == model.name) {
                plan.leave_out(model.name, UNUSED);
            }
        }
        if plan.tables.is_empty() {
            return Err(Error::input(format!(
                "{}: nothing to bake; it has no material or table that the selection keeps",
                scene.file.display()
            )));
        }
        Ok(plan)
    }

    /// The default set: for each basis in use its split sum, ρ_dh and ρ_hh over the roughness that
    /// occurs and its values at the range's ends and quartiles; RGB tables of constant materials.
    fn require_defaults(&mut self, materials: &[&Material], tolerance: f64) -> Result<()> {
        let mut lobes: HashMap<&str, Vec<&MaterialLobe>> = HashMap::new();
        for lobe in materials.iter().flat_map(|material| &material.lobes) {
            lobes.entry(&lobe.model).or_default().push(lobe);
        }
        for model in model::all() {
            // The different settings, in the order in which they come, and the roughnesses of each.
            let mut settings: Vec<(Parameters, Vec<&Distribution>)> = Vec::new();
            let mut known = HashMap::new();
            for lobe in lobes.get(model.name).into_iter().flatten() {
                for (parameters, _) in settings_of(lobe, model) {
                    let at = *known.entry(bits(&parameters)).or_insert_with(|| {
                        settings.push((parameters, Vec::new()));
                        settings.len() - 1
                    });
                    settings[at].1.extend(&lobe.roughness);
                }
            }
            for (parameters, roughnesses) in settings {
                let range = Distribution::union(roughnesses);
                for quantity in quantity::of_a_brdf() {
                    let Some(axes) = self.default_axes(model.name, model, quantity, range.as_ref())? else {
                        continue;
                    };
                    let name = format!("{}.{}", model.name, quantity.name);
                    let table = TablePlan::basis(name, quantity, model, None, axes)?;
                    self.tables.push(table.with_all_parameters(parameters)?.with_tolerance(tolerance)?);
                }
            }
        }
        for material in materials {
            let lobes = match constant_lobes(material) {
                Ok(lobes) => lobes,
                Err(why) => {
                    self.leave_out(format!("RGB tables of {}", material.name), why);
                    continue;
                }
            };
            for quantity in [&BRDF, &RHO_DH] {
                let what = format!("{}.{}", material.name, quantity.name);
                if quantity.is_value() && lobes.iter().any(Lobe::is_delta) {
                    self.leave_out(what, "a lobe of it is a delta and has no values");
                    continue;
                }
                if let Some(why) = lobes.iter().find_map(|lobe| no_table(lobe.model(), quantity)) {
                    self.leave_out(what, why);
                    continue;
                }
                let axes = natural_axes(quantity, material.is_anisotropic())?;
                self.tables.push(
                    material_table(what, quantity, material, lobes.clone(), axes)?
                        .with_tolerance(tolerance)?,
                );
            }
        }
        Ok(())
    }

    /// The axes of a basis's default table; `None`, with the reason noted, where it has none.
    fn default_axes(
        &mut self,
        subject: &str,
        model: &Model,
        quantity: &Quantity,
        range: Option<&Distribution>,
    ) -> Result<Option<Vec<Axis>>> {
        let value = quantity.is_value();
        if value && model.is_delta() {
            self.leave_out(format!("{subject}.{}", quantity.name), "a delta has no values");
            return Ok(None);
        }
        if let Some(why) = no_table(model, quantity) {
            self.leave_out(format!("{subject}.{}", quantity.name), why);
            return Ok(None);
        }
        let mut axes = Vec::new();
        if let Some(range) = range {
            let (min, max) = (range.min(), range.max());
            axes.push(if value {
                let mut values: Vec<_> = [0.0, 0.25, 0.5, 0.75, 1.0].map(|q| range.quantile(q)).to_vec();
                // The quantile at 0 is the least value with weight: the minimum.
                values.dedup();
                if values.iter().any(|&r| model.is_delta_at(r)) {
                    values.retain(|&r| !model.is_delta_at(r));
                    self.leave_out(
                        format!("{subject}.{} at roughness {min}", quantity.name),
                        "the lobe is a delta there and has no values",
                    );
                }
                if values.is_empty() {
                    return Ok(None);
                }
                Axis::listed(Variable::Roughness, values)?
            } else if range.is_constant() {
                Axis::listed(Variable::Roughness, vec![min])?
            } else {
                Axis::new(Variable::Roughness, ROUGHNESS, [min, max], Positions::Nodes, Mapping::Linear)?
            });
        }
        axes.extend(natural_axes(quantity, model.is_anisotropic())?);
        Ok(Some(axes))
    }

    /// Notes the bases of the materials, and which tables evaluate each material.
    fn describe(&mut self, materials: &[&Material], bases: &mut Bases) -> Result<()> {
        let mut of_bases: HashMap<_, Vec<usize>> = HashMap::new();
        let mut of_materials: HashMap<&str, Vec<usize>> = HashMap::new();
        for (k, table) in self.tables.iter().enumerate() {
            match table.lobes() {
                [lobe] if table.is_basis() => {
                    of_bases.entry((table.subject(), bits(&lobe.parameters()))).or_default().push(k);
                }
                _ => of_materials.entry(table.subject()).or_default().push(k),
            }
        }
        for material in materials {
            let mut plan = MaterialPlan {
                name: material.name.clone(),
                roughness: Distribution::union(material.lobes.iter().filter_map(|l| l.roughness.as_ref()))
                    .map(|d| [d.min(), d.max()]),
                metallic: material.metallic,
                weights: Vec::new(),
                rho_bound: 0.0,
                tables: Vec::new(),
            };
            for lobe in &material.lobes {
                let model = model::find(&lobe.model)?;
                let constant = lobe.roughness.as_ref().filter(|r| r.is_constant()).map(Distribution::min);
                let split = match &lobe.weights {
                    Weights::Constant(weights) => lobes_of(lobe, model, *weights, constant)?,
                    // Its colours are for the formulas to say.
                    Weights::Textured(_) => settings_of(lobe, model)
                        .into_iter()
                        .map(|(parameters, _)| {
                            let factors = lobe.factors.clone();
                            Ok(Lobe::new(model, constant, Vec::new())?
                                .with_parameters(parameters)
                                .with_factors(factors))
                        })
                        .collect::<Result<_>>()?,
                };
                for part in &split {
                    let own = lobe.roughness.as_ref().filter(|_| part.model() == model);
                    bases.require(part.model(), &part.parameters(), own);
                    let weight = |k: usize| match &lobe.weights {
                        Weights::Constant(_) => {
                            Weight::Constant(std::array::from_fn(|channel| part.weights()[channel][k]))
                        }
                        Weights::Textured(formulas) => Weight::Textured(formulas[k].to_string()),
                    };
                    let components = part
                        .model()
                        .components
                        .iter()
                        .enumerate()
                        .map(|(k, c)| (c.name.to_string(), weight(k)));
                    plan.weights.push(BasisWeight {
                        basis: part.model().name.into(),
                        parameters: named(part.model(), &part.parameters()),
                        components: components.collect(),
                        factors: part.factors().iter().map(Factor::describe).collect(),
                    });
                }
                // Every weight of every format is at most 1: they multiply reflectances.
                let largest = match &lobe.weights {
                    Weights::Constant(weights) => weights.as_flattened().iter().copied().fold(0.0, f64::max),
                    Weights::Textured(_) => 1.0,
                };
                // Nothing of what is unbounded is nothing.
                let bound = split.iter().map(Lobe::rho_bound).fold(0.0, f64::max);
                plan.rho_bound += if largest > 0.0 { largest * bound } else { 0.0 };
            }
            let mut serving = of_materials.get(material.name.as_str()).cloned().unwrap_or_default();
            for lobe in &material.lobes {
                let model = model::find(&lobe.model)?;
                for (parameters, _) in settings_of(lobe, model) {
                    serving.extend(of_bases.get(&(model.name, bits(&parameters))).into_iter().flatten());
                }
            }
            serving.sort_unstable();
            serving.dedup();
            plan.tables = serving.into_iter().map(|k| self.tables[k].name().to_owned()).collect();
            self.materials.push(plan);
        }
        Ok(())
    }

    fn leave_out(&mut self, what: impl Into<String>, why: impl Into<String>) {
        self.left_out.push(LeftOut { what: what.into(), why: why.into() });
    }
}

/// The bases that are required, each once, in the order in which they come.
#[derive(Default)]
struct Bases {
    list: Vec<Basis>,
    known: HashMap<(&'static str, ParameterBits), usize>,
}

impl Bases {
    fn require(&mut self, model: &'static Model, places: &Parameters, roughness: Option<&Distribution>) {
        let at = *self.known.entry((model.name, bits(places))).or_insert_with(|| {
            let parameters = named(model, places);
            self.list.push(Basis { model: model.name.into(), roughness: None, parameters });
            self.list.len() - 1
        });
        if let Some(d) = roughness {
            let [min, max] = self.list[at].roughness.unwrap_or([f64::INFINITY, 0.0]);
            self.list[at].roughness = Some([min.min(d.min()), max.max(d.max())]);
        }
    }
}

/// Parameters as a key.
type ParameterBits = [u64; 8];

/// Equal for equal parameters: −0 is 0.
fn bits(parameters: &Parameters) -> ParameterBits {
    parameters.map(|x| (x + 0.0).to_bits())
}

/// Why a model has no integrals, if it has none and this is one.
fn no_table(model: &Model, quantity: &Quantity) -> Option<&'static str> {
    match model.integral {
        Integral::Unbounded(why) if quantity.is_integral() => Some(why),
        _ => None,
    }
}

/// The natural axes of a quantity, at the default resolution.
fn natural_axes(quantity: &Quantity, anisotropic: bool) -> Result<Vec<Axis>> {
    let variables = quantity.variables(anisotropic);
    variables.iter().map(|&variable| natural_axis(quantity, anisotropic, variable)).collect()
}

fn natural_axis(quantity: &Quantity, anisotropic: bool, variable: Variable) -> Result<Axis> {
    let count = match (quantity.is_value(), variable) {
        // √μ on nodes: bilinear look-ups are then eight times closer than on texel centres of μ.
        (_, Variable::Mu) => {
            return Axis::new(variable, MU, [0.0, 1.0], Positions::Nodes, Mapping::Sqrt);
        }
        // A quarter of a turn, which the others mirror.
        (_, Variable::PhiI) => {
            return Axis::new(variable, PHI, [0.0, FRAC_PI_2], Positions::Nodes, Mapping::Linear);
        }
        (true, _) if anisotropic => match variable {
            Variable::ThetaI => ANISOTROPIC_GRID[0],
            Variable::ThetaE => ANISOTROPIC_GRID[1],
            _ => ANISOTROPIC_GRID[2],
        },
        (true, Variable::ThetaI) => VALUE_GRID[0],
        (true, Variable::ThetaE) => VALUE_GRID[1],
        (true, Variable::DeltaPhi) => VALUE_GRID[2],
        (_, Variable::Roughness) => ROUGHNESS,
        _ => THETA,
    };
    Axis::natural(variable, count)
}

/// Names that no table has yet.
struct FreeNames {
    /// In lower case.
    taken: HashSet<String>,
    /// The number to try next behind a name.
    next: HashMap<String, usize>,
}

impl FreeNames {
    /// `name`, with a number if another table has it.
    fn take(&mut self, name: &str) -> String {
        let next = self.next.entry(name.to_lowercase()).or_insert(1);
        loop {
            let free = if *next == 1 { name.to_owned() } else { format!("{name}-{next}") };
            *next += 1;
            if self.taken.insert(free.to_lowercase()) {
                return free;
            }
        }
    }
}

/// The tolerance of a table for which none is asked: half floats round by more than what others get.
fn default_tolerance(storage: Option<Storage>) -> f64 {
    if storage == Some(Storage::F16) { HALF_TOLERANCE } else { Tolerance::DEFAULT.get() }
}

/// A table that a recipe asks for. A tolerance of the selection, as of the command line, wins over the table's own, and that
/// over the recipe's.
fn requested(
    request: &TableRequest,
    scene: &Scene,
    by_name: &HashMap<&str, &Material>,
    selected: Option<f64>,
) -> Result<TablePlan> {
    let material = |name: &str| by_name.get(name).copied().map_or_else(|| scene.material(name), Ok);
    let quantity = quantity::find(&request.quantity)?;
    let given = |variable| request.axes.iter().find(|axis| axis.variable() == variable).cloned();
    let mut axes: Vec<_> = given(Variable::Roughness).into_iter().collect();
    let anisotropic = match &request.subject {
        SubjectRequest::Basis { model, .. } => model::find(model)?.is_anisotropic(),
        SubjectRequest::Material(name) => material(name)?.is_anisotropic(),
    };
    let anisotropic = anisotropic || given(Variable::PhiI).or(given(Variable::PhiE)).is_some();
    for &variable in quantity.variables(anisotropic) {
        axes.push(given(variable).map_or_else(|| natural_axis(quantity, anisotropic, variable), Ok)?);
    }
    let name = |subject: &str| request.name.clone().unwrap_or_else(|| format!("{subject}.{}", quantity.name));
    let table = match &request.subject {
        SubjectRequest::Basis { model, roughness, parameters, compensation } => {
            let subject = match compensation {
                Compensation::None => model.clone(),
                _ => format!("{model}-{}", compensation.name()),
            };
            let basis = TablePlan::basis(name(&subject), quantity, model::find(model)?, *roughness, axes)?;
            basis.with_parameters(parameters)?.with_compensation(*compensation)?
        }
        SubjectRequest::Material(subject) => table_of(name(subject), quantity, material(subject)?, axes)?,
    };
    let table = table.with_rule(request.rule.unwrap_or(Rule::Warped))?;
    let tolerance = selected.or(request.tolerance).or(scene.tolerance);
    let table = table.with_tolerance(tolerance.unwrap_or_else(|| default_tolerance(request.storage)))?;
    if request.auto.is_empty() {
        return table.with_storage(request.storage.unwrap_or_default());
    }
    optimise(table, &request.auto, request.storage)
}

impl TablePlan {
    /// A material that is the same everywhere, its RGB as channels.
    pub fn material(
        name: impl Into<String>,
        quantity: &'static Quantity,
        scene: &Scene,
        material: &str,
        axes: Vec<Axis>,
    ) -> Result<Self> {
        table_of(name.into(), quantity, scene.material(material)?, axes)
    }
}

/// A table of a material that is the same everywhere.
fn table_of(
    name: String,
    quantity: &'static Quantity,
    material: &Material,
    axes: Vec<Axis>,
) -> Result<TablePlan> {
    let refuse = |why| Error::input(format!("material \"{}\": {why}; tabulate its bases", material.name));
    let lobes = constant_lobes(material).map_err(refuse)?;
    material_table(name, quantity, material, lobes, axes)
}

fn material_table(
    name: String,
    quantity: &'static Quantity,
    material: &Material,
    lobes: Vec<Lobe>,
    axes: Vec<Axis>,
) -> Result<TablePlan> {
    let channels = ["R", "G", "B"].map(String::from).to_vec();
    TablePlan::new(name, quantity, material.name.clone(), channels, lobes, axes)
}

/// The lobes of a material that is the same everywhere; else why it is not.
pub(crate) fn constant_lobes(material: &Material) -> Result<Vec<Lobe>, String> {
    let split = |lobe: &MaterialLobe| {
        let Weights::Constant([a, b]) = &lobe.weights else {
            return Err("its weights are textured, so it has no single RGB table".to_string());
        };
        if lobe.roughness.as_ref().is_some_and(|d| !d.is_constant()) {
            return Err("its roughness varies, so it has no single RGB table".to_string());
        }
        let model = model::find(&lobe.model).map_err(|e| e.to_string())?;
        let roughness = lobe.roughness.as_ref().map(Distribution::min);
        lobes_of(lobe, model, [*a, *b], roughness).map_err(|e| e.to_string())
    };
    let lobes: Vec<_> = material.lobes.iter().map(split).collect::<Result<_, String>>()?;
    Ok(lobes.into_iter().flatten().collect())
}

/// The lobes that a material's lobe with constant weights is made of.
fn lobes_of(
    lobe: &MaterialLobe,
    model: &'static Model,
    [a, b]: [[f64; 3]; 2],
    roughness: Option<f64>,
) -> Result<Vec<Lobe>> {
    let split = |(parameters, channels)| {
        let (a, b) = (masked(a, channels), masked(b, channels));
        let weights = (0..3).map(|c| [a[c], b[c]]).collect();
        let factors = lobe.factors.clone();
        let whole = Lobe::new(model, roughness, weights)?.with_parameters(parameters).with_factors(factors);
        lobe.compensation.lobes(whole).map(|lobes| {
            // Those of the other channels alone, whose setting is another, are nothing.
            let is_own = move |lobe: &Lobe| {
                lobe.weights().iter().zip(channels).any(|(w, used)| used && *w != [0.0; 2])
            };
            lobes
                .into_iter()
                .filter(move |lobe| channels == [true; 3] || lobe.factors().is_empty() || is_own(lobe))
        })
    };
    let lobes = settings_of(lobe, model).into_iter().map(split).collect::<Result<Vec<_>>>()?;
    Ok(lobes.into_iter().flatten().collect())
}

/// The different parameters that the channels of a lobe have, and which channels have them: a metal's η and k
/// differ in R, G and B, and its lobe is then the sum of three, each of one channel.
fn settings_of(lobe: &MaterialLobe, model: &Model) -> Vec<(Parameters, [bool; 3])> {
    let mut settings: Vec<(Parameters, [bool; 3])> = Vec::new();
    for channel in 0..3 {
        let mut parameters = model.defaults_in(channel);
        for parameter in model.parameters.iter() {
            if let Some((_, given)) = lobe.parameters.iter().find(|(name, _)| name == parameter.name) {
                parameters[parameter.place] = given[channel];
            }
        }
        match settings.iter_mut().find(|(known, _)| *known == parameters) {
            Some((_, of)) => of[channel] = true,
            None => settings.push((parameters, std::array::from_fn(|k| k == channel))),
        }
    }
    settings
}

/// The channels that are meant, and nothing of the others.
fn masked(weights: [f64; 3], of: [bool; 3]) -> [f64; 3] {
    std::array::from_fn(|k| if of[k] { weights[k] } else { 0.0 })
}

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let range = |[a, b]: [f64; 2]| if a == b { format!("{a:.4}") } else { format!("{a:.4} … {b:.4}") };
        writeln!(f, "materials")?;
        for m in &self.materials {
            let bases: Vec<_> = m.weights.iter().map(|w| w.basis.as_str()).collect();
            write!(f, "  {}: {}", m.name, bases.join(" + "))?;
            for (w, factor) in m.weights.iter().flat_map(|w| w.factors.iter().map(move |factor| (w, factor)))
            {
                write!(f, ", {} times {factor}", w.basis)?;
            }
            if let Some(roughness) = m.roughness {
                write!(f, ", roughness {}", range(roughness))?;
            }
            if let Some(metallic) = m.metallic {
                write!(f, ", metallic {}", range(metallic))?;
            }
            writeln!(f)?;
        }
        writeln!(f, "tables")?;
        for table in &self.tables {
            writeln!(f, "  {table}")?;
        }
        writeln!(f, "left out")?;
        for LeftOut { what, why } in &self.left_out {
            writeln!(f, "  {what}: {why}")?;
        }
        Ok(())
    }
}
