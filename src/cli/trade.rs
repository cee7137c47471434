//! `gonio trade`

use crate::backend::gpu::DeviceChoice;
use crate::base::error::{Error, Result};
use crate::cli::watch::Watch;
use crate::cli::{HEADING, device_json, open, print_beside, print_json, warn};
use crate::lab::trade::{Point, Trade, TradeOptions, measure, write};
use crate::model;
use crate::plan::TablePlan;
use crate::scene;
use crate::scene::planner::{Plan, Selection};
use crate::table::axis::Axis;
use crate::table::quantity;
use std::path::PathBuf;

#[derive(clap::Args)]
#[command(after_help = AFTER_HELP)]
pub struct Args {
    /// A recipe (.toml) or scene, whose first table of integrals is measured
    recipe: Option<PathBuf>,
    /// The folder for trade.csv, trade.json and trade.png, created if missing
    #[arg(long, short, value_name = "DIR")]
    out: PathBuf,
    #[arg(long, value_name = "Q", help = which_quantity())]
    quantity: Option<String>,
    /// Without a recipe: the model [default: ggx]
    #[arg(long, value_name = "M", conflicts_with = "recipe")]
    model: Option<String>,
    /// Without a recipe: samples along each axis
    #[arg(long, value_name = "N", default_value = "128", conflicts_with = "recipe")]
    size: usize,
    /// `auto` (best GPU, else software Vulkan, else CPU), `cpu`, or part of an adapter's name
    #[arg(long, value_name = "NAME", default_value = "auto")]
    device: DeviceChoice,
    /// About how long to measure: 60, 60s or 2m. Counted in evaluations: a slow device takes longer, and results
    /// do not depend on speed
    #[arg(long, value_name = "TIME", default_value = "60s", value_parser = seconds)]
    budget: f64,
    /// Texels to compare with the f64 reference: all, or a seeded subset that is the same for all methods
    #[arg(long, value_name = "TEXELS", default_value = "subset", value_parser = ["subset", "all"])]
    check: String,
    /// Print trade.json on stdout and messages on stderr
    #[arg(long)]
    json: bool,
}

/// The help of `--quantity`.
fn which_quantity() -> String {
    let integrals = quantity::integrals_in_words();
    format!("Without a recipe: {integrals}. With one: its first table of this quantity")
}

const AFTER_HELP: &str = "\
Examples:
  gonio trade --out trade
  gonio trade --quantity rho_dh --model ggx --size 64 --budget 20s --out trade
  gonio trade dfg.toml --device cpu --out trade

Methods: warped (this project's), gauss and grid (over θ and φ), hammersley (what most bakers do),
vndf (visible normals) and random.
`*`: no other point is both faster and more exact. `~`: time extrapolated from the subset.
Tables are stored as computed. `warped` is also measured in f16 and unorm16 if their rounding is below the
tolerance. They use a finer rule to leave room for the rounding.

Exit codes: 0 success, 2 bad input, 3 no device, 130 interrupted";

/// Parses a time span, in seconds.
fn seconds(text: &str) -> Result<f64, String> {
    let (number, unit) = match text.strip_suffix('m') {
        Some(number) => (number, 60.0),
        None => (text.strip_suffix('s').unwrap_or(text), 1.0),
    };
    let value: f64 =
        number.trim().parse().map_err(|_| format!("\"{text}\" is not a time; give 60s or 2m"))?;
    let value = value * unit;
    if value > 0.0 && value <= 86_400.0 { Ok(value) } else { Err("give a time above 0, to a day".into()) }
}

pub fn run(args: &Args) -> Result<()> {
    let table = table(args)?;
    let (evaluator, line) = open(&args.device)?;
    let say = |text: &str| print_beside(args.json, text);
    say(&format!("{HEADING}device{HEADING:#}  {line}"))?;
    let device = device_json(evaluator);
    let options = TradeOptions { budget: args.budget, check_all: args.check == "all" };
    let watch = Watch::new(options.steps());
    let trade = measure(&table, evaluator, &options, &watch);
    watch.finish();
    let trade = trade?;
    let json = write(&args.out, &trade, &device)?;
    for line in lines(&trade) {
        say(&line)?;
    }
    trade.left_out.iter().for_each(|what| warn(&format!("not measured: {what}")));
    say(&format!("trade.csv, trade.json and trade.png in {}", args.out.display()))?;
    if args.json { print_json(&json) } else { Ok(()) }
}

/// Plans the table to measure.
fn table(args: &Args) -> Result<TablePlan> {
    let Some(path) = &args.recipe else {
        let quantity = quantity::find(args.quantity.as_deref().unwrap_or("split_sum"))?;
        let model = model::find(args.model.as_deref().unwrap_or("ggx"))?;
        let axes = model.variables(quantity).map(|v| Axis::natural(v, args.size)).collect::<Result<_>>()?;
        return TablePlan::basis(format!("{}.{}", model.name, quantity.name), quantity, model, None, axes);
    };
    let selection = Selection { quantity: args.quantity.clone(), ..Selection::default() };
    let plan = Plan::new(&scene::read(path)?, &selection)?;
    let integral = |table: &TablePlan| table.quantity().is_integral();
    plan.tables.into_iter().find(integral).ok_or_else(|| {
        Error::input(format!(
            "{}: no table of integrals; give one of {}",
            path.display(),
            quantity::integrals_in_words()
        ))
    })
}

/// Formats the results as lines of text.
fn lines(trade: &Trade) -> Vec<String> {
    let mut lines = vec![
        format!("{HEADING}table{HEADING:#}   {}", trade.table),
        format!("{HEADING}checked{HEADING:#} {}", trade.subset),
        format!(
            "{HEADING}  {:10}  {:>11}  {:7}  {:>11}  {:>10}  {:>19}  {:>10}  {:>9}  {:>9}  {:>6}{HEADING:#}",
            "method",
            "setting",
            "storage",
            "evaluations",
            "time",
            "min – max",
            "prepare",
            "max error",
            "rms",
            "floor"
        ),
    ];
    lines.extend(trade.points.iter().map(line));
    if let Some(floor) = &trade.floor {
        lines.push(format!(
            "{HEADING}floor{HEADING:#}   the device writes {:.1} GB/s and does {:.1} G products and sums a second; \
             floor is the share of the time that these need at least",
            1e-9 * floor.bytes_per_second,
            1e-9 * floor.operations_per_second
        ));
    }
    lines.extend(trade.headlines.iter().map(|headline| format!("{HEADING}→{HEADING:#} {headline}")));
    lines
}

fn line(p: &Point) -> String {
    let ms = |seconds: f64| format!("{:.2}", 1e3 * seconds);
    let mark = if p.on_front {
        '*'
    } else if p.extrapolated {
        '~'
    } else {
        ' '
    };
    // The spread is measured on the computed subset and scaled like its time.
    let scale = p.table_seconds / p.seconds;
    format!(
        "{mark} {:10}  {:>11}  {:7}  {:>11.2e}  {:>7} ms  {:>19}  {:>7} ms  {:>9.1e}  {:>9.1e}  {:>6}",
        p.method,
        p.setting,
        p.storage.name(),
        p.evaluations as f64 * if p.extrapolated { scale } else { 1.0 },
        ms(p.table_seconds),
        format!("{} – {}", ms(p.seconds_min * scale), ms(p.seconds_max * scale)),
        ms(p.prepare),
        p.max_error,
        p.rms_error,
        p.floor_share.map_or("–".into(), |share| format!("{:.0} %", 100.0 * share)),
    )
}
