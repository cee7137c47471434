//! Recipes: materials and tables written by hand, in TOML. docs/recipes.md documents the format.

mod disney;
mod document;

use crate::base::error::{Error, Result};
use crate::model;
use crate::model::compensation::{Albedo, Compensation, Factor};
use crate::model::{ALPHA_MIN_VALUE, Component, Integral, MODELS, Model, Shape};
use crate::scene::{Distribution, Material, MaterialLobe, Scene, SubjectRequest, TableRequest, Weights};
use crate::table::axis::{Axis, MAX_COUNT, Mapping, Positions, Variable};
use crate::table::quantity;
use crate::table::quantity::{QUANTITIES, Quantity};
use crate::table::rule::{MAX_GAUSS, MAX_GRID, MAX_SAMPLES, Rule};
use crate::table::storage::Storage;
use document::{Document, Item, TableFields};
use std::collections::{BTreeSet, HashMap, HashSet};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Tables are not better than f32, and a tolerance above 1 promises nothing.
const TOLERANCES: [f64; 2] = [1e-12, 1.0];

/// The longest recipe that is read: tens of thousands of materials.
const MAX_BYTES: u64 = 1 << 23;

/// Reads a recipe.
pub(super) fn read(path: &Path) -> Result<Scene> {
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(Error::io("read", path))?;
    file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(Error::io("read", path))?;
    if bytes.len() as u64 > MAX_BYTES {
        let (path, most) = (path.display(), MAX_BYTES >> 20);
        return Err(Error::input(format!("{path}: it is longer than {most} MiB; split the recipe")));
    }
    parse(path, &bytes)
}

/// Reads a recipe from its text; `path` is what messages call it.
pub fn parse(path: &Path, bytes: &[u8]) -> Result<Scene> {
    let document = Document::new(path, bytes)?;
    let table = document.parse()?;
    let root = document.root(&table).only(&["tolerance", "materials", "tables"])?;

    let tolerance = root.get("tolerance").map(|item| item.number_in(TOLERANCES)).transpose()?;
    let materials = match root.get("materials") {
        None => Vec::new(),
        Some(item) => item.entries()?.into_iter().map(material).collect::<Result<_>>()?,
    };
    let tables = match root.get("tables") {
        None => Vec::new(),
        Some(item) => {
            let known = Known::new(&materials);
            item.items()?.into_iter().map(|t| table_request(t, &known)).collect::<Result<_>>()?
        }
    };
    if materials.is_empty() && tables.is_empty() {
        return Err(Error::input(format!(
            "{}: it asks for nothing; give a [materials.NAME] or a [[tables]]",
            path.display()
        )));
    }
    check_names(&tables)?;
    Ok(Scene { file: path.to_owned(), materials, tables, tolerance, ..Scene::default() })
}

/// `[materials.NAME]`
fn material(item: Item) -> Result<Material> {
    let name = item.name().to_owned();
    if name.trim().is_empty() || name.contains(char::is_control) {
        return Err(item.refuse("a material needs a name that can be printed"));
    }
    let fields = item.table(&["lobes", "disney", "sheen"])?;
    let mut lobes = match (fields.get("lobes"), fields.get("disney")) {
        (Some(_), Some(item)) => return Err(item.refuse("lobes are given too; keep one of them")),
        (None, Some(item)) => disney::lobes(item)?,
        _ => {
            let lobes = fields.require("lobes")?;
            let items = lobes.items()?;
            if items.is_empty() {
                return Err(lobes.refuse("the list is empty; give at least one { model = …, … }"));
            }
            items.into_iter().map(lobe).collect::<Result<Vec<_>>>()?
        }
    };
    if let Some(item) = fields.get("sheen") {
        sheen(item, &mut lobes)?;
    }
    Ok(Material { name, lobes, metallic: None, base_color: None })
}

/// `sheen = { color = [0.9, 0.8, 0.7], roughness = 0.5 }` upon the lobes: as KHR_materials_sheen has it.
fn sheen(item: Item, lobes: &mut Vec<MaterialLobe>) -> Result<()> {
    let fields = item.table(&["color", "roughness"])?;
    let color = channels(fields.require("color")?, [0.0, 1.0])?;
    let roughness = fields.require("roughness")?.number_in([0.0, 1.0])?;
    let model = model::find("charlie")?.with_terms(None, Some("none"))?;
    let of = Albedo { model, roughness: Some(roughness), parameters: model.defaults() };
    let most = color.into_iter().fold(0.0, f64::max);
    for lobe in lobes.iter_mut() {
        lobe.factors.push(Factor::BelowSheen { of: of.clone(), most });
    }
    lobes.push(MaterialLobe {
        model: model.name.into(),
        roughness: Some(Distribution::constant(roughness)),
        parameters: Vec::new(),
        weights: Weights::Constant([color, [0.0; 3]]),
        compensation: Compensation::None,
        factors: Vec::new(),
    });
    Ok(())
}

/// `{ model = "ggx", roughness = 0.3, masking = "smith-separable", f0 = [1.0, 0.78, 0.34] }`
fn lobe(item: Item) -> Result<MaterialLobe> {
    let fields = item.any_table()?;
    let model = model(&fields, fields.require("model")?)?;
    let mut keys = vec!["model"];
    keys.extend(model.terms().into_iter().map(|(kind, ..)| kind));
    keys.extend(model.shape.iter().flat_map(|shape| ["roughness", shape.name]));
    keys.extend(model.parameters.iter().map(|parameter| parameter.name));
    keys.extend((!model.metals().is_empty()).then_some("metal"));
    keys.extend(model.components.iter().map(|component| component.weight));
    keys.extend(Compensation::is_for(model).then_some(COMPENSATION));
    let fields = item.table(&keys)?;

    let roughness = match model.shape {
        None => None,
        Some(shape) => match roughness(&fields, &shape)? {
            None if shape.name == "roughness" => return Err(fields.refuse("give its roughness")),
            None => return Err(fields.refuse(&format!("give its roughness or its {}", shape.name))),
            roughness => roughness,
        },
    };
    let metals = || model.metals().iter().map(|metal| (metal.name, metal));
    let metal = fields.get("metal").map(|item| item.one_of(metals())).transpose()?;
    let of_metal = |name: &str| metal.and_then(|metal| metal.get(name));
    let mut parameters = Vec::new();
    for parameter in model.parameters.iter() {
        match (fields.get(parameter.name), of_metal(parameter.name)) {
            (Some(item), Some(_)) => return Err(item.refuse("the metal has its own; keep one of them")),
            (None, Some(given)) => parameters.push((parameter.name.into(), given)),
            (Some(item), None) => parameters.push((parameter.name.into(), channels(item, parameter.range)?)),
            (None, None) if parameter.default.is_none() => {
                return Err(fields.refuse(&format!("give its {}", parameter.name)));
            }
            (None, None) => {}
        }
    }
    parameters.extend(aspect(&fields, model)?.map(|(name, value)| (name, [value; 3])));
    let mut weights = [[0.0; 3]; 2];
    for (weight, &Component { weight: key, default, .. }) in weights.iter_mut().zip(model.components) {
        *weight = match (fields.get(key), default) {
            (Some(item), _) => channels(item, [0.0, 1.0])?,
            (None, Some(value)) => [value; 3],
            (None, None) => return Err(fields.refuse(&format!("give its {key}"))),
        };
    }
    Ok(MaterialLobe {
        model: model.name.into(),
        roughness,
        parameters,
        weights: Weights::Constant(weights),
        compensation: compensation(&fields, model)?,
        factors: Vec::new(),
    })
}

const COMPENSATION: &str = "compensation";

/// `compensation = "kulla-conty"`
fn compensation(fields: &TableFields, model: &'static Model) -> Result<Compensation> {
    let Some(item) = fields.get(COMPENSATION) else { return Ok(Compensation::None) };
    if !Compensation::is_for(model) {
        return Err(item.refuse(&format!("{} is no lobe of microfacets; leave this away", model.name)));
    }
    let compensation = item.one_of(Compensation::words())?;
    match model.integral {
        Integral::Unbounded(why) if compensation != Compensation::None => {
            Err(item.refuse(&format!("{} has no albedo ({why}); leave this away", model.name)))
        }
        _ => Ok(compensation),
    }
}

/// One number for all channels, or three.
fn channels(item: Item, range: [f64; 2]) -> Result<[f64; 3]> {
    if !item.is_array() {
        return Ok([item.number_in(range)?; 3]);
    }
    let items = item.items()?;
    let [r, g, b] = items[..] else {
        return Err(item.refuse(&format!("{} numbers; give one, or three for R, G, B", items.len())));
    };
    Ok([r.number_in(range)?, g.number_in(range)?, b.number_in(range)?])
}

/// `roughness = r`, or the model's own measure of it in its place, as `alpha = r²`; `roughness = [a, b]` is a
/// material that varies.
fn roughness(fields: &TableFields, shape: &Shape) -> Result<Option<Distribution>> {
    let measure = fields.get(shape.name).filter(|_| shape.name != "roughness");
    match (fields.get("roughness"), measure) {
        (Some(_), Some(measure)) => {
            Err(measure.refuse(&format!("roughness is given too ({}); keep one of them", shape.summary)))
        }
        (Some(item), None) if item.is_array() => {
            let [a, b] = pair(item)?;
            let [min, max] = [a.number_in([0.0, 1.0])?, b.number_in([0.0, 1.0])?];
            if min > max {
                return Err(item.refuse(&format!("the range [{min}, {max}] is reversed")));
            }
            Ok(Some(Distribution::uniform(min, max)))
        }
        (Some(item), None) => Ok(Some(Distribution::constant(item.number_in([0.0, 1.0])?))),
        (None, Some(item)) => {
            let measure = match item.is_array() && shape.anisotropic {
                true => alphas(item)?.iter().product::<f64>().sqrt(),
                false => item.number_in([0.0, shape.most])?,
            };
            Ok(Some(Distribution::constant(shape.roughness(measure))))
        }
        (None, None) => Ok(None),
    }
}

fn pair(item: Item) -> Result<[Item; 2]> {
    let items = item.items()?;
    items[..].try_into().map_err(|_| item.refuse(&format!("{} values; give two: [a, b]", items.len())))
}

/// What tables are of.
struct Known<'a> {
    materials: &'a [Material],
    by_name: HashMap<&'a str, &'a Material>,
    /// The measures of roughness and the parameters of all models.
    parameters: BTreeSet<&'static str>,
}

impl<'a> Known<'a> {
    fn new(materials: &'a [Material]) -> Self {
        let parameters = model::all().flat_map(|model| {
            let shape = model.shape.map(|shape| shape.name);
            shape.into_iter().chain(model.parameters.iter().map(|parameter| parameter.name))
        });
        let by_name = materials.iter().map(|material| (material.name.as_str(), material)).collect();
        Self { materials, by_name, parameters: parameters.collect() }
    }

    fn material(&self, item: &Item<'a>) -> Result<&'a Material> {
        match self.by_name.get(item.text()?) {
            Some(material) => Ok(material),
            None => item.one_of(self.materials.iter().map(|m| (m.name.as_str(), m))),
        }
    }
}

/// `[[tables]]`
fn table_request<'a>(item: Item<'a>, known: &Known<'a>) -> Result<TableRequest> {
    let mut keys = vec!["name", "quantity", "material", "model", "masking", "fresnel", "roughness"];
    keys.extend(["axes", "grid", "rule", "storage", "tolerance", COMPENSATION]);
    // A model's own, of which a table of a material or of another model says that it has none.
    let own = &known.parameters;
    keys.extend(own.iter().filter(|&&name| name != "roughness"));
    let fields = item.table(&keys)?;
    let name = fields.get("name").map(table_name).transpose()?;
    let quantity = quantity_of(&fields.require("quantity")?)?;
    let (subject, varies) = subject(&fields, known)?;

    let (mut axes, mut auto) = (Vec::new(), Vec::new());
    if let Some(item) = fields.get("axes") {
        let variables = quantity
            .variables
            .iter()
            .chain(quantity.anisotropic_variables)
            .copied()
            .chain([Variable::Roughness]);
        let variables: Vec<_> = variables.map(|v| (v.name(), v)).collect();
        for axis_item in item.entries()? {
            let variable = axis_item.key_one_of(variables.iter().copied())?;
            if variable == Variable::Roughness {
                varies.map_err(|why| axis_item.refuse(why))?;
            }
            if let Some(range) = auto_range(&axis_item, variable)? {
                if quantity.is_value() {
                    return Err(axis_item.refuse("only integrals have auto axes; give a count"));
                }
                let varying = varying_roughness(&fields, known, variable);
                axes.push(range_axis(&axis_item, variable, range.or(varying))?);
                auto.push(variable);
                continue;
            }
            axes.push(axis(axis_item, variable)?);
        }
    }
    Ok(TableRequest {
        name,
        quantity: quantity.name.into(),
        subject,
        axes,
        auto,
        storage: fields
            .get("storage")
            .map(|item| item.one_of(Storage::ALL.map(|s| (s.name(), s))))
            .transpose()?,
        rule: rule(&fields)?,
        tolerance: fields.get("tolerance").map(|t| t.number_in(TOLERANCES)).transpose()?,
        place: item.place(),
    })
}

/// The quantity of a table: one of a BRDF. One of light is known and refused.
fn quantity_of(item: &Item) -> Result<&'static Quantity> {
    let given = item.text()?;
    if let Some(light) = QUANTITIES.iter().find(|quantity| quantity.name == given)
        && let Some(why) = light.refused()
    {
        return Err(item.refuse(&why));
    }
    item.one_of(quantity::of_a_brdf().map(|quantity| (quantity.name, quantity)))
}

/// What the table is of, and whether it can have a roughness axis; if not, why.
fn subject<'a>(
    fields: &TableFields<'a>,
    known: &Known<'a>,
) -> Result<(SubjectRequest, Result<(), &'static str>)> {
    const FIXED: &str = "the table has one roughness already; leave that or this axis away";
    const NONE: &str = "the table's model has no roughness; leave this axis away";
    let has = |material: &Material, test: fn(&Distribution) -> bool| {
        material.lobes.iter().filter_map(|lobe| lobe.roughness.as_ref()).any(test)
    };
    match (fields.get("material"), fields.get("model")) {
        (Some(item), None) => {
            let material = known.material(&item)?;
            for key in ["masking", "fresnel", "roughness", COMPENSATION].iter().chain(&known.parameters) {
                if let Some(item) = fields.get(key) {
                    return Err(item.refuse("a material has its own; leave this away, or give a model"));
                }
            }
            let varies = match material {
                m if has(m, |roughness| !roughness.is_constant()) => Ok(()),
                m if has(m, |_| true) => Err("the material's roughness is one number; give it a range there"),
                _ => Err("the material has no roughness; leave this axis away"),
            };
            Ok((SubjectRequest::Material(material.name.clone()), varies))
        }
        (None, Some(item)) => {
            let model = model(fields, item)?;
            for key in ["roughness"].iter().chain(&known.parameters) {
                let shape = model.shape.is_some_and(|shape| *key == "roughness" || shape.name == *key);
                let has = shape || model.parameters.iter().any(|parameter| parameter.name == *key);
                if let (false, Some(item)) = (has, fields.get(key)) {
                    return Err(item.refuse(&format!("{} has no {key}; leave this away", model.name)));
                }
            }
            let given = fields.get("roughness").or(model.shape.and_then(|shape| fields.get(shape.name)));
            let parameters = model.parameters.iter().filter_map(|parameter| {
                let item = fields.get(parameter.name)?;
                Some(item.number_in(parameter.range).map(|value| (parameter.name.into(), value)))
            });
            let mut parameters = parameters.collect::<Result<Vec<_>>>()?;
            parameters.extend(aspect(fields, model)?);
            let roughness = model.shape.map_or(Ok(None), |shape| roughness(fields, &shape))?;
            let roughness = match (roughness, given) {
                (Some(range), Some(item)) if !range.is_constant() => {
                    return Err(
                        item.refuse("a table has one roughness; for a range give it a roughness axis")
                    );
                }
                (roughness, _) => roughness.map(|r| r.min()),
            };
            let varies = match (model.shape.is_some(), roughness) {
                (false, _) => Err(NONE),
                (true, Some(_)) => Err(FIXED),
                (true, None) => Ok(()),
            };
            let compensation = compensation(fields, model)?;
            let model = model.name.into();
            Ok((SubjectRequest::Basis { model, roughness, parameters, compensation }, varies))
        }
        (Some(_), Some(item)) => Err(item.refuse("a table is of a material or of a model; keep one of them")),
        (None, None) => Err(fields.refuse("say of what: material = \"NAME\" or model = \"NAME\"")),
    }
}

/// `model = "ggx"`, and where it is made of terms those that stand beside it: `masking`, `fresnel`.
fn model(fields: &TableFields, item: Item) -> Result<&'static Model> {
    let named = item.text().ok().and_then(|name| model::find(name).ok());
    let model = named.map_or_else(|| item.one_of(MODELS.iter().map(|&model| (model.name, model))), Ok)?;
    let terms = model.terms();
    let [masking, fresnel] = ["masking", "fresnel"].map(|key| {
        let Some(item) = fields.get(key) else { return Ok(None) };
        let Some((_, there, _)) = terms.iter().find(|(kind, ..)| *kind == key) else {
            return Err(item.refuse(&format!("{} has no {key} to choose; leave this away", model.name)));
        };
        item.one_of(there.iter().map(|term| (term.name, Some(term.name))))
    });
    let model = match (masking?, fresnel?) {
        (None, None) => model,
        (masking, fresnel) => model.with_terms(masking, fresnel)?,
    };
    match fields.get("alpha") {
        Some(item) if item.is_array() && !model.is_anisotropic() => model
            .anisotropic()
            .ok_or_else(|| item.refuse(&format!("{} has one alpha; give a number", model.name))),
        _ => Ok(model),
    }
}

/// `alpha = [x, y]` along the tangent and the bitangent: their aspect, x/y, a parameter of anisotropic models.
fn aspect(fields: &TableFields, model: &Model) -> Result<Option<(String, f64)>> {
    let Some(parameter) = model.parameters.iter().find(|p| model.is_anisotropic() && p.name == "aspect")
    else {
        return Ok(None);
    };
    let Some(item) = fields.get("alpha").filter(Item::is_array) else { return Ok(None) };
    if let Some(aspect) = fields.get(parameter.name) {
        return Err(aspect.refuse("alpha = [x, y] has it; keep one of them"));
    }
    let [x, y] = alphas(item)?;
    let [least, most] = parameter.range;
    if !(least..=most).contains(&(x / y)) {
        return Err(item.refuse(&format!("{x} over {y} is outside [{least}, {most}]")));
    }
    Ok(Some((parameter.name.into(), x / y)))
}

fn alphas(item: Item) -> Result<[f64; 2]> {
    let [x, y] = pair(item)?;
    Ok([x.number_in([ALPHA_MIN_VALUE, 1.0])?, y.number_in([ALPHA_MIN_VALUE, 1.0])?])
}

/// Table names are names of files.
fn table_name(item: Item) -> Result<String> {
    let name = item.text()?;
    let fits = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    if name.is_empty() || name.starts_with('.') || name.len() > 100 || !name.chars().all(fits) {
        return Err(item.refuse("it names files: give 1 to 100 of A–Z a–z 0–9 - _ . and no dot in front"));
    }
    Ok(name.into())
}

/// No two tables of one name; also none that differ by case alone, which some file systems ignore.
fn check_names(tables: &[TableRequest]) -> Result<()> {
    let mut taken = HashSet::new();
    for table in tables {
        if let Some(name) = &table.name
            && !taken.insert(name.to_ascii_lowercase())
        {
            return Err(Error::input(format!(
                "{}: another table is named {name} too; give each a name of its own",
                table.place
            )));
        }
    }
    Ok(())
}

/// `rule = "warped"`, or `rule = { NAME = [n_theta, n_phi] }`, or `rule = { NAME = samples }`; also
/// `grid = [n_theta, n_phi]`.
fn rule(fields: &TableFields) -> Result<Option<Rule>> {
    let nodes = |item: Item, most| -> Result<[usize; 2]> {
        let [theta, phi] = pair(item)?;
        Ok([theta.count(most)?, phi.count(most)?])
    };
    let grid = |item| nodes(item, MAX_GRID).map(|[theta, phi]| Some(Rule::Grid { theta, phi }));
    let item = match (fields.get("grid"), fields.get("rule")) {
        (None, None) => return Ok(None),
        (Some(item), None) => return grid(item),
        (Some(_), Some(item)) => return Err(item.refuse("grid is given too; keep one of them")),
        (None, Some(item)) => item,
    };
    if !item.is_table() {
        return item.one_of([("warped", Some(Rule::Warped))]);
    }
    let entries = item.entries()?;
    let [entry] = entries[..] else { return Err(item.refuse("give one rule: { NAME = … }")) };
    let names = ["grid", "gauss", "hammersley", "vndf", "random"];
    Ok(match entry.key_one_of(names.map(|name| (name, name)))? {
        "grid" => grid(entry)?,
        "gauss" => nodes(entry, MAX_GAUSS).map(|[theta, phi]| Some(Rule::Gauss { theta, phi }))?,
        name => {
            let samples = entry.count(MAX_SAMPLES)?;
            Some(match name {
                "hammersley" => Rule::Hammersley { samples },
                "vndf" => Rule::Vndf { samples },
                _ => Rule::Random { samples },
            })
        }
    })
}

/// Whether an axis is "auto", or `{ count = "auto", range = [a, b] }`; then the range that it gives.
fn auto_range(item: &Item<'_>, variable: Variable) -> Result<Option<Option<[f64; 2]>>> {
    let is_auto = |item: &Item| item.text().is_ok_and(|text| text == "auto");
    let refuse = || item.refuse("only mu and roughness can be auto; give a count");
    let can = matches!(variable, Variable::Mu | Variable::Roughness);
    if is_auto(item) {
        return if can { Ok(Some(None)) } else { Err(refuse()) };
    }
    if !item.is_table() {
        return Ok(None);
    }
    let fields = item.any_table()?;
    if !fields.get("count").is_some_and(|count| is_auto(&count)) {
        return Ok(None);
    }
    if !can {
        return Err(refuse());
    }
    let fields = item.table(&["count", "range"])?;
    let Some(range) = fields.get("range") else { return Ok(Some(None)) };
    let [a, b] = pair(range)?;
    Ok(Some(Some([a.number()?, b.number()?])))
}

/// The roughness that the table's material takes, where it is one that varies.
fn varying_roughness(fields: &TableFields, known: &Known, variable: Variable) -> Option<[f64; 2]> {
    let name = fields.get("material").filter(|_| variable == Variable::Roughness)?.text().ok()?;
    let material = known.by_name.get(name)?;
    let all = Distribution::union(material.lobes.iter().filter_map(|lobe| lobe.roughness.as_ref()))?;
    Some([all.min(), all.max()])
}

/// An axis that stands for its range, until the plan chooses its samples.
fn range_axis(item: &Item, variable: Variable, range: Option<[f64; 2]>) -> Result<Axis> {
    let range = range.unwrap_or(variable.natural_range());
    let axis = Axis::new(variable, 2, range, Positions::Nodes, Mapping::Linear);
    axis.map_err(|error| error.at(item.place()))
}

/// A count, `{ count, range, positions, mapping }`, or `{ values }`.
fn axis(item: Item, variable: Variable) -> Result<Axis> {
    let at = |error: Error| error.at(item.place());
    if !item.is_table() {
        return Axis::natural(variable, item.count(MAX_COUNT)?).map_err(at);
    }
    let fields = item.table(&["count", "range", "positions", "mapping", "values"])?;
    if let Some(values) = fields.get("values") {
        for key in ["count", "range", "positions", "mapping"] {
            if let Some(other) = fields.get(key) {
                return Err(other.refuse("values are listed already; leave this away"));
            }
        }
        let values = values.items()?.into_iter().map(|value| value.number()).collect::<Result<_>>()?;
        return Axis::listed(variable, values).map_err(at);
    }
    let count = fields.require("count")?.count(MAX_COUNT)?;
    let range = match fields.get("range") {
        None => variable.natural_range(),
        Some(item) => {
            let [a, b] = pair(item)?;
            [a.number()?, b.number()?]
        }
    };
    let positions = match fields.get("positions") {
        None => variable.natural_positions(),
        Some(item) => item.one_of([("centers", Positions::Centers), ("nodes", Positions::Nodes)])?,
    };
    let mapping = match fields.get("mapping") {
        None => Mapping::Linear,
        Some(item) => item.one_of([("linear", Mapping::Linear), ("sqrt", Mapping::Sqrt)])?,
    };
    Axis::new(variable, count, range, positions, mapping).map_err(at)
}
