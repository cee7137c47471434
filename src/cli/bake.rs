//! `gonio bake`

use crate::backend::gpu::DeviceChoice;
use crate::base::error::{Error, Result};
use crate::base::timings::Stopwatch;
use crate::base::timings::Timings;
use crate::base::words::alternatives;
use crate::batch::{Baked, SetOptions, Streaming, bake_set};
use crate::check::Check;
use crate::cli::watch::Watch;
use crate::cli::{HEADING, open, print, print_json, tell, warn};
use crate::io::target::IDENTITY;
use crate::io::{Format, format};
use crate::scene;
use crate::scene::planner::{Plan, Selection, UNUSED};
use crate::table::quantity;
use serde_json::json;
use std::path::PathBuf;

#[derive(clap::Args)]
#[command(after_help = AFTER_HELP)]
pub struct Args {
    /// A scene (.gltf, .glb) or a recipe (.toml)
    scene: PathBuf,
    /// The folder for the tables and manifest.json, created if missing
    #[arg(long, short, value_name = "DIR", required_unless_present = "dry_run")]
    out: Option<PathBuf>,
    /// The largest error of a table: absolute for integrals, relative for values. It wins over the
    /// recipe's and its tables' [default: those, else 1e-4]
    #[arg(long, value_name = "T", value_parser = tolerance, allow_negative_numbers = true)]
    tolerance: Option<f64>,
    /// `auto` (best GPU, else software Vulkan, else CPU), `cpu`, or part of an adapter's name
    #[arg(long, value_name = "NAME", default_value = "auto")]
    device: DeviceChoice,
    /// Files to write for each table, separated by commas
    #[arg(long, value_name = "F", value_delimiter = ',', default_value = "exr,png", value_parser = format::find)]
    format: Vec<&'static Format>,
    /// Texels of each table to compare with the f64 reference: a count, or all
    #[arg(long, value_name = "N", default_value = "256")]
    check: Check,
    /// Bake only this material and the bases that it uses
    #[arg(long, value_name = "NAME")]
    material: Option<String>,
    #[arg(long, value_name = "Q", help = only_this_quantity())]
    quantity: Option<String>,
    /// Print the plan and compute nothing
    #[arg(long)]
    dry_run: bool,
    /// Print the manifest on stdout and messages on stderr
    #[arg(long)]
    json: bool,
}

/// The help of `--quantity`.
fn only_this_quantity() -> String {
    format!("Bake only this quantity: {}", alternatives(quantity::of_a_brdf().map(|quantity| quantity.name)))
}

const AFTER_HELP: &str = "\
Examples:
  gonio bake helmet.gltf --out tables
  gonio bake helmet.gltf --dry-run
  gonio bake dfg.toml --out tables --format exr,npy --check all --device cpu

A recipe asks for tables without a scene:
  tolerance = 1e-4
  [materials.gold]
  lobes = [{ model = \"ggx\", roughness = 0.3, f0 = [1.0, 0.78, 0.34] }]
  [[tables]]
  quantity = \"brdf\"
  material = \"gold\"
  axes = { theta_i = 32, theta_e = 64, delta_phi = 128 }
  [[tables]]
  name = \"dfg\"
  quantity = \"split_sum\"
  model = \"ggx\"
  axes = { mu = 64, roughness = 64 }

An axis is a count, or { values = [] }, or { count, range = [a, b], positions, mapping } with
positions \"centers\" or \"nodes\" and mapping \"linear\" or \"sqrt\". See docs/recipes.md
for all keys.

Exit codes: 0 success, 1 a table misses its tolerance, 2 bad input, 3 no device, 130 interrupted.
If anything fails, DIR keeps its old contents.";

pub(super) fn tolerance(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| format!("\"{text}\" is not a number"))?;
    if value > 0.0 && value <= 1.0 { Ok(value) } else { Err("give a number above 0, to 1".into()) }
}

pub fn run(args: &Args) -> Result<()> {
    let start = Stopwatch::start();
    let scene = scene::read(&args.scene)?;
    let selection = Selection {
        material: args.material.clone(),
        quantity: args.quantity.clone(),
        tolerance: args.tolerance,
    };
    let plan = Plan::new(&scene, &selection)?;
    let mut stages = Timings { scene: start.seconds(), ..Timings::default() };
    let say = Say { json: args.json };

    if args.dry_run {
        if args.json {
            return print_json(&plan_json(&plan));
        }
        plan.warnings.iter().for_each(|w| warn(w));
        return say.line(plan.to_string().trim_end());
    }
    let Some(out) = &args.out else { return Err(Error::input("give --out DIR")) };
    plan.warnings.iter().for_each(|w| warn(w));

    let start = Stopwatch::start();
    let (evaluator, line) = open(&args.device)?;
    stages.device = start.seconds();
    say.line(&format!("{HEADING}device{HEADING:#}  {line}"))?;

    let watch = Watch::new(2 * plan.tables.len());
    let mut formats = args.format.clone();
    formats.dedup();
    let options =
        SetOptions { formats, target: &IDENTITY, check: args.check, streaming: Streaming::default() };
    let baked = bake_set(&plan, &args.scene, evaluator, out, &options, stages, &watch);
    watch.finish();
    let baked = baked?;
    baked.warnings[plan.warnings.len()..].iter().for_each(|w| warn(w));
    summary(&say, &plan, &baked)?;
    if baked.tiles.found > 0 {
        say.line(&format!(
            "{} of {} tiles were there from an earlier bake",
            baked.tiles.found, baked.tiles.all
        ))?;
    }
    say.line(&format!("{} tables in {}", baked.tables.len(), out.display()))?;
    if args.json { print_json(&baked.manifest) } else { Ok(()) }
}

/// Prints one line for each table: size, error and time.
fn summary(say: &Say, plan: &Plan, baked: &Baked) -> Result<()> {
    let width = baked.tables.iter().map(|t| t.name.chars().count()).max().unwrap_or(0);
    say.line(&format!(
        "{HEADING}{:width$}  {:>16}  {:>9}  {:>9}  {:>9}  {:>7}  {:>8}{HEADING:#}",
        "table", "texels", "max error", "rms", "bilinear", "checked", "time"
    ))?;
    for table in &baked.tables {
        let shape: Vec<_> = table.shape().iter().map(usize::to_string).collect();
        let shape = if shape.is_empty() { "1".into() } else { shape.join("×") };
        let number = |x: Option<f64>| x.map_or("–".into(), |x| format!("{x:.1e}"));
        say.line(&format!(
            "{:width$}  {shape:>16}  {:>9}  {:>9}  {:>9}  {:>7}  {:>5.0} ms",
            table.name,
            number(table.error.measured_max),
            number(table.error.measured_rms),
            number(table.error.interpolation.as_ref().and_then(|between| between.max)),
            table.error.texels_checked,
            1e3 * table.seconds,
        ))?;
    }
    let s = &baked.stages;
    let ms = |name: &str, seconds: f64| format!("{name} {:.0}", 1e3 * seconds);
    let stages = [
        ms("scene", s.scene),
        ms("device", s.device),
        ms("compose", s.compose),
        ms("compile", s.compile),
        ms("dispatch", s.dispatch),
        ms("certify", s.certify),
        ms("readback", s.readback),
        ms("check", s.check),
        ms("write", s.write),
    ];
    say.line(&format!("{HEADING}ms{HEADING:#}  {}", stages.join(", ")))?;
    if !plan.left_out.is_empty() {
        let unused = plan.left_out.iter().filter(|left| left.why == UNUSED).count();
        let others = plan.left_out.len() - unused;
        let words = [(others, "left out"), (unused, "models not used")];
        let words =
            words.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{count} {what}"));
        let words: Vec<_> = words.collect();
        say.line(&format!("{}: see the manifest, or --dry-run", words.join(", ")))?;
    }
    Ok(())
}

/// Describes the plan as JSON, for `--dry-run --json`.
fn plan_json(plan: &Plan) -> serde_json::Value {
    let tables: Vec<_> = plan
        .tables
        .iter()
        .map(|t| {
            json!({
                "name": t.name(),
                "quantity": t.quantity().name,
                "subject": t.subject(),
                "axes": t.axes().iter().map(|a| json!({
                    "name": a.variable().name(), "count": a.len(), "range": a.range(),
                    "positions": a.positions(), "mapping": a.mapping(),
                })).collect::<Vec<_>>(),
                "channels": t.channels(),
                "rule": t.rule().to_string(),
                "tolerance": t.tolerance(),
                "storage": t.storage(),
                "bilinear": t.bilinear(),
            })
        })
        .collect();
    json!({
        "bases": plan.bases, "materials": plan.materials, "tables": tables,
        "left_out": plan.left_out, "warnings": plan.warnings,
    })
}

/// Where words for people go: stdout, or stderr where stdout is for a machine.
struct Say {
    json: bool,
}

impl Say {
    fn line(&self, text: &str) -> Result<()> {
        if self.json {
            tell(text);
            return Ok(());
        }
        print(text)
    }
}
