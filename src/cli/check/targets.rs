//! The subjects of `gonio check`: a model, or every basis and material of a scene or recipe.

use crate::bake::Evaluator;
use crate::base::error::{Error, Result};
use crate::cli::check::Args;
use crate::cli::subject;
use crate::model;
use crate::model::Model;
use crate::model::compensation::Compensation;
use crate::model::lobe::Lobe;
use crate::scene::planner::constant_lobes;
use crate::scene::{Distribution, Scene, SubjectRequest};
use crate::table::axis::Variable;
use crate::verify::{ParameterRange, Sum};
use std::path::Path;

/// A subject, and the `gonio eval` command for it without parameters and directions.
pub struct CheckTarget<'a> {
    pub subject: Sum<'a>,
    pub command: String,
}

/// Builds the subject of `--model NAME` with `--set`. Unset parameters are checked over their whole range.
pub fn model<'a>(args: &Args, name: &str, evaluator: &'a Evaluator) -> Result<CheckTarget<'a>> {
    let mut model = model::find(name)?;
    let (mut fixed, mut ranges) = (Vec::new(), Vec::new());
    let mut compensation = Compensation::None;
    for set in &args.set {
        let (key, value) = subject::key_value(set).map_err(|error| {
            Error::input(format!("{error}; or KEY=LOW..HIGH for a range, as in --set alpha=1e-6..1"))
        })?;
        if fixed.iter().any(|(given, _)| *given == key)
            || ranges.iter().any(|r: &ParameterRange| r.name == key)
        {
            return Err(Error::input(format!("--set {set}: \"{key}\" is given twice")));
        }
        match value.split_once("..") {
            // Terms have no range: from here on they are part of the model's name.
            None if key == "masking" => model = model.with_terms(Some(value), None)?,
            None if key == "fresnel" => model = model.with_terms(None, Some(value))?,
            None => fixed.push((key, value)),
            Some((low, high)) => {
                let number = |text: &str| {
                    text.trim().parse().map_err(|_| {
                        Error::input(format!("--set {set}: \"{text}\" is not a number; give {key}=LOW..HIGH"))
                    })
                };
                let range = ParameterRange::new(key, number(low)?, number(high)?);
                ranges.push(range.map_err(|e| e.at(format!("--set {set}")))?);
            }
        }
    }
    let given = |key: &str| {
        fixed.iter().any(|(given, _)| *given == key)
            || ranges.iter().any(|range: &ParameterRange| range.name == key)
    };
    let mut whole = Vec::new();
    if let Some(shape) = model.shape.filter(|shape| !given(shape.name) && !given("roughness")) {
        whole.push(ParameterRange::new(shape.name, shape.least, shape.most)?);
    }
    whole.extend(beside_the_shape(model)?.into_iter().filter(|parameter| !given(&parameter.name)));
    ranges.extend(whole);

    // The recipe's reader reports wrong names and values, at both ends of the ranges.
    let mut lobe = None;
    for end in [|p: &ParameterRange| p.low, |p: &ParameterRange| p.high] {
        let ranged: Vec<_> =
            ranges.iter().map(|range| (range.name.as_str(), format!("{:?}", end(range)))).collect();
        let ranged = ranged.iter().map(|(key, value)| (*key, value.as_str()));
        let scene = subject::model(model.name, fixed.iter().copied().chain(ranged))?;
        let mut material = scene.materials[0].clone();
        // `Sum` compensates at each of its settings, so the lobe must not be compensated already.
        for lobe in &mut material.lobes {
            compensation = std::mem::take(&mut lobe.compensation);
        }
        lobe = constant_lobes(&material).map_err(Error::input)?.pop();
    }
    let lobe = lobe.ok_or_else(|| Error::Internal("a model without a lobe".into()))?;
    let mut command = format!("gonio eval --model {}", model.name);
    for (key, value) in &fixed {
        command += &format!(" --set {}", quoted(&format!("{key}={value}")));
    }
    Ok(CheckTarget { subject: Sum::compensated(evaluator, lobe, compensation, ranges)?, command })
}

/// Builds a subject for every basis, over the scene's range of roughness and all weights, and for every material.
pub fn scene<'a>(
    path: &Path,
    scene: &'a Scene,
    material: Option<&str>,
    evaluator: &'a Evaluator,
) -> Result<Vec<CheckTarget<'a>>> {
    let wanted: Vec<_> = match material {
        Some(name) => vec![scene.material(name)?],
        None => scene.materials.iter().collect(),
    };
    let mut targets = Vec::new();
    if material.is_none() {
        for model in model::all() {
            if let Some(range) = roughness_range(scene, model) {
                targets.push(basis(model, range, evaluator)?);
            }
        }
    }
    for material in wanted {
        let (file, name) = (quoted(&path.display().to_string()), quoted(&material.name));
        let subject = Sum::material(evaluator, material)?;
        targets.push(CheckTarget { subject, command: format!("gonio eval {file} --material {name}") });
    }
    if targets.is_empty() {
        return Err(Error::input(format!("{}: it has no material and no model to check", path.display())));
    }
    Ok(targets)
}

fn basis<'a>(
    model: &'static Model,
    roughness: [f64; 2],
    evaluator: &'a Evaluator,
) -> Result<CheckTarget<'a>> {
    let mut parameters = Vec::new();
    if model.shape.is_some() {
        let [low, high] = roughness;
        parameters.push(ParameterRange::new("roughness", low, high)?);
    }
    parameters.extend(beside_the_shape(model)?);
    let lobe = Lobe::new(model, model.shape.map(|_| 1.0), vec![[0.0; 2]; 3])?;
    let subject = Sum::model(evaluator, lobe, parameters)?;
    Ok(CheckTarget { subject, command: format!("gonio eval --model {}", model.name) })
}

/// Lists a model's parameters but roughness, and its components' weights, each over its whole range.
fn beside_the_shape(model: &Model) -> Result<Vec<ParameterRange>> {
    let parameters = model.parameters.iter().map(|parameter| (parameter.name, parameter.range));
    let weights = model.components.iter().map(|component| (component.weight, [0.0, 1.0]));
    parameters.chain(weights).map(|(name, [low, high])| ParameterRange::new(name, low, high)).collect()
}

/// Returns the range of roughness that the scene's materials and tables give a model, if they use it.
fn roughness_range(scene: &Scene, model: &Model) -> Option<[f64; 2]> {
    let lobes = scene.materials.iter().flat_map(|m| &m.lobes).filter(|lobe| lobe.model == model.name);
    let range = |d: &Distribution| [d.min(), d.max()];
    let lobe_ranges = lobes.map(|lobe| lobe.roughness.as_ref().map_or([1.0; 2], range));
    let table_ranges = scene.tables.iter().filter_map(|table| match &table.subject {
        SubjectRequest::Basis { model: name, roughness, .. } if name == model.name => {
            let axis = table.axes.iter().find(|axis| axis.variable() == Variable::Roughness);
            Some(roughness.map(|r| [r; 2]).or(axis.map(|axis| axis.range())).unwrap_or([0.0, 1.0]))
        }
        _ => None,
    });
    lobe_ranges.chain(table_ranges).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
}

/// Quotes a word for a POSIX shell.
pub(in crate::cli) fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=+,:%@".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}
