//! `gonio models`

mod costs;

use crate::backend::gpu::DeviceChoice;
use crate::base::error::Result;
use crate::cli::{HEADING, print, print_json};
use crate::model;
use crate::model::compensation::Compensation;
use crate::model::{Component, FRESNELS, Integral, MASKINGS, MODELS, Metal, Model, Shape, Term};
use serde_json::{Value, json};

#[derive(clap::Args)]
#[command(after_help = AFTER_HELP)]
pub struct Args {
    /// A model to describe: its parameters, parts, source and promises; or a Fresnel term, on the ideal mirror
    #[arg(value_name = "NAME")]
    name: Option<String>,
    /// For each tolerance, measure evaluations for a texel and largest error of ρ_dh and ρ_hh, at extreme θi and
    /// roughness
    #[arg(long)]
    costs: bool,
    /// With --costs: the tolerances
    #[arg(long, value_name = "T", num_args = 1.., requires = "costs", default_values_t = [1e-2, 1e-4, 1e-6],
          value_parser = crate::cli::bake::tolerance)]
    tolerance: Vec<f64>,
    /// With --costs: `auto` (best GPU, else software Vulkan, else CPU), `cpu`, or part of an adapter's name
    #[arg(long, value_name = "NAME", requires = "costs", default_value = "auto")]
    device: DeviceChoice,
    /// Print JSON on stdout
    #[arg(long)]
    json: bool,
}

const AFTER_HELP: &str = "\
Examples:
  gonio models
  gonio models ggx
  gonio models ggx-smith-separable-none
  gonio models conductor
  gonio models --costs
  gonio models ggx --costs --tolerance 1e-3 1e-8

Exit codes: 0 success, 1 a tolerance is missed, 2 no such model, 3 no device, 130 interrupted";

/// A parameter, with its name in recipes and in `--set`.
pub(super) struct ParameterEntry {
    pub name: &'static str,
    pub range: String,
    unit: &'static str,
    /// None: it must be given.
    pub default: Option<String>,
    pub what: String,
}

pub fn run(args: &Args) -> Result<()> {
    if args.costs {
        let models = match &args.name {
            Some(name) => vec![model_or_term(name)?],
            None => MODELS.to_vec(),
        };
        return costs::run(&models, &args.tolerance, &args.device, args.json);
    }
    match &args.name {
        Some(name) => one(model_or_term(name)?, args.json),
        None if args.json => print_json(&json!({
            "models": model::all().map(|m| json!({ "name": m.name, "summary": m.summary })).collect::<Vec<_>>(),
            "masking": terms(&MASKINGS), "fresnel": terms(&FRESNELS),
        })),
        None => list(),
    }
}

/// Finds a model, or the ideal mirror with the Fresnel term of this name: its parameters are the term's alone.
fn model_or_term(name: &str) -> Result<&'static Model> {
    match FRESNELS.iter().any(|term| term.name == name) {
        true => model::find("mirror")?.with_terms(None, Some(name)),
        false => model::find(name),
    }
}

fn list() -> Result<()> {
    let terms = MASKINGS.iter().chain(&FRESNELS).map(|term| term.name);
    let width = column(MODELS.iter().map(|model| model.name).chain(terms));
    let line = |name: &str, summary: &str, is_counted: bool| {
        let slow = if is_counted { "" } else { " (integrals are slow)" };
        print(&format!("  {name:width$}{summary}{slow}"))
    };
    print(&format!("{HEADING}models{HEADING:#}"))?;
    MODELS.iter().try_for_each(|model| line(model.name, model.summary, model.has_counts()))?;
    let default = MODELS.into_iter().find(|model| model.terms().len() == 2);
    for (kind, terms) in [("masking", &MASKINGS[..]), ("fresnel", &FRESNELS[..])] {
        print(&format!("{HEADING}{kind}{HEADING:#} of a microfacet model, the default first"))?;
        for term in terms {
            let [masking, fresnel] = ["masking", "fresnel"].map(|this| (this == kind).then_some(term.name));
            let with_term = default.and_then(|model| model.with_terms(masking, fresnel).ok());
            line(term.name, term.summary, with_term.is_none_or(Model::has_counts))?;
        }
    }
    Ok(())
}

fn one(model: &Model, as_json: bool) -> Result<()> {
    let (parameters, promises) = (parameters(model), promises(model));
    if as_json {
        let parameter = |p: &ParameterEntry| json!({ "name": p.name, "range": p.range, "unit": p.unit, "default": p.default, "what": p.what });
        let metal = |m: &Metal| json!({ "name": m.name, "eta": m.eta, "k": m.k, "source": m.source });
        return print_json(&json!({
            "name": model.name, "summary": model.summary, "source": model.source,
            "parameters": parameters.iter().map(parameter).collect::<Vec<_>>(),
            "parts": model.parts.iter().map(|part| part.name).collect::<Vec<_>>(),
            "node_counts": model.has_counts(),
            "metals": model.metals().iter().map(metal).collect::<Vec<_>>(), "promises": promises,
        }));
    }
    print(&format!("{HEADING}{}{HEADING:#}  {}", model.name, model.summary))?;
    print(&format!("{HEADING}source{HEADING:#}  {}", model.source))?;
    print(&format!("{HEADING}parameters{HEADING:#}"))?;
    let width = column(parameters.iter().map(|parameter| parameter.name));
    for ParameterEntry { name, range, unit, default, what } in &parameters {
        let default = default.as_ref().map_or("no default".into(), |default| format!("default {default}"));
        print(&format!("  {name:width$}{what}"))?;
        print(&format!(
            "  {:width$}{range}{}{unit}; {default}",
            "",
            if unit.is_empty() { "" } else { ", " }
        ))?;
    }
    print(&format!("{HEADING}parts{HEADING:#}"))?;
    for part in model.parts {
        print(&format!("  shaders/{}.wgsl", part.name))?;
    }
    if !model.has_counts() {
        print(&format!("{HEADING}node counts{HEADING:#}  none; integrals by adaptive quadrature, slow"))?;
    }
    if !model.metals().is_empty() {
        print(&format!("{HEADING}metals{HEADING:#}"))?;
    }
    let width = column(model.metals().iter().map(|metal| metal.name));
    for Metal { name, eta, k, source } in model.metals() {
        print(&format!("  {name:width$}eta = {eta:?}, k = {k:?}; {source}"))?;
    }
    print(&format!("{HEADING}promises{HEADING:#}"))?;
    promises.iter().try_for_each(|promise| print(&format!("  {promise}")))
}

/// Returns the width of a column of names, with two blanks after the longest.
fn column<'a>(names: impl Iterator<Item = &'a str>) -> usize {
    names.map(str::len).max().unwrap_or(0) + 2
}

const DIMENSIONLESS: &str = "dimensionless";

/// Lists all parameters of a model.
pub(super) fn parameters(model: &Model) -> Vec<ParameterEntry> {
    let mut all = Vec::new();
    if let Some(Shape { name, summary, unit, most, least, .. }) = model.shape {
        let values = if least > 0.0 { format!("; values from {name} = {least:e}") } else { String::new() };
        all.push(ParameterEntry {
            name: "roughness",
            range: "[0, 1]".into(),
            unit: DIMENSIONLESS,
            default: None,
            what: format!("{summary}{values}"),
        });
        if name != "roughness" {
            all.push(ParameterEntry {
                name,
                range: format!("[0, {most}]"),
                unit: if unit.is_empty() { DIMENSIONLESS } else { unit },
                default: None,
                what: "replaces roughness: give one of the two".into(),
            });
        }
    }
    all.extend(model.parameters.iter().map(|p| ParameterEntry {
        name: p.name,
        range: format!("[{}, {}]", p.range[0], p.range[1]),
        unit: if p.unit.is_empty() { DIMENSIONLESS } else { p.unit },
        default: p.default.map(|x| x.to_string()),
        what: p.summary.into(),
    }));
    if !model.metals().is_empty() {
        all.push(ParameterEntry {
            name: "metal",
            range: model.metals().iter().map(|metal| metal.name).collect::<Vec<_>>().join(" | "),
            unit: "",
            default: Some("none".into()),
            what: "replaces eta and k, for R, G and B at 611.4, 549.1 and 464.2 nm".into(),
        });
    }
    all.extend(model.terms().into_iter().map(|(name, terms, term)| ParameterEntry {
        name,
        range: terms.iter().map(|term| term.name).collect::<Vec<_>>().join(" | "),
        unit: "",
        default: Some(term.name.into()),
        what: term.summary.into(),
    }));
    all.extend(Compensation::is_for(model).then(|| ParameterEntry {
        name: "compensation",
        range: Compensation::ALL.map(Compensation::name).join(" | "),
        unit: "",
        default: Some(Compensation::None.name().into()),
        what: "method that restores the light lost between microfacets".into(),
    }));
    all.extend(model.components.iter().map(|&Component { name, weight, default }| ParameterEntry {
        name: weight,
        range: "[0, 1], or three for R, G, B".into(),
        unit: DIMENSIONLESS,
        default: default.map(|x| x.to_string()),
        what: format!("weight of component {name}"),
    }));
    all
}

/// Returns `--set` options for three settings that show a model: of its roughness, or else of its weights.
pub(super) fn settings(model: &Model) -> Vec<String> {
    let mut sets = Vec::new();
    if let Some(shape) = model.shape {
        // Diffuse lobes differ little below the largest.
        let roughness = if shape.least > 0.0 { "0.1,0.3,0.6" } else { "0,0.5,1" };
        sets.push(format!("roughness={roughness}"));
    }
    for component in model.components {
        match (sets.is_empty(), component.default) {
            (true, _) => sets.push(format!("{}=0.2,0.5,0.8", component.weight)),
            (false, None) => sets.push(format!("{}=0.8", component.weight)),
            (false, Some(_)) => {}
        }
    }
    sets
}

/// Describes the promises that a model keeps, and its known bounds.
pub(super) fn promises(model: &Model) -> Vec<String> {
    let mut promises = vec!["finite, not negative, reciprocal, isotropic".to_owned()];
    promises.push(match model.integral {
        Integral::Unbounded(why) => format!("no energy bound: {why}"),
        _ => format!("energy: ρ_dh ≤ {} with every weight 1", model.rho_bound),
    });
    if model.is_delta() {
        promises[0] = "a delta: integrals, and no values".into();
    }
    promises
}

fn terms(terms: &[Term]) -> Vec<Value> {
    terms.iter().map(|t| json!({ "name": t.name, "summary": t.summary, "source": t.source })).collect()
}
