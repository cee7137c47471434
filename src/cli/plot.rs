//! `gonio plot`

use crate::backend::gpu::DeviceChoice;
use crate::bake::{Evaluator, Observer};
use crate::base::error::{Error, Result};
use crate::cli::check::quoted;
use crate::cli::subject;
use crate::cli::subject::key_value;
use crate::cli::watch::Watch;
use crate::cli::{HEADING, device_json, models as details, open, print_beside, print_json};
use crate::figure::picture::{MOST_SETTINGS, MOST_THETAS, Picture, Plate, Radius, draw};
use crate::figure::{Figure, FigureSubject};
use crate::io::Outputs;
use crate::model;
use crate::scene;
use serde_json::{Value, json};
use std::f64::consts::FRAC_PI_2;
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
#[command(after_help = AFTER_HELP)]
pub struct Args {
    /// A model, or a scene or recipe with --material
    #[arg(value_name = "MODEL|SCENE")]
    subject: String,
    /// A material of the scene
    #[arg(long, value_name = "NAME")]
    material: Option<String>,
    /// Set a parameter of the model, or a varying parameter of the material; may be repeated. One parameter may
    /// have up to five values, each drawn as a curve [default: three settings of the model]
    #[arg(long, value_name = "KEY=VALUE[,VALUE…]")]
    set: Vec<String>,
    /// Zenith angles of incidence, up to three: degrees, or radians as 0.5rad
    #[arg(long, value_name = "ANGLE[,ANGLE…]", default_value = "45", value_delimiter = ',', value_parser = theta)]
    theta: Vec<f64>,
    /// Scale of the radius of the polar plot; auto chooses by the height of the peaks
    #[arg(long, value_name = "auto|linear|log", default_value = "auto", value_parser = radius)]
    radius: Radius,
    /// The picture, .png or .svg; may be repeated [default: NAME.png]
    #[arg(long, short, value_name = "FILE")]
    out: Vec<PathBuf>,
    /// `auto` (best GPU, else software Vulkan, else CPU), `cpu`, or part of an adapter's name
    #[arg(long, value_name = "NAME", default_value = "auto")]
    device: DeviceChoice,
    /// Print what the picture shows as JSON on stdout and messages on stderr
    #[arg(long)]
    json: bool,
}

const AFTER_HELP: &str = "\
Examples:
  gonio plot ggx
  gonio plot ggx --set roughness=0.3 --set f0=0.04 --theta 30,60 --out ggx.png --out ggx.svg
  gonio plot ggx --set roughness=0.1,0.3,0.6 --out ggx.svg
  gonio plot ggx --set roughness=0.5 --set masking=smith-correlated,smith-separable,none
  gonio plot recipe.toml --material gold

The picture shows f cos θe in the plane of incidence; ρ_dh over θ with the white furnace; f over the
hemisphere, seen along the normal; a sphere under a point light, and one under uniform light: ρ_dh(θe).

Exit codes: 0 success, 1 ρ_dh misses its tolerance, 2 bad input, 3 no device, 130 interrupted";

fn theta(text: &str) -> Result<f64, String> {
    let (number, scale) = match text.strip_suffix("rad") {
        Some(radians) => (radians, 1.0),
        None => (text.strip_suffix("deg").unwrap_or(text), 1f64.to_radians()),
    };
    let value: f64 =
        number.trim().parse().map_err(|_| format!("\"{text}\" is not an angle; give 45 or 0.5rad"))?;
    // 90° is 90°.
    let theta =
        if value * scale > FRAC_PI_2 && value <= 90.0 && scale < 1.0 { FRAC_PI_2 } else { value * scale };
    if (0.0..=FRAC_PI_2).contains(&theta) {
        return Ok(theta);
    }
    Err(format!("{text} is outside [0°, 90°]; give degrees, or radians as 0.5rad"))
}

fn radius(text: &str) -> Result<Radius, String> {
    match text {
        "auto" => Ok(Radius::Auto),
        "linear" => Ok(Radius::Linear),
        "log" => Ok(Radius::Log),
        _ => Err(format!("\"{text}\" is no radius; give auto, linear or log")),
    }
}

pub fn run(args: &Args) -> Result<()> {
    if args.theta.len() > MOST_THETAS {
        return Err(Error::input(format!(
            "--theta: {} angles; a picture shows up to {MOST_THETAS}",
            args.theta.len()
        )));
    }
    let view = match &args.material {
        None => PlotView::of_model(&args.subject, &args.set)?,
        Some(name) => PlotView::of_material(Path::new(&args.subject), name, &args.set)?,
    };
    let out = if args.out.is_empty() {
        vec![PathBuf::from(format!("{}.png", view.stem()))]
    } else {
        args.out.clone()
    };
    let formats = out.iter().map(|path| PictureFormat::of(path)).collect::<Result<Vec<_>>>()?;

    let (evaluator, line) = open(&args.device)?;
    let say = |text: &str| print_beside(args.json, text);
    say(&format!("{HEADING}device{HEADING:#}  {line}"))?;
    let watch = Watch::new(view.subjects.len() + 1);
    let shown = view.show(&args.theta, args.radius, evaluator, &watch);
    watch.finish();
    let shown = shown?;
    let mut outputs = Outputs::default();
    for (path, format) in out.iter().zip(formats) {
        outputs.add(path, format.encode(&shown.picture)?)?;
    }
    outputs.commit()?;
    for line in shown.lines() {
        say(&line)?;
    }
    out.iter().try_for_each(|path| say(&format!("{}", path.display())))?;
    if !args.json {
        return Ok(());
    }
    let mut json = shown.to_json();
    json["device"] = device_json(evaluator);
    json["files"] = json!(out);
    print_json(&json)
}

/// The format of a picture, chosen by the file's extension.
#[derive(Clone, Copy)]
enum PictureFormat {
    Png,
    Svg,
}

impl PictureFormat {
    fn of(path: &Path) -> Result<Self> {
        match path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase().as_str() {
            "png" => Ok(Self::Png),
            "svg" => Ok(Self::Svg),
            _ => Err(Error::input(format!("{}: its name must end in .png or .svg", path.display()))),
        }
    }

    fn encode(self, picture: &Picture) -> Result<Vec<u8>> {
        match self {
            Self::Png => picture.to_png(),
            Self::Svg => Ok(picture.to_svg()?.into_bytes()),
        }
    }
}

/// One BRDF at several settings: the subject of a plot.
pub struct PlotView {
    title: String,
    subtitle: String,
    /// The name of the model or material.
    name: String,
    subjects: Vec<FigureSubject>,
    /// The command that makes the picture, but for `--theta` and `--out`.
    pub command: String,
}

/// A parameter and its values, as the command line gives them.
type Given<'a> = (&'a str, Vec<&'a str>);

impl PlotView {
    /// Plots a model with `--set`, or without it at three default settings.
    pub fn of_model(name: &str, sets: &[String]) -> Result<Self> {
        let model = model::find(name).map_err(|error| match error {
            Error::Input(why) if name.contains(['.', '/']) => {
                Error::input(format!("{why}; of a scene, give --material NAME too"))
            }
            other => other,
        })?;
        let default_sets = details::settings(model);
        let sets = if sets.is_empty() { &default_sets[..] } else { sets };
        let given = given(sets)?;
        let subject = |label: String, setting: &[(&str, &str)]| {
            let scene = subject::model(name, setting.iter().copied())?;
            Ok(FigureSubject { label, material: scene.materials[0].name.clone(), scene })
        };
        let subjects = subjects(&given, name, subject)?;
        // The parameters that are not varied, with their defaults if they are not given.
        let fixed = details::parameters(model).into_iter().filter_map(|parameter| {
            match given.iter().find(|(key, _)| *key == parameter.name) {
                Some((key, values)) => (values.len() == 1).then(|| format!("{key} = {}", values[0])),
                None => Some(format!("{} = {}", parameter.name, parameter.default?)),
            }
        });
        let is_default = !given.iter().any(|(key, _)| ["masking", "fresnel"].contains(key));
        let (summary, source) = match model.microfacet {
            // The model's summary describes its default terms.
            Some(microfacet) if !is_default => (microfacet.ndf.summary, microfacet.ndf.source),
            _ => (model.summary, model.source),
        };
        let command = sets.iter().map(|set| format!(" --set {}", quoted(set))).collect::<String>();
        Ok(Self {
            title: format!("{}: {summary}", model.name),
            subtitle: fixed.chain([source.to_owned()]).collect::<Vec<_>>().join("   ·   "),
            name: model.name.into(),
            subjects,
            command: format!("gonio plot {}{command}", model.name),
        })
    }

    /// Plots a material of a scene or recipe.
    fn of_material(path: &Path, name: &str, sets: &[String]) -> Result<Self> {
        let scene = scene::read(path)?;
        let given = given(sets)?;
        let subject = |label: String, setting: &[(&str, &str)]| {
            let scene = subject::material(scene.clone(), name, setting.iter().copied())?;
            Ok(FigureSubject { label, material: name.to_owned(), scene })
        };
        let subjects = subjects(&given, name, subject)?;
        let lobes = scene.materials.iter().find(|m| m.name == name).into_iter().flat_map(|m| &m.lobes);
        let fixed = given.iter().filter(|(_, values)| values.len() == 1);
        let fixed = fixed.map(|(key, values)| format!("{key} = {}", values[0]));
        let lobes = lobes.map(|lobe| lobe.model.clone()).collect::<Vec<_>>().join(" + ");
        let file = path.file_name().unwrap_or_default().to_string_lossy();
        Ok(Self {
            title: format!("{name} of {file}"),
            subtitle: std::iter::once(lobes).chain(fixed).collect::<Vec<_>>().join("   ·   "),
            name: name.to_owned(),
            subjects,
            command: String::new(),
        })
    }

    /// Returns the name as the stem of a file name.
    pub fn stem(&self) -> String {
        let plain = |c: char| if c.is_ascii_alphanumeric() || "-_".contains(c) { c } else { '_' };
        self.name.chars().map(plain).collect()
    }

    /// Returns the number of steps for a progress bar.
    pub fn steps(&self) -> usize {
        self.subjects.len() + 1
    }

    /// Evaluates and draws the subjects.
    pub fn show<'a>(
        &'a self,
        thetas: &'a [f64],
        radius: Radius,
        evaluator: &Evaluator,
        observer: &dyn Observer,
    ) -> Result<RenderedView<'a>> {
        let figures =
            self.subjects.iter().map(|subject| Figure::evaluate(subject, thetas, evaluator, observer));
        let figures = figures.collect::<Result<Vec<_>>>()?;
        observer.begin("drawing");
        observer.advance(0.0)?;
        let footer = footer(&figures, evaluator);
        let (title, subtitle) = (&self.title, &self.subtitle);
        let plate = Plate { title, subtitle, footer: &footer, thetas, figures: &figures, radius };
        let picture = draw(&plate)?;
        Ok(RenderedView { view: self, thetas, figures, picture })
    }
}

/// Splits the value of each `--set` at the commas outside brackets: `f0=[1,0.8,0.3],0.04`.
fn given(sets: &[String]) -> Result<Vec<Given<'_>>> {
    let split = |set| {
        let (key, values) = key_value(set)?;
        let mut depth = 0;
        let parts = values.split(|c| {
            depth += i32::from(c == '[') - i32::from(c == ']');
            c == ',' && depth == 0
        });
        let parts: Vec<_> = parts.map(str::trim).collect();
        if parts.iter().any(|part| part.is_empty()) {
            return Err(Error::input(format!("--set {set}: a value is missing beside a comma")));
        }
        Ok((key, parts))
    };
    sets.iter().map(|set| split(set.as_str())).collect()
}

/// Builds one subject for each value of the parameter that has several.
fn subjects(
    given: &[Given],
    name: &str,
    subject: impl Fn(String, &[(&str, &str)]) -> Result<FigureSubject>,
) -> Result<Vec<FigureSubject>> {
    let lists: Vec<_> = given.iter().filter(|(_, values)| values.len() > 1).collect();
    let setting = |choose: &dyn Fn(&Given<'_>) -> usize| -> Vec<_> {
        given.iter().map(|one| (one.0.to_owned(), one.1[choose(one)].to_owned())).collect()
    };
    let with_setting = |label: String, setting: Vec<(String, String)>| {
        let setting: Vec<_> = setting.iter().map(|(key, value)| (key.as_str(), value.as_str())).collect();
        subject(label, &setting)
    };
    match lists[..] {
        [] => Ok(vec![with_setting(name.to_owned(), setting(&|_| 0))?]),
        [(key, values)] if values.len() <= MOST_SETTINGS => {
            let one = |k: usize| {
                let chosen = |one: &Given<'_>| if one.0 == *key { k } else { 0 };
                with_setting(format!("{key} = {}", values[k]), setting(&chosen))
            };
            (0..values.len()).map(one).collect()
        }
        [(key, values)] => Err(Error::input(format!(
            "--set {key}: {} values; a picture shows up to {MOST_SETTINGS}",
            values.len()
        ))),
        _ => {
            let keys: Vec<_> = lists.iter().map(|(key, _)| *key).collect();
            Err(Error::input(format!(
                "--set: {} have several values each; give several to one of them alone",
                keys.join(" and ")
            )))
        }
    }
}

/// Formats the device, the arithmetic and the measured error of ρ_dh.
fn footer(figures: &[Figure], evaluator: &Evaluator) -> String {
    let (device, arithmetic) = match evaluator {
        Evaluator::Device(device) => (device.name().to_owned(), "f32"),
        Evaluator::Cpu => ("the CPU".to_owned(), "f64"),
    };
    let mut words =
        vec![format!("gonio {} on {device}", env!("CARGO_PKG_VERSION")), format!("values in {arithmetic}")];
    let rhos: Vec<_> = figures.iter().filter_map(|figure| figure.rho.as_ref().ok()).collect();
    if let Some(rho) = rhos.first() {
        let measured = rhos.iter().filter_map(|rho| rho.measured).fold(0.0, f64::max);
        let Some(tolerance) = rhos.iter().map(|rho| rho.tolerance).reduce(f64::max) else {
            return words.join("   ·   ");
        };
        words.push(format!(
            "ρ_dh to {tolerance:.0e} in {}, within {measured:.0e} of the f64 reference",
            rho.precision
        ));
    }
    words.join("   ·   ")
}

/// A drawn plot and the figures in it.
pub struct RenderedView<'a> {
    view: &'a PlotView,
    thetas: &'a [f64],
    figures: Vec<Figure>,
    pub picture: Picture,
}

impl RenderedView<'_> {
    fn lines(&self) -> Vec<String> {
        let mut lines = vec![format!("{HEADING}{}{HEADING:#}", self.view.title)];
        for figure in &self.figures {
            for (k, theta) in self.thetas.iter().enumerate() {
                let peak = peak(figure, k).map_or("a delta, no values".into(), |(theta_e, f)| {
                    format!("f cos θe up to {f:.4e} sr⁻¹, at θe = {:.2}°", theta_e.to_degrees())
                });
                let rho = match &figure.rho {
                    Ok(rho) => format!("ρ_dh = {}", by_channel(rho.at(*theta))),
                    Err(_) => "ρ_dh has no bound".into(),
                };
                lines.push(format!("  {:24}  θi = {:.4}°  {peak}; {rho}", figure.label, theta.to_degrees()));
            }
        }
        lines
    }

    pub fn to_json(&self) -> Value {
        let setting = |figure: &Figure| {
            let directions = self.thetas.iter().enumerate().map(|(k, &theta_i)| {
                let peak = peak(figure, k).map(|(theta_e, f)| json!({ "theta_e": theta_e, "f_cos_theta_e": f }));
                json!({ "theta_i": theta_i, "rho_dh": figure.rho.as_ref().ok().map(|rho| rho.at(theta_i)), "peak": peak })
            });
            json!({
                "label": figure.label, "has_values": figure.values.is_some(), "has_delta": figure.has_delta,
                "rho_dh_unbounded": figure.rho.as_ref().err(), "directions": directions.collect::<Vec<_>>(),
            })
        };
        json!({
            "subject": self.view.name, "title": self.view.title,
            "settings": self.figures.iter().map(setting).collect::<Vec<_>>(),
        })
    }
}

/// Finds the largest f cos θe of any channel in the plane of incidence, and its θe, which is below 0 on the side of ωi.
fn peak(figure: &Figure, k: usize) -> Option<(f64, f64)> {
    let plane = &figure.values.as_ref()?.lobes[k].plane;
    let largest = plane.iter().map(|&(theta, f)| (theta, f.into_iter().fold(0.0, f64::max)));
    largest.filter(|(_, f)| f.is_finite()).max_by(|a, b| a.1.total_cmp(&b.1))
}

fn by_channel(rho: [f64; 3]) -> String {
    match rho {
        [r, g, b] if r == g && g == b => format!("{r:.5}"),
        [r, g, b] => format!("({r:.5}, {g:.5}, {b:.5})"),
    }
}
