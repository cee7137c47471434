//! `gonio gallery`: a page with a picture of every model.

use crate::backend::gpu::DeviceChoice;
use crate::bake::{Evaluator, Observer};
use crate::base::error::Result;
use crate::cli::plot::PlotView;
use crate::cli::watch::Watch;
use crate::cli::{HEADING, device_json, models as details, open, print_beside, print_json};
use crate::figure::picture::{MOST_SETTINGS, Radius};
use crate::io::TableSet;
use crate::io::draw::svg::escape;
use crate::model::compensation::Compensation;
use crate::model::{FRESNELS, MASKINGS, MODELS, Model, Term};
use serde_json::{Map, Value, json};
use std::f64::consts::FRAC_PI_4;
use std::path::PathBuf;

#[derive(clap::Args)]
#[command(after_help = AFTER_HELP)]
pub struct Args {
    /// The folder for index.html, gallery.md, the pictures and manifest.json, created if missing
    #[arg(long, short, value_name = "DIR")]
    out: PathBuf,
    /// `auto` (best GPU, else software Vulkan, else CPU), `cpu`, or part of an adapter's name
    #[arg(long, value_name = "NAME", default_value = "auto")]
    device: DeviceChoice,
    /// Print the manifest on stdout and messages on stderr
    #[arg(long)]
    json: bool,
}

const AFTER_HELP: &str = "\
Examples:
  gonio gallery --out gallery

The page shows each model at three settings, as gonio plot draws it, and compares the masking and Fresnel terms.
index.html contains all pictures. If anything fails, DIR keeps its old contents.

Exit codes: 0 success, 1 ρ_dh misses its tolerance, 2 bad input, 3 no device, 130 interrupted";

/// Light comes in at 45°.
const THETAS: [f64; 1] = [FRAC_PI_4];

/// The page in HTML, and the same in Markdown.
const PAGES: [&str; 2] = ["index.html", "gallery.md"];

/// A picture with its title, summary and facts.
struct Entry {
    stem: String,
    title: String,
    summary: String,
    /// A heading, and lines below it.
    facts: Vec<(&'static str, Vec<String>)>,
    view: PlotView,
}

pub fn run(args: &Args) -> Result<()> {
    let entries = entries()?;
    let (evaluator, line) = open(&args.device)?;
    print_beside(args.json, &format!("{HEADING}device{HEADING:#}  {line}"))?;
    let mut set = TableSet::create(&args.out)?;
    // Before the work, not after it.
    entries
        .iter()
        .flat_map(Entry::files)
        .chain(PAGES.map(String::from))
        .try_for_each(|name| set.refuse_foreign(&name))?;
    let watch = Watch::new(entries.iter().map(|entry| entry.view.steps()).sum::<usize>());
    let manifest = write(&mut set, &entries, evaluator, &watch);
    watch.finish();
    let manifest = manifest?;
    set.commit(&manifest)?;
    for entry in &entries {
        print_beside(args.json, &format!("  {:18}{}", entry.stem, entry.summary))?;
    }
    print_beside(
        args.json,
        &format!("{} pictures; open {}", entries.len(), args.out.join("index.html").display()),
    )?;
    if args.json { print_json(&manifest) } else { Ok(()) }
}

/// Lists an entry for every model, for the masking and Fresnel terms, the thin film and the compensations.
fn entries() -> Result<Vec<Entry>> {
    let mut entries = Vec::new();
    for model in MODELS {
        let view = PlotView::of_model(model.name, &[])?;
        entries.push(Entry {
            stem: view.stem(),
            title: model.name.into(),
            summary: model.summary.into(),
            facts: vec![
                ("Source", vec![model.source.into()]),
                ("Parameters", parameters(model)),
                ("Promises", details::promises(model)),
            ],
            view,
        });
    }
    let Some(model) = MODELS.into_iter().find(|model| model.microfacet.is_some()) else { return Ok(entries) };
    for (kind, terms) in [("masking", &MASKINGS[..]), ("fresnel", &FRESNELS[..])] {
        for (page, terms) in terms.chunks(MOST_SETTINGS).enumerate() {
            let names: Vec<_> = terms.iter().map(|term| term.name).collect();
            let sets = ["roughness=0.5".to_owned(), format!("{kind}={}", names.join(","))];
            let number = if page == 0 { String::new() } else { format!("-{}", page + 1) };
            let said = |term: &Term| format!("{}: {} ({})", term.name, term.summary, term.source);
            entries.push(Entry {
                stem: format!("{}_{kind}{number}", model.name),
                title: format!("{} by {kind}", model.name),
                summary: format!("What {kind} = {} does to {}", names.join(" | "), model.name),
                facts: vec![("Terms", terms.iter().map(said).collect())],
                view: PlotView::of_model(model.name, &sets)?,
            });
        }
    }
    let film = model.with_terms(None, Some("thin-film"))?;
    let sets = ["roughness=0.3", "f0=0.5", "thickness=150,300,450,600,900"];
    entries.push(Entry {
        stem: format!("{}_thin-film", model.name),
        title: format!("{} under a thin film", model.name),
        summary: "What the thickness of a film does to the colours of a bright base".into(),
        facts: vec![
            ("Source", vec![film.source.into()]),
            ("Parameters", parameters(film)),
            ("Promises", details::promises(film)),
        ],
        view: PlotView::of_model(film.name, &sets.map(String::from))?,
    });
    entries.push(compensation(model)?);
    Ok(entries)
}

fn parameters(model: &Model) -> Vec<String> {
    let line = |p: details::ParameterEntry| {
        let default = p.default.map_or(String::new(), |default| format!(", default {default}"));
        format!("{}: {} ({}{default})", p.name, p.what, p.range)
    };
    details::parameters(model).into_iter().map(line).collect()
}

/// Compares the methods that restore the light lost between microfacets.
fn compensation(model: &Model) -> Result<Entry> {
    let names = Compensation::ALL.map(Compensation::name);
    let sets = ["roughness=0.8".into(), "fresnel=none".into(), format!("compensation={}", names.join(","))];
    let said = |c: Compensation| match c.source() {
        "" => format!("{}: {}", c.name(), c.summary()),
        source => format!("{}: {} ({source})", c.name(), c.summary()),
    };
    Ok(Entry {
        stem: format!("{}_compensation", model.name),
        title: format!("{} by compensation", model.name),
        summary: format!("What compensation = {} does to {}", names.join(" | "), model.name),
        facts: vec![("Compensation", Compensation::ALL.map(said).to_vec())],
        view: PlotView::of_model(model.name, &sets)?,
    })
}

/// Writes all files; the manifest lists them.
fn write(
    set: &mut TableSet,
    entries: &[Entry],
    evaluator: &Evaluator,
    observer: &dyn Observer,
) -> Result<Value> {
    let (mut files, mut pictures) = (Map::new(), Vec::new());
    let mut add = |name: String, bytes: &[u8]| -> Result<()> {
        let (name, sha256) = set.add(&name, bytes)?;
        files.insert(name, sha256.into());
        Ok(())
    };
    let (mut html, mut markdown) = (head(entries), String::from("# Gallery\n"));
    for entry in entries {
        let shown = entry.view.show(&THETAS, Radius::Auto, evaluator, observer)?;
        let svg = shown.picture.to_svg()?;
        let [png_name, svg_name] = entry.files();
        add(png_name, &shown.picture.to_png()?)?;
        add(svg_name, svg.as_bytes())?;
        html += &section(entry, &svg);
        markdown += &chapter(entry);
        pictures.push(json!({ "name": entry.stem, "command": entry.command(), "shows": shown.to_json() }));
    }
    let [page, text] = PAGES.map(String::from);
    add(page, (html + "</main>\n</html>\n").as_bytes())?;
    add(text, markdown.as_bytes())?;
    Ok(json!({
        "schema": 1, "kind": "gallery", "gonio": { "version": env!("CARGO_PKG_VERSION") },
        "device": device_json(evaluator), "pictures": pictures, "files": files,
    }))
}

impl Entry {
    /// Names its picture as PNG and as SVG.
    fn files(&self) -> [String; 2] {
        ["png", "svg"].map(|extension| format!("{}.{extension}", self.stem))
    }

    fn command(&self) -> String {
        format!("{} --out {}.png", self.view.command, self.stem)
    }
}

/// The page up to its first entry. Pictures are wider than a phone: they scroll sideways, the text does not.
fn head(entries: &[Entry]) -> String {
    let links: Vec<_> = entries
        .iter()
        .map(|e| format!("<a href=\"#{0}\">{1}</a>", escape(&e.stem), escape(&e.title)))
        .collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>gonio: gallery</title>\n\
         <style>\n\
         body {{ margin: 0; font: 1rem/1.5 system-ui, sans-serif; color: #101010; background: #fff }}\n\
         main {{ max-width: 76rem; margin: 0 auto; padding: 1rem }}\n\
         h2 {{ margin: 3rem 0 0; border-top: 1px solid #ccc; padding-top: 1rem }}\n\
         h3 {{ margin: 1rem 0 0; font-size: 1rem }}\n\
         ul {{ margin: 0; padding-left: 1.2rem }}\n\
         pre, .picture {{ overflow-x: auto }}\n\
         pre {{ background: #f2f2f2; padding: .6rem }}\n\
         svg {{ display: block; width: 100%; min-width: 52rem; height: auto }}\n\
         </style>\n<main>\n<h1>gonio: the models</h1>\n<p>{}</p>\n",
        links.join(" · ")
    )
}

fn section(entry: &Entry, svg: &str) -> String {
    let mut html = format!(
        "<section id=\"{}\">\n<h2>{}</h2>\n<p>{}</p>\n<div class=\"picture\">\n{svg}</div>\n<pre>{}</pre>\n",
        escape(&entry.stem),
        escape(&entry.title),
        escape(&entry.summary),
        escape(&entry.command())
    );
    for (heading, lines) in &entry.facts {
        let items: String = lines.iter().map(|line| format!("<li>{}</li>\n", escape(line))).collect();
        html += &format!("<h3>{heading}</h3>\n<ul>\n{items}</ul>\n");
    }
    html + "</section>\n"
}

fn chapter(entry: &Entry) -> String {
    let Entry { stem, title, summary, facts, .. } = entry;
    let mut text =
        format!("\n## {title}\n\n{summary}\n\n![{title}]({stem}.png)\n\n```sh\n{}\n```\n", entry.command());
    for (heading, lines) in facts {
        let items: String = lines.iter().map(|line| format!("- {}\n", line.replace('|', "\\|"))).collect();
        text += &format!("\n**{heading}**\n\n{items}");
    }
    text
}
