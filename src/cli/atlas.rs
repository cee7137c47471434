//! `gonio atlas`

use crate::backend::gpu::DeviceChoice;
use crate::bake::Observer;
use crate::base::error::{Error, Result};
use crate::cli::watch::Watch;
use crate::cli::{HEADING, device_json, open, print_beside, print_json};
use crate::lab::atlas;
use crate::lab::atlas::{Band, DEFAULT_BUDGET, Page, PageKind};
use crate::model;
use crate::model::{MODELS, Model};
use std::path::PathBuf;

#[derive(clap::Args)]
#[command(after_help = AFTER_HELP)]
pub struct Args {
    /// Models to measure [default: all that have values]
    #[arg(long, value_name = "NAME", num_args = 1.., conflicts_with = "study")]
    model: Vec<String>,
    /// Measure the published forms of the GGX term instead of models
    #[arg(long)]
    study: bool,
    /// The folder for atlas.csv, atlas.json and atlas_MODEL.png, or study.csv, .json and .png, created if
    /// missing. Without it no file is written
    #[arg(long, short, value_name = "DIR")]
    out: Option<PathBuf>,
    /// `auto` (best GPU, else software Vulkan, else CPU), `cpu`, or part of an adapter's name
    #[arg(long, value_name = "NAME", default_value = "auto")]
    device: DeviceChoice,
    /// Number of values to compare for each model or form. Results do not depend on the speed of the machine
    #[arg(long, value_name = "N", default_value_t = DEFAULT_BUDGET,
          value_parser = clap::value_parser!(u64).range(1..=10_000_000_000))]
    budget: u64,
    /// Print the JSON file on stdout and messages on stderr
    #[arg(long)]
    json: bool,
}

const AFTER_HELP: &str = "\
Examples:
  gonio atlas --out atlas
  gonio atlas --model ggx --budget 100000000
  gonio atlas --study --out atlas

Inputs: all combinations of the extremes of θi, θe and δφ, and low-discrepancy pairs, denser near the horizon,
the mirror direction and the normal; α from 1e-6 to 1. The worst input of each subject is printed as options of
gonio eval, with all digits.

Exit codes: 0 all errors are as promised, 1 an error is larger, 2 bad input, 3 no device, 130 interrupted";

pub fn run(args: &Args) -> Result<()> {
    let models = models(args)?;
    let (evaluator, line) = open(&args.device)?;
    let say = |text: &str| print_beside(args.json, text);
    say(&format!("{HEADING}device{HEADING:#}  {line}"))?;
    let device = device_json(evaluator);
    let watch = Watch::new(if args.study { atlas::STEPS } else { models.len() });
    let pages: Result<Vec<_>> = if args.study {
        atlas::study(evaluator, args.budget, &watch)
    } else {
        let measure = |model: &&'static Model| {
            watch.begin(model.name);
            atlas::measure_model(evaluator, model, args.budget, &watch)
        };
        models.iter().map(measure).collect()
    };
    watch.finish();
    let pages = pages?;
    for line in pages.iter().flat_map(lines) {
        say(&line)?;
    }
    let kind = if args.study { PageKind::Study } else { PageKind::Atlas };
    if let Some(dir) = &args.out {
        atlas::write(dir, kind, &pages, &device)?;
        say(&format!("{0}.csv, {0}.json and pictures in {1}", kind.name(), dir.display()))?;
    }
    if args.json {
        print_json(&atlas::to_json(kind, &pages, &device))?;
    }
    let broken: Vec<_> =
        pages.iter().filter(|page| !page.is_kept()).map(|page| page.subject.as_str()).collect();
    match broken[..] {
        [] => Ok(()),
        _ => Err(Error::Promise(format!("{}: an error is larger than promised", broken.join(", ")))),
    }
}

/// Returns the models of `--model`, or all models that have values.
fn models(args: &Args) -> Result<Vec<&'static Model>> {
    if args.model.is_empty() {
        return Ok(MODELS
            .into_iter()
            .filter(|model| !model.is_delta() && crate::check::reference_of_model(model).is_some())
            .collect());
    }
    args.model.iter().map(|name| model::find(name).map_err(|error| error.at("--model"))).collect()
}

/// Formats a page as a table of decades of α.
fn lines(page: &Page) -> Vec<String> {
    let mut lines = vec![
        format!("{HEADING}{}{HEADING:#}  {}", page.subject, page.source),
        format!(
            "{HEADING}  {:13}  {:>8}  {:>8}  {:>8}  {:>8}  {:>9}  {:>11}  {:>8}  {:>7}{HEADING:#}",
            "α", "values", "median", "max", "promise", "max ULP", "reciprocity", "unequal", "not fin"
        ),
    ];
    lines.extend(page.decades.iter().map(line));
    if let Some(worst) = page.worst().and_then(|band| band.worst.as_ref()) {
        lines.push(format!("  worst: gonio eval {}", worst.eval));
    }
    lines
}

fn line(b: &Band) -> String {
    let alpha = b.alpha.map_or("–".into(), |[low, high]| format!("{low:e} – {high:e}"));
    format!(
        "  {alpha:13}  {:>8}  {:>8.1e}  {:>8.1e}  {:>8}  {:>9}  {:>11.1e}  {:>8}  {:>7}",
        b.values,
        b.median,
        b.max,
        b.promise.map_or("–".into(), |promise| format!("{promise:.0e}")),
        if b.max_ulp < 1e4 { format!("{:.1}", b.max_ulp) } else { format!("{:.1e}", b.max_ulp) },
        b.reciprocity,
        b.unequal,
        b.non_finite
    )
}
