//! `gonio check`

mod exceptions;
mod pictures;
mod resources;
mod shader;
mod targets;

use crate::backend::gpu::DeviceChoice;
use crate::bake::Evaluator;
use crate::base::error::{Error, Result};
use crate::base::timings::Stopwatch;
use crate::cli::print::{ERROR, GOOD, WARNING};
use crate::cli::watch::Watch;
use crate::cli::{HEADING, device_json, junit, open, print_beside, print_json, warn};
use crate::io::Outputs;
use crate::scene;
use crate::verify;
use crate::verify::{Exceptions, Finding, Limited, Report, STEPS, Verdict, VerifyOptions};
use serde_json::json;
use std::path::PathBuf;
use targets::CheckTarget;
pub(super) use targets::quoted;

#[derive(clap::Args)]
#[command(after_help = AFTER_HELP)]
pub struct Args {
    /// A scene or recipe, of which every material and basis is checked; or your own shader, as FILE#FUNCTION
    #[arg(value_name = "SCENE|SHADER", conflicts_with_all = ["model", "wgsl"])]
    scene: Option<PathBuf>,
    /// Check only this material of the scene
    #[arg(long, value_name = "NAME", requires = "scene")]
    material: Option<String>,
    /// A model, by its name in `gonio models`
    #[arg(long, value_name = "NAME", conflicts_with = "wgsl")]
    model: Option<String>,
    /// Your own file with a BRDF, in WGSL or GLSL; the same as SHADER
    #[arg(long, value_name = "FILE")]
    wgsl: Option<PathBuf>,
    /// The function in that file, where several can be a BRDF. It takes the directions of light and view, which point away
    /// from the surface, and returns f in sr⁻¹
    #[arg(long, value_name = "NAME")]
    entry: Option<String>,
    /// Set a parameter to a value, or to a range to check; several components by commas. A shader needs every
    /// parameter; a model's unset parameters are checked over their whole range
    #[arg(long, value_name = "NAME=VALUE|LOW..HIGH")]
    set: Vec<String>,
    /// Say what an argument of the shader is, where its name does not tell: L, V, N, H, T, B or R, -L, NdotL, or `parameter`
    #[arg(long, value_name = "NAME=ROLE")]
    role: Vec<String>,
    /// The member of the shader's result that is the BRDF
    #[arg(long, value_name = "NAME")]
    result: Option<String>,
    /// The axis of the shader's frame that is the normal
    #[arg(long, value_name = "x|y|z", default_value = "z", hide_default_value = true)]
    up: String,
    /// A folder of files that the shader includes or imports
    #[arg(long, value_name = "DIR")]
    include: Vec<PathBuf>,
    /// Define a macro of the shader's preprocessor
    #[arg(long, value_name = "NAME[=VALUE]")]
    define: Vec<String>,
    /// Bind a texture that the shader reads to a picture (EXR, NPY, PNG, JPEG), or a sampler to `linear` or `nearest`,
    /// with `-clamp` or `-repeat`
    #[arg(long, value_name = "NAME=FILE|SAMPLER")]
    bind: Vec<String>,
    /// The function returns f cos θi: gonio divides by cos θi, at least 2⁻²⁴
    #[arg(long)]
    cosine: bool,
    /// Do not expect isotropy or bilateral symmetry
    #[arg(long)]
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
  gonio check brdf.wgsl
  gonio check brdf.wgsl#GGX_specular --set roughness=0.05..1 --set base_color=0..1 --junit check.xml
  gonio check light.frag#shade --cosine --anisotropic --include chunks --define CLEARCOAT --json

Promises: finite, non-negative, reciprocity, isotropy, bilateral symmetry, agreement
with the f64 reference (scenes and models), and energy (ρ_dh ≤ 1). The worst input of each is printed with all
digits, as a command to paste; for your own shader: its options and the two vectors.
If a format is known to break a promise, gonio reports it and checks the known bound.

Exit codes: 0 all promises hold (or break within their known bound), 1 a promise is broken or not checked, 2 bad input,
3 no device, 130 interrupted";

/// Parses a count, also as 1e8.
fn budget(text: &str) -> Result<u64, String> {
    let value: f64 = text.parse().map_err(|_| format!("\"{text}\" is not a number"))?;
    if (1.0..=1e12).contains(&value) { Ok(value as u64) } else { Err("give a count from 1 to 1e12".into()) }
}

pub fn run(args: &Args) -> Result<()> {
    if let Some((path, entry)) = shader::named(args)? {
        return shader::check_shader(args, &path, entry);
    }
    if let Some(option) = args.shader_option() {
        return Err(Error::input(format!("{option} is for a shader; give FILE#FUNCTION")));
    }
    if args.scene.is_some() && !args.set.is_empty() {
        return Err(Error::input("--set is for a shader or a --model; a scene sets its own parameters"));
    }
    match (&args.scene, &args.model) {
        (Some(path), ..) => {
            let scene = scene::read(path)?;
            let (evaluator, line) = open(&args.device)?;
            scene.warnings.iter().for_each(|warning| warn(warning));
            let targets = targets::scene(path, &scene, args.material.as_deref(), evaluator)?;
            check_targets(args, targets, evaluator, &line, &exceptions::read(&args.exceptions, Some(path))?)
        }
        (_, Some(model)) => {
            let (evaluator, line) = open(&args.device)?;
            let exceptions = exceptions::read(&args.exceptions, None)?;
            check_targets(args, vec![targets::model(args, model, evaluator)?], evaluator, &line, &exceptions)
        }
        _ => Err(Error::input("give a SCENE, a SHADER such as brdf.wgsl#brdf, or --model NAME")),
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

    /// An option that only a shader has, if one is given.
    fn shader_option(&self) -> Option<&'static str> {
        let given = [
            (self.entry.is_some(), "--entry"),
            (self.cosine, "--cosine"),
            (self.anisotropic, "--anisotropic"),
            (!self.role.is_empty(), "--role"),
            (self.result.is_some(), "--result"),
            (self.up != "z", "--up"),
            (!self.include.is_empty(), "--include"),
            (!self.define.is_empty(), "--define"),
            (!self.bind.is_empty(), "--bind"),
        ];
        given.into_iter().find(|(is_given, _)| *is_given).map(|(_, option)| option)
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
