//! Checks a function of the user's own shader.

use super::{Args, Checked, exceptions, resources, show_report, verdict};
use crate::backend::gpu::{Device, INSTALL};
use crate::base::error::{Error, Result};
use crate::base::timings::Stopwatch;
use crate::cli::watch::Watch;
use crate::cli::{HEADING, junit, print_beside, print_json};
use crate::io::Outputs;
use crate::verify::user_shader::{ShaderOptions, UserFunction, UserShader, directions, is_shader};
use crate::verify::{self, Input, Limited, ParameterRange, STEPS, Symmetry};
use serde_json::json;
use std::path::{Path, PathBuf};

/// The file and the function that are meant by `FILE#ENTRY`, or by `--wgsl` and `--entry`; none where it is a scene.
pub fn named(args: &Args) -> Result<Option<(PathBuf, Option<String>)>> {
    if let Some(path) = &args.wgsl {
        return Ok(Some((path.clone(), args.entry.clone())));
    }
    let Some(path) = &args.scene else { return Ok(None) };
    let text = path.to_string_lossy();
    let (file, entry) = match text.rsplit_once('#') {
        Some((file, entry)) if !path.exists() => (PathBuf::from(file), Some(entry.to_owned())),
        _ => (path.clone(), None),
    };
    match (is_shader(&file), &entry, &args.entry) {
        (false, ..) => Ok(None),
        (_, Some(a), Some(b)) if a != b => {
            Err(Error::input(format!("{text} names fn {a}, and --entry {b}; give one of them")))
        }
        _ => Ok(Some((file, entry.or(args.entry.clone())))),
    }
}

pub fn check_shader(args: &Args, path: &Path, entry: Option<String>) -> Result<()> {
    let mut function = UserFunction::read(path, &options(args, entry)?)?;
    resources::bind(&mut function, &args.bind)?;
    let parameters = ranges(&function, &args.set)?;
    let understood = function.describe(&parameters);
    let unit = if args.cosine { "f cos θi in sr⁻¹" } else { "f in sr⁻¹" };
    let up = function.up();

    let (device, line) = Device::choose(&args.device)?;
    let device = device.ok_or_else(|| {
        Error::Device(format!(
            "a shader needs a Vulkan device, and there is no CPU path for it ({line}). {INSTALL}"
        ))
    })?;
    print_beside(args.json, &format!("{HEADING}device{HEADING:#}  {line}"))?;
    print_beside(args.json, &format!("{HEADING}shader{HEADING:#}  {understood}, {unit}"))?;
    // It lives as long as the process, see `open`.
    let device: &'static Device = Box::leak(Box::new(device));
    let symmetry = Symmetry { isotropic: !args.anisotropic, bilateral: !args.anisotropic };
    let exceptions = exceptions::read(&args.exceptions, Some(path))?;
    let mut subject = UserShader::new(device, function, parameters, args.cosine, symmetry)?;

    let start = Stopwatch::start();
    let watch = Watch::new(STEPS);
    let report = verify::check(&mut Limited::new(&mut subject, &exceptions), &args.options(), &watch);
    watch.finish();
    let report = report?;
    let seconds = start.seconds();
    let vectors = |input: &Input| directions(&input.angles, args.cosine).map(|vector| up.turned(vector));
    let words = |input: &Input| {
        let [wi, wo] = vectors(input).map(|[x, y, z]| format!("({x:?}, {y:?}, {z:?})"));
        format!("{input}\n{:15}wi = {wi}, wo = {wo}", "")
    };
    let inputs = report.findings.iter().map(|finding| finding.input.as_ref().map(words)).collect();
    show_report(args, &report, seconds, &inputs)?;
    let inputs = report.findings.iter().map(|f| f.input.as_ref().map(Input::to_string)).collect();
    let checked = [Checked { report, seconds, inputs }];
    if let Some(path) = &args.junit {
        let mut outputs = Outputs::default();
        junit::write(path, &checked, &mut outputs)?;
        outputs.commit()?;
    }
    let report = &checked[0].report;
    if args.json {
        let findings: Vec<_> = report
            .findings
            .iter()
            .map(|finding| {
                let mut value = json!(finding);
                if let Some(input) = &finding.input {
                    let [wi, wo] = vectors(input);
                    value["input"]["eval"] = json!(input.to_string());
                    value["input"]["wi"] = json!(wi);
                    value["input"]["wo"] = json!(wo);
                }
                value
            })
            .collect();
        print_json(&json!({
            "subject": report.subject, "understood": understood,
            "device": { "kind": device.kind(), "name": device.name(), "driver": device.driver() },
            "evaluated": report.evaluated, "seconds": seconds, "kept": report.is_kept(), "notes": report.notes,
            "findings": findings,
        }))?;
    }
    verdict(&checked)
}

/// How the command line wants the shader to be read.
fn options(args: &Args, entry: Option<String>) -> Result<ShaderOptions> {
    let mut options = ShaderOptions {
        entry,
        result: args.result.clone(),
        up: args.up.parse().map_err(|error: Error| error.at("--up"))?,
        includes: args.include.clone(),
        parameters: args.set.iter().filter_map(|set| Some(set.split_once('=')?.0.trim().into())).collect(),
        ..ShaderOptions::default()
    };
    for role in &args.role {
        let (name, role) = role.split_once('=').ok_or_else(|| {
            Error::input(format!(
                "--role {role}: give NAME=ROLE, as in --role x=NdotL or --role direction=-L"
            ))
        })?;
        options.roles.push((name.trim().into(), role.trim().into()));
    }
    for define in &args.define {
        // As compilers do.
        let (name, value) = define.split_once('=').unwrap_or((define, "1"));
        options.defines.push((name.trim().into(), value.trim().into()));
    }
    Ok(options)
}

/// Parses `--set` into a value or range for each number that the function takes.
fn ranges(function: &UserFunction, sets: &[String]) -> Result<Vec<ParameterRange>> {
    let parameters = function.parameters();
    let mut given: Vec<Option<ParameterRange>> = vec![None; parameters.len()];
    for set in sets {
        let fault = || {
            Error::input(format!(
                "--set {set}: give NAME=VALUE or NAME=LOW..HIGH, as in --set alpha=0.1..1, and commas between components"
            ))
        };
        let (name, values) = set.split_once('=').ok_or_else(fault)?;
        let name = component(name.trim());
        let indices: Vec<_> =
            (0..parameters.len()).filter(|&k| is_within(&parameters[k].name, &name)).collect();
        if indices.is_empty() {
            return Err(Error::input(format!(
                "--set {set}: the function has no parameter \"{name}\"; {}",
                settable(function)
            )));
        }
        let values: Vec<_> = values.split(',').collect();
        if values.len() != 1 && values.len() != indices.len() {
            let count = indices.len();
            return Err(Error::input(format!(
                "--set {set}: \"{name}\" has {count} components; give one value, or {count}"
            )));
        }
        for (n, k) in indices.into_iter().enumerate() {
            let value = values[n % values.len()];
            let (low, high) = value.split_once("..").unwrap_or((value, value));
            let range = ParameterRange::new(
                &parameters[k].name,
                number(low).ok_or_else(fault)?,
                number(high).ok_or_else(fault)?,
            );
            let range = range.map_err(|e| e.at(format!("--set {set}")))?;
            if given[k].replace(range).is_some() {
                return Err(Error::input(format!("--set {set}: \"{}\" is given twice", parameters[k].name)));
            }
        }
    }
    if let Some(k) = given.iter().position(Option::is_none) {
        let whole = function.settable();
        let names = whole.iter().filter_map(|text| text.split_once(": ")).map(|(name, _)| name);
        let name = names
            .into_iter()
            .find(|name| is_within(&parameters[k].name, name))
            .unwrap_or(&parameters[k].name);
        return Err(Error::input(format!(
            "parameter \"{name}\" has no value; give --set {name}=VALUE or --set {name}=LOW..HIGH; {}",
            settable(function)
        )));
    }
    Ok(given.into_iter().flatten().collect())
}

/// The name of a component: `color.r` is `color.x`.
fn component(name: &str) -> String {
    match name.rsplit_once('.') {
        Some((vector, axis @ ("r" | "g" | "b" | "a"))) => {
            let axis = match axis {
                "r" => "x",
                "g" => "y",
                "b" => "z",
                _ => "w",
            };
            format!("{vector}.{axis}")
        }
        _ => name.to_owned(),
    }
}

/// Whether a number is what a name means, or a part of it.
fn is_within(parameter: &str, name: &str) -> bool {
    parameter.strip_prefix(name).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
}

fn number(text: &str) -> Option<f64> {
    match text.trim() {
        "true" => Some(1.0),
        "false" => Some(0.0),
        text => text.parse().ok(),
    }
}

/// What can be set, for messages.
fn settable(function: &UserFunction) -> String {
    match function.settable()[..] {
        [] => "it has none".into(),
        ref all => format!("there are {}", all.join(", ")),
    }
}
