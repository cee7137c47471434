//! `gonio check`

use super::watch::Watch;
use super::{HEADING, junit, print, print_json, tell};
use crate::error::{Error, Result};
use crate::gpu::{Device, DeviceChoice, INSTALL, UserFunction, UserShader, directions};
use crate::promises::{self, DEFAULT_BUDGET, Finding, Options, Parameter, Report, STEPS, Symmetry, Verdict};
use anstyle::{AnsiColor, Style};
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;

#[derive(clap::Args)]
#[command(after_help = AFTER_HELP)]
pub struct Args {
    /// A WGSL file with a BRDF of your own
    #[arg(long, value_name = "FILE")]
    wgsl: PathBuf,
    /// Its function: (wi: vec3f, wo: vec3f, further f32 parameters) -> f32 or vec3f, in sr⁻¹. Both directions
    /// are unit vectors that point away from the surface, whose normal is +z
    #[arg(long, value_name = "NAME")]
    entry: String,
    /// A parameter of the function: a value, or a range to check; every parameter needs one
    #[arg(long, value_name = "NAME=VALUE|LOW..HIGH")]
    set: Vec<String>,
    /// The function returns f cos θi: the cosine is divided out, θi = 90° taken at cos θi = 2⁻²⁴
    #[arg(long)]
    cosine: bool,
    /// Do not expect isotropy or bilateral symmetry
    #[arg(long)]
    anisotropic: bool,
    /// Values to look at before the search. A count, so that no result depends on the clock
    #[arg(long, value_name = "N", default_value_t = DEFAULT_BUDGET)]
    budget: u64,
    /// auto, or a part of an adapter's name
    #[arg(long, value_name = "NAME", default_value = "auto")]
    device: DeviceChoice,
    /// Print JSON on stdout, and everything for people on stderr
    #[arg(long)]
    json: bool,
    /// Write JUnit XML for CI
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
}

const AFTER_HELP: &str = "\
Examples:
  gonio check --wgsl brdf.wgsl --entry brdf
  gonio check --wgsl brdf.wgsl --entry brdf --set roughness=0.05..1 --set metallic=0 --junit check.xml
  gonio check --wgsl brdf.wgsl --entry shade --cosine --anisotropic --json

Promises: finite, non-negative, reciprocity, isotropy, bilateral symmetry, and energy (ρ_dh ≤ 1). The
worst input of each is printed as options of gonio eval, with every digit, and as the two vectors.

Exit codes: 0 every promise is kept, 1 one is not, 2 bad input, 3 no device, 130 interrupted";

/// Bold green, and bold red.
const KEPT: Style = AnsiColor::Green.on_default().bold();
const BROKEN: Style = AnsiColor::Red.on_default().bold();
const DECLARED: Style = AnsiColor::Yellow.on_default().bold();

pub fn run(args: &Args) -> Result<()> {
    let file = args.wgsl.display().to_string();
    let source = std::fs::read(&args.wgsl).map_err(Error::io("read", &args.wgsl))?;
    let source = String::from_utf8(source).map_err(|e| {
        Error::input(format!("{file} is not text in UTF-8, from byte {}", e.utf8_error().valid_up_to()))
    })?;
    let function = UserFunction::parse(&file, source, &args.entry)?;
    let parameters = parameters(&function, &args.set)?;

    let (device, line) = Device::choose(&args.device)?;
    let device = device.ok_or_else(|| {
        Error::Device(format!(
            "WGSL needs a Vulkan device, and there is no CPU path for it ({line}). {INSTALL}"
        ))
    })?;
    let symmetry = Symmetry { isotropic: !args.anisotropic, bilateral: !args.anisotropic };
    let mut subject = UserShader::new(&device, function, parameters, args.cosine, symmetry)?;

    let start = Instant::now();
    let watch = Watch::new(STEPS);
    let report =
        promises::check(&mut subject, &Options { budget: args.budget, ..Options::default() }, &watch);
    watch.finish();
    let report = report?;
    let seconds = start.elapsed().as_secs_f64();

    if let Some(path) = &args.junit {
        junit::write(path, &report, seconds)?;
    }
    let say = |text: &str| {
        if args.json {
            tell(text);
            return Ok(());
        }
        print(text)
    };
    say(&format!("{HEADING}device{HEADING:#}  {line}"))?;
    say(&format!(
        "{HEADING}{}{HEADING:#}, {} pairs of directions in {seconds:.1} s",
        report.subject, report.evaluated
    ))?;
    for finding in &report.findings {
        say(&show(finding))?;
        if let Some(input) = &finding.input {
            let [wi, wo] =
                directions(&input.angles, args.cosine).map(|[x, y, z]| format!("({x:?}, {y:?}, {z:?})"));
            say(&format!("{:15}{input}", ""))?;
            say(&format!("{:15}wi = {wi}, wo = {wo}", ""))?;
        }
    }
    if args.json {
        let findings: Vec<_> = report
            .findings
            .iter()
            .map(|finding| {
                let mut value = json!(finding);
                if let Some(input) = &finding.input {
                    let [wi, wo] = directions(&input.angles, args.cosine);
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
            "evaluated": report.evaluated, "seconds": seconds, "kept": report.is_kept(), "findings": findings,
        }))?;
    }
    verdict(&report)
}

/// A value or a range for each parameter of the function.
fn parameters(function: &UserFunction, sets: &[String]) -> Result<Vec<Parameter>> {
    let mut given = Vec::new();
    for set in sets {
        let fault = || {
            Error::input(format!("--set {set}: give NAME=VALUE or NAME=LOW..HIGH, as in --set alpha=0.1..1"))
        };
        let (name, range) = set.split_once('=').ok_or_else(fault)?;
        let (low, high) = range.split_once("..").unwrap_or((range, range));
        let number = |text: &str| text.trim().parse::<f64>().map_err(|_| fault());
        let parameter = Parameter::new(name.trim(), number(low)?, number(high)?)
            .map_err(|e| e.at(format!("--set {set}")))?;
        if !function.parameters().contains(&parameter.name) {
            let names = function.parameters().join(", ");
            let there = if names.is_empty() { "it has none".into() } else { format!("there are {names}") };
            return Err(Error::input(format!(
                "--set {set}: the function has no parameter \"{}\"; {there}",
                parameter.name
            )));
        }
        if given.iter().any(|other: &Parameter| other.name == parameter.name) {
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

/// The line of a promise.
fn show(finding: &Finding) -> String {
    let (style, word) = match finding.verdict {
        Verdict::Kept => (KEPT, "kept    "),
        Verdict::Declared => (DECLARED, "declared"),
        Verdict::Broken => (BROKEN, "BROKEN  "),
    };
    let note = finding.note.as_ref().map_or(String::new(), |note| format!("; {note}"));
    format!("{:13}  {style}{word}{style:#}  {}{note}", finding.property, finding.said)
}

/// An error where a promise is broken.
fn verdict(report: &Report) -> Result<()> {
    let broken: Vec<_> =
        report.findings.iter().filter(|f| f.verdict == Verdict::Broken).map(|f| f.property).collect();
    match broken[..] {
        [] => Ok(()),
        _ => Err(Error::Promise(format!("{} breaks {}", report.subject, broken.join(", ")))),
    }
}
