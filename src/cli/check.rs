//! `gonio check`

mod exceptions;
mod pictures;
mod targets;

use crate::backend::gpu::{Device, DeviceChoice, INSTALL};
use crate::bake::Evaluator;
use crate::base::error::{Error, Result};
use crate::base::timings::Stopwatch;
use crate::cli::print::{ERROR, GOOD, WARNING};
use crate::cli::watch::Watch;
use crate::cli::{HEADING, device_json, junit, open, print_beside, print_json, warn};
use crate::io::Outputs;
use crate::scene;
use crate::verify;
use crate::verify::user_shader::{UserFunction, UserShader, directions};
use crate::verify::{
    Exceptions, Finding, Input, Limited, ParameterRange, Report, STEPS, Symmetry, Verdict, VerifyOptions,
};
use serde_json::json;
use std::path::{Path, PathBuf};
use targets::CheckTarget;
pub(super) use targets::quoted;

#[derive(clap::Args)]
#[command(after_help = AFTER_HELP)]
pub struct Args {
    /// A scene or recipe, of which every material and basis is checked
    #[arg(value_name = "SCENE", conflicts_with_all = ["model", "wgsl", "set"])]
    scene: Option<PathBuf>,
    /// Check only this material of the scene
    #[arg(long, value_name = "NAME", requires = "scene")]
    material: Option<String>,
    /// A model, by its name in `gonio models`
    #[arg(long, value_name = "NAME", conflicts_with = "wgsl")]
    model: Option<String>,
    /// Your own WGSL file with a BRDF
    #[arg(long, value_name = "FILE", requires = "entry")]
    wgsl: Option<PathBuf>,
    /// The function in that file: (wi: vec3f, wo: vec3f, further f32 parameters) -> f32 or vec3f, in sr⁻¹. Both directions
    /// are unit vectors that point away from the surface, whose normal is +z
    #[arg(long, value_name = "NAME", requires = "wgsl")]
    entry: Option<String>,
    /// Set a parameter to a value, or to a range to check. A WGSL function needs every parameter; a model's
    /// unset parameters are checked over their whole range
    #[arg(long, value_name = "NAME=VALUE|LOW..HIGH")]
    set: Vec<String>,
    /// The function returns f cos θi: gonio divides by cos θi, at least 2⁻²⁴
    #[arg(long, requires = "wgsl")]
    cosine: bool,
    /// Do not expect isotropy or bilateral symmetry
    #[arg(long, requires = "wgsl")]
    anisotropic: bool,
    /// Number of inputs to evaluate for each subject before the search, e.g. 1e8. Results do not depend on the
    /// speed of the machine
    #[arg(long, value_name = "N", default_value = "2e7", value_parser = budget)]
    budget: u64,
    /// `auto` or part of an adapter's name; for scenes and models also `cpu`
    #[arg(long, value_name = "NAME", default_value = "auto")]
    device: DeviceChoice,
    #[command(flatten)]
    exceptions: exceptions::ExceptionArgs,
    /// Print JSON on stdout and messages on stderr
    #[arg(long)]
    json: bool,
    /// Write JUnit XML for CI, one test suite for each subject
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
    /// A folder for pictures of ρ_dh over θi and of the error against the reference, created if missing
    #[arg(long, short, value_name = "DIR", conflicts_with = "wgsl")]
    out: Option<PathBuf>,
}

const AFTER_HELP: &str = "\
Examples:
  gonio check scene.gltf
  gonio check recipe.toml --material gold --out pictures
  gonio check --model ggx --set alpha=1e-6..1 --set f0=0.04 --budget 1e8
  gonio check --wgsl brdf.wgsl --entry brdf
  gonio check --wgsl brdf.wgsl --entry brdf --set roughness=0.05..1 --set metallic=0 --junit check.xml
  gonio check --wgsl brdf.wgsl --entry shade --cosine --anisotropic --json

Promises: finite, non-negative, reciprocity, isotropy, bilateral symmetry, agreement
with the f64 reference (scenes and models), and energy (ρ_dh ≤ 1). The worst input of each is printed with all
digits, as a command to paste; for your own WGSL file: its options and the two vectors.
If a format is known to break a promise, gonio reports it and checks the known bound.

Exit codes: 0 all promises hold (or break within their known bound), 1 a promise is broken or not checked, 2 bad input,
3 no device, 130 interrupted";

/// Parses a count, also as 1e8.
fn budget(text: &str) -> Result<u64, String> {
    let value: f64 = text.parse().map_err(|_| format!("\"{text}\" is not a number"))?;
    if (1.0..=1e12).contains(&value) { Ok(value as u64) } else { Err("give a count from 1 to 1e12".into()) }
}

pub fn run(args: &Args) -> Result<()> {
    // clap forgives a missing requirement that conflicts with what is there.
    if args.wgsl.is_none() && (args.entry.is_some() || args.cosine || args.anisotropic) {
        return Err(Error::input("--entry, --cosine and --anisotropic are for --wgsl FILE"));
    }
    match (&args.scene, &args.model, &args.wgsl, &args.entry) {
        (Some(path), ..) => {
            let scene = scene::read(path)?;
            let (evaluator, line) = open(&args.device)?;
            scene.warnings.iter().for_each(|warning| warn(warning));
            let targets = targets::scene(path, &scene, args.material.as_deref(), evaluator)?;
            check_targets(args, targets, evaluator, &line, &exceptions::read(&args.exceptions, Some(path))?)
        }
        (_, Some(model), ..) => {
            let (evaluator, line) = open(&args.device)?;
            {
                let exceptions = exceptions::read(&args.exceptions, None)?;
                check_targets(
                    args,
                    vec![targets::model(args, model, evaluator)?],
                    evaluator,
                    &line,
                    &exceptions,
                )
            }
        }
        (_, _, Some(path), Some(entry)) => check_shader(args, path, entry),
        _ => Err(Error::input("give a SCENE, --model NAME, or --wgsl FILE and --entry NAME")),
    }
}

/// Checks models, bases and materials, one subject after the other.
fn check_targets(
    args: &Args,
    targets: Vec<CheckTarget>,
    evaluator: &Evaluator,
    line: &str,
    exceptions: &Exceptions,
) -> Result<()> {
    print_beside(args.json, &format!("{HEADING}device{HEADING:#}  {line}"))?;
    let watch = Watch::new(STEPS * targets.len());
    let mut all = Vec::new();
    let mut outputs = Outputs::default();
    if let Some(dir) = &args.out {
        outputs.folder(dir)?;
    }
    for (k, CheckTarget { mut subject, command }) in targets.into_iter().enumerate() {
        let start = Stopwatch::start();
        let report = verify::check(&mut Limited::new(&mut subject, exceptions), &args.options(), &watch)?;
        let seconds = start.seconds();
        let has_values = |finding: &Finding| !finding.values.is_empty();
        let eval = |f: &Finding| Some(format!("{command} {}", f.input.as_ref().filter(|_| has_values(f))?));
        let inputs = report.findings.iter().map(eval).collect();
        watch.hide(|| show_report(args, &report, seconds, &inputs))?;
        if let Some(dir) = &args.out {
            let plain = |c: char| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '_' };
            let stem = format!("{k}_{}", report.subject.chars().map(plain).collect::<String>());
            for path in pictures::write(dir, &stem, &mut subject, &report, &mut outputs)? {
                watch.hide(|| print_beside(args.json, &format!("{:15}{}", "", path.display())))?;
            }
        }
        all.push(Checked { report, seconds, inputs });
    }
    watch.finish();
    if let Some(path) = &args.junit {
        junit::write(path, &all, &mut outputs)?;
    }
    outputs.commit()?;
    if args.json {
        let subjects = all.iter().map(|checked| {
            let findings = checked.report.findings.iter().zip(&checked.inputs).map(|(finding, eval)| {
                let mut value = json!(finding);
                if finding.input.is_some() {
                    value["input"]["eval"] = json!(eval);
                }
                value
            });
            let Checked { report, seconds, .. } = checked;
            json!({
                "subject": report.subject, "evaluated": report.evaluated, "seconds": seconds,
                "kept": report.is_kept(), "notes": report.notes, "findings": findings.collect::<Vec<_>>(),
            })
        });
        print_json(&json!({
            "device": device_json(evaluator),
            "evaluated": all.iter().map(|checked| checked.report.evaluated).sum::<u64>(),
            "seconds": all.iter().map(|checked| checked.seconds).sum::<f64>(),
            "kept": all.iter().all(|checked| checked.report.is_kept()),
            "subjects": subjects.collect::<Vec<_>>(),
        }))?;
    }
    verdict(&all)
}

/// Checks a function in a user's WGSL file.
fn check_shader(args: &Args, path: &Path, entry: &str) -> Result<()> {
    let file = path.display().to_string();
    let source = std::fs::read(path).map_err(Error::io("read", path))?;
    let source = String::from_utf8(source).map_err(|e| {
        Error::input(format!("{file} is not text in UTF-8, from byte {}", e.utf8_error().valid_up_to()))
    })?;
    let function = UserFunction::parse(&file, source, entry)?;
    let parameters = parameters(&function, &args.set)?;
    let exceptions = exceptions::read(&args.exceptions, Some(path))?;

    let (device, line) = Device::choose(&args.device)?;
    let device = device.ok_or_else(|| {
        Error::Device(format!(
            "WGSL needs a Vulkan device, and there is no CPU path for it ({line}). {INSTALL}"
        ))
    })?;
    // It lives as long as the process, see `open`.
    let device: &'static Device = Box::leak(Box::new(device));
    let symmetry = Symmetry { isotropic: !args.anisotropic, bilateral: !args.anisotropic };
    let mut subject = UserShader::new(device, function, parameters, args.cosine, symmetry)?;

    let start = Stopwatch::start();
    let watch = Watch::new(STEPS);
    let report = verify::check(&mut Limited::new(&mut subject, &exceptions), &args.options(), &watch);
    watch.finish();
    let report = report?;
    let seconds = start.seconds();
    let vectors = |input: &Input| directions(&input.angles, args.cosine);
    let words = |input: &Input| {
        let [wi, wo] = vectors(input).map(|[x, y, z]| format!("({x:?}, {y:?}, {z:?})"));
        format!("{input}\n{:15}wi = {wi}, wo = {wo}", "")
    };
    let inputs = report.findings.iter().map(|finding| finding.input.as_ref().map(words)).collect();

    print_beside(args.json, &format!("{HEADING}device{HEADING:#}  {line}"))?;
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
            "subject": report.subject,
            "device": { "kind": device.kind(), "name": device.name(), "driver": device.driver() },
            "evaluated": report.evaluated, "seconds": seconds, "kept": report.is_kept(), "notes": report.notes,
            "findings": findings,
        }))?;
    }
    verdict(&checked)
}

/// A subject's report, its duration, and the worst input of each finding as options to paste.
pub(super) struct Checked {
    pub report: Report,
    pub seconds: f64,
    pub inputs: Vec<Option<String>>,
}

impl Args {
    fn options(&self) -> VerifyOptions {
        VerifyOptions { budget: self.budget, ..VerifyOptions::default() }
    }
}

fn show_report(args: &Args, report: &Report, seconds: f64, inputs: &Vec<Option<String>>) -> Result<()> {
    print_beside(
        args.json,
        &format!(
            "{HEADING}{}{HEADING:#}, {} pairs of directions in {seconds:.1} s",
            report.subject, report.evaluated
        ),
    )?;
    for note in &report.notes {
        print_beside(args.json, &format!("{:15}{note}", ""))?;
    }
    for (finding, input) in report.findings.iter().zip(inputs) {
        print_beside(args.json, &show(finding))?;
        if let Some(input) = input {
            print_beside(args.json, &format!("{:15}{input}", ""))?;
        }
    }
    Ok(())
}

/// Parses `--set` into one value or range for each parameter of the function.
fn parameters(function: &UserFunction, sets: &[String]) -> Result<Vec<ParameterRange>> {
    let mut given = Vec::new();
    for set in sets {
        let fault = || {
            Error::input(format!("--set {set}: give NAME=VALUE or NAME=LOW..HIGH, as in --set alpha=0.1..1"))
        };
        let (name, range) = set.split_once('=').ok_or_else(fault)?;
        let (low, high) = range.split_once("..").unwrap_or((range, range));
        let number = |text: &str| text.trim().parse::<f64>().map_err(|_| fault());
        let parameter = ParameterRange::new(name.trim(), number(low)?, number(high)?)
            .map_err(|e| e.at(format!("--set {set}")))?;
        if !function.parameters().contains(&parameter.name) {
            let names = function.parameters().join(", ");
            let there = if names.is_empty() { "it has none".into() } else { format!("there are {names}") };
            return Err(Error::input(format!(
                "--set {set}: the function has no parameter \"{}\"; {there}",
                parameter.name
            )));
        }
        if given.iter().any(|other: &ParameterRange| other.name == parameter.name) {
            return Err(Error::input(format!("--set {set}: \"{}\" is given twice", parameter.name)));
        }
        given.push(parameter);
    }
    let find = |name: &String| {
        given.iter().find(|parameter| parameter.name == *name).cloned().ok_or_else(|| {
            Error::input(format!(
                "parameter \"{name}\" has no value; give --set {name}=VALUE or --set {name}=LOW..HIGH"
            ))
        })
    };
    function.parameters().iter().map(find).collect()
}

/// Formats one finding as a line.
fn show(finding: &Finding) -> String {
    let (style, word) = match finding.verdict {
        Verdict::Kept => (GOOD, "kept    "),
        Verdict::Declared => (WARNING, "declared"),
        Verdict::Broken => (ERROR, "BROKEN  "),
        Verdict::Unchecked => (ERROR, "UNKNOWN "),
    };
    let note = finding.note.as_ref().map_or(String::new(), |note| format!("; {note}"));
    format!("{:13}  {style}{word}{style:#}  {}{note}", finding.property, finding.said)
}

/// Returns an error that names the broken promises, if there are any.
fn verdict(all: &[Checked]) -> Result<()> {
    let broken = |report: &Report| -> Vec<_> {
        report.findings.iter().filter(|f| f.verdict == Verdict::Broken).map(|f| f.property).collect()
    };
    let words: Vec<_> = all
        .iter()
        .filter(|checked| !checked.report.is_kept())
        .map(|Checked { report, .. }| match broken(report)[..] {
            [] => format!("{} is not checked", report.subject),
            ref names => format!("{} breaks {}", report.subject, names.join(", ")),
        })
        .collect();
    if words.is_empty() { Ok(()) } else { Err(Error::Promise(words.join("; "))) }
}
