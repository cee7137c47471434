//! `gonio light`

mod picture;
mod sky;

use crate::backend::gpu::DeviceChoice;
use crate::bake::{Evaluator, Observer};
use crate::base::error::{Error, Result};
use crate::base::timings::Timings;
use crate::check::Check;
use crate::cli::subject;
use crate::cli::subject::key_value;
use crate::cli::watch::Watch;
use crate::cli::{HEADING, open, print_beside, print_json, warn};
use crate::io::{Format, TableSet, format, sha256};
use crate::light;
use crate::light::bake::Order;
use crate::light::{Clamped, InvalidTexels, Light, LightSource, MapFile, SetDetails};
use crate::scene;
use crate::scene::{Material, Scene};
use crate::table::Table;
use crate::table::axis::{Axis, Mapping, Positions, Variable};
use crate::table::quantity::SPLIT_SUM_ERROR;
use serde_json::{Value, json};
use std::f64::consts::{PI, TAU};
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
#[command(after_help = AFTER_HELP)]
pub struct Args {
    /// The surface to light: needed for radiance and radiosity only
    #[arg(value_name = "SCENE|RECIPE|MODEL")]
    subject: Option<String>,
    /// An environment map in latitude and longitude: OpenEXR or Radiance HDR
    #[arg(long, value_name = "FILE", conflicts_with = "sky", required_unless_present = "sky")]
    env: Option<PathBuf>,
    /// A light given by its parameters instead of a map: see below
    #[arg(long, value_name = "LIGHT", value_parser = sky::parse)]
    sky: Option<Light>,
    /// Rotate the map about the zenith, from +x towards +y: degrees, or radians as 0.5rad
    #[arg(long, value_name = "ANGLE", default_value = "0", value_parser = sky::angle, allow_negative_numbers = true)]
    rotate: f64,
    /// Replace negative and NaN texels by 0, and infinite ones by the largest finite value
    #[arg(long)]
    clamp: bool,
    /// The quantity to compute
    #[arg(long, value_name = "irradiance|radiance|radiosity|sh", default_value = "irradiance")]
    quantity: Wanted,
    /// The folder for the tables, manifest.json and light.png, created if missing
    #[arg(long, short, value_name = "DIR")]
    out: PathBuf,
    /// Normals over the sphere, θn × φn [default: 32x64; for radiance: the one --normal]
    #[arg(long, value_name = "N×M", value_parser = grid, conflicts_with = "normal")]
    normals: Option<[usize; 2]>,
    /// One normal, θn and φn: degrees, or radians as 0.5rad [default: 0,0 for radiance]
    #[arg(long, value_name = "θ,φ", value_parser = sky::pair, allow_negative_numbers = true)]
    normal: Option<[f64; 2]>,
    /// Exitant directions of radiance: θe at nodes from 0 to 90°, φe at cell centres of the full circle
    #[arg(long, value_name = "N×M", default_value = "16x1", value_parser = grid)]
    exits: [usize; 2],
    /// Roughnesses for radiance, instead of the material's
    #[arg(long, value_name = "R[,R…]", value_delimiter = ',')]
    roughness: Vec<f64>,
    /// The material of the scene, if it has several
    #[arg(long, value_name = "NAME")]
    material: Option<String>,
    /// Set a parameter of the model, or a varying parameter of the material; may be repeated
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// The largest error of a table, relative to the value or to 1/1000 of the table's largest value
    #[arg(long, value_name = "T", default_value = "1e-4", value_parser = tolerance)]
    tolerance: f64,
    /// `auto` (best GPU, else software Vulkan, else CPU), `cpu`, or part of an adapter's name
    #[arg(long, value_name = "NAME", default_value = "auto")]
    device: DeviceChoice,
    /// Files to write for each table, separated by commas
    #[arg(long, value_name = "F", value_delimiter = ',', default_value = "exr,png", value_parser = format::find)]
    format: Vec<&'static Format>,
    /// Texels of each table to compare with the f64 reference: a count, or all [default: 256; for radiance and radiosity: 8]
    #[arg(long, value_name = "N")]
    check: Option<Check>,
    /// Do not draw the light and lit spheres
    #[arg(long)]
    no_picture: bool,
    /// Print the manifest on stdout and messages on stderr
    #[arg(long)]
    json: bool,
}

const AFTER_HELP: &str = "\
Examples:
  gonio light --env museum.exr --out light
  gonio light --env museum.exr --quantity sh --out light
  gonio light recipe.toml --material gold --env museum.exr --quantity radiance --out light
  gonio light ggx --set f0=0.04 --roughness 0.1,0.3,0.5,0.7,0.9 --env museum.exr --quantity radiance --out light
  gonio light lambert --set albedo=0.8 --sky constant:1 --quantity radiosity --out light

A light is KIND:PARAMETERS. A radiance L or irradiance E is a number, or R/G/B; A is an angle.
  constant:L                        the same radiance from all directions
  sky:zenith=L,horizon=L,ground=L   a gradient in cos θ above the horizon
  disk:theta=A,phi=A,radius=A,radiance=L
  sun:theta=A,phi=A,irradiance=E    light from one direction

The world has z up. A map has the zenith at its top, +x in its middle and +y to the left of the middle: it is
not mirrored when seen from inside. A surface's tangent points towards larger θn.

Exit codes: 0 success, 1 a table misses its tolerance, 2 bad input, 3 no device, 130 interrupted.
If anything fails, DIR keeps its old contents.";

/// The quantity of `--quantity`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Wanted {
    Irradiance,
    Radiance,
    Radiosity,
    Sh,
}

fn tolerance(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| format!("\"{text}\" is not a number"))?;
    if value > 0.0 && value <= 1.0 { Ok(value) } else { Err("give a number above 0, to 1".into()) }
}

/// Parses a grid: "32x64" or "32×64".
fn grid(text: &str) -> Result<[usize; 2], String> {
    let why = || format!("\"{text}\" is no grid; give two counts, as in 32x64");
    let (rows, columns) = text.split_once(['x', '×']).ok_or_else(why)?;
    let count = |text: &str| text.trim().parse().ok().filter(|n| (1..=1 << 16).contains(n));
    Ok([count(rows).ok_or_else(why)?, count(columns).ok_or_else(why)?])
}

/// What is lit.
struct LitMaterial {
    scene: Scene,
    material: Material,
}

pub fn run(args: &Args) -> Result<()> {
    if let Some(r) = args.roughness.iter().find(|r| !(0.0..=1.0).contains(*r)) {
        return Err(Error::input(format!("--roughness {r} is outside [0, 1]")));
    }
    if args.roughness.windows(2).any(|pair| pair[0] >= pair[1]) {
        return Err(Error::input("--roughness: give values that increase, as in 0.1,0.3,0.5"));
    }
    let (light, source) = light_of(args)?;
    let lit = lit(args)?;
    let needs = matches!(args.quantity, Wanted::Radiance | Wanted::Radiosity);
    if needs && lit.is_none() {
        return Err(Error::input("nothing is lit; give a scene, a recipe or a model before the options"));
    }
    let (evaluator, line) = open(&args.device)?;
    let say = |text: &str| print_beside(args.json, text);
    say(&format!("{HEADING}device{HEADING:#}  {line}"))?;
    say(&format!("{HEADING}light{HEADING:#}   {}: {}", source.name, light.summary()))?;
    let mut set = TableSet::create(&args.out)?;
    let watch = Watch::new(5);
    let computed = compute(args, &light, &source, lit.as_ref(), evaluator, &watch, &mut set);
    watch.finish();
    let (tables, manifest) = computed?;
    set.commit(&manifest)?;
    for table in &tables {
        let number = |x: Option<f64>| x.map_or("–".into(), |x| format!("{x:.1e}"));
        let shape: Vec<_> = table.shape().iter().map(usize::to_string).collect();
        say(&format!(
            "  {:20} {:>14}  estimate {:>7}  measured {:>7} of {:>4}  {:>6.0} ms  {}",
            table.name,
            shape.join("×"),
            number(table.error.estimate),
            number(table.error.measured_max),
            table.error.texels_checked,
            1e3 * table.seconds,
            table.rule
        ))?;
    }
    if let Some(off) = manifest["truncation"].as_f64() {
        say(&format!(
            "  three bands miss the irradiance by {off:.4} of ∫ L dω at most; 0.0938 is the bound"
        ))?;
    }
    let noun = if tables.len() == 1 { "table" } else { "tables" };
    say(&format!("{} {noun} in {}", tables.len(), args.out.display()))?;
    if args.json { print_json(&manifest) } else { Ok(()) }
}

fn light_of(args: &Args) -> Result<(Light, LightSource)> {
    let Some(path) = &args.env else {
        let light = args.sky.clone().ok_or_else(|| Error::input("give --env FILE or --sky LIGHT"))?;
        let name = light.summary();
        let json = json!({ "kind": name });
        return Ok((light, LightSource { name, json, sha256: None }));
    };
    let invalid =
        if args.clamp { InvalidTexels::Clamp } else { InvalidTexels::Refuse { remedy: "give --clamp" } };
    let MapFile { map, clamped, notes } = light::read(path, invalid)?;
    notes.iter().for_each(|note| warn(&format!("{}: {note}", path.display())));
    if map.width() != 2 * map.height() {
        warn(&format!(
            "{}: {} × {} texels; a map of latitude and longitude is twice as wide as high",
            path.display(),
            map.width(),
            map.height()
        ));
    }
    if let Clamped { texels, first: Some(first) } = &clamped {
        warn(&format!("{}: {texels} texels were no radiance and are mended; {first}", path.display()));
    }
    let map = map.rotated(args.rotate);
    let hash = sha256(path)?;
    let json = json!({
        "kind": "map", "file": path.display().to_string(), "sha256": hash, "width": map.width(),
        "height": map.height(), "rotation": map.rotation(), "clamped": clamped, "notes": notes,
    });
    let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    Ok((Light::Map(map), LightSource { name, json, sha256: Some(hash) }))
}

/// Reads the scene or model, and finds the material to light.
fn lit(args: &Args) -> Result<Option<LitMaterial>> {
    let Some(name) = &args.subject else { return Ok(None) };
    let sets = args.set.iter().map(|set| key_value(set)).collect::<Result<Vec<_>>>()?;
    let path = Path::new(name);
    if path.extension().is_none() && !path.exists() {
        let mut sets = sets;
        // A model needs a roughness; --roughness alone must be enough.
        let model = crate::model::find(name)?;
        let first = args.roughness.first().map(f64::to_string).unwrap_or_default();
        if let (Some(shape), Some(_)) = (model.shape, args.roughness.first())
            && !sets.iter().any(|(key, _)| *key == shape.name || *key == "roughness")
        {
            sets.push(("roughness", &first));
        }
        let scene = subject::model(name, sets.iter().copied())?;
        let material = scene.materials[0].clone();
        return Ok(Some(LitMaterial { scene, material }));
    }
    let scene = scene::read(path)?;
    let material = match (&args.material, &scene.materials[..]) {
        (Some(name), _) => name.clone(),
        (None, [only]) => only.name.clone(),
        (None, all) => {
            let names: Vec<_> = all.iter().map(|material| material.name.as_str()).collect();
            return Err(Error::input(format!("{name}: give --material, one of {}", names.join(", "))));
        }
    };
    // --roughness replaces a varying roughness: any value within its range will do.
    let varying = scene.material(&material)?.varying();
    let varies = varying.iter().find(|(name, _)| name == "roughness").map(|(_, [low, _])| low.to_string());
    let mut sets = sets;
    if let Some(low) = varies.as_deref().filter(|_| !args.roughness.is_empty())
        && !sets.iter().any(|(key, _)| *key == "roughness")
    {
        sets.push(("roughness", low));
    }
    let scene = subject::material(scene, &material, sets)?;
    let material = scene.material(&material)?.clone();
    Ok(Some(LitMaterial { scene, material }))
}

/// Builds the axes of the normals: a grid over the sphere, or the one normal of `--normal`.
fn normals(args: &Args, grid: Option<[usize; 2]>) -> Result<[Axis; 2]> {
    let Some([rows, columns]) = grid else {
        let [theta, phi] = args.normal.unwrap_or([0.0; 2]);
        let theta = Axis::listed(Variable::ThetaN, vec![theta])?;
        return Ok([theta, Axis::listed(Variable::PhiN, vec![phi.rem_euclid(TAU)])?]);
    };
    Ok([Axis::natural(Variable::ThetaN, rows)?, Axis::natural(Variable::PhiN, columns)?])
}

#[allow(clippy::too_many_arguments)]
fn compute(
    args: &Args,
    light: &Light,
    source: &LightSource,
    lit: Option<&LitMaterial>,
    evaluator: &Evaluator,
    observer: &dyn Observer,
    set: &mut TableSet,
) -> Result<(Vec<Table>, Value)> {
    const NORMALS: [usize; 2] = [32, 64];
    let sampled = args.check.unwrap_or(match args.quantity {
        Wanted::Radiance | Wanted::Radiosity => Check::Sample(8),
        _ => Check::Sample(256),
    });
    let order =
        Order { evaluator, light, name: &source.name, tolerance: args.tolerance, check: sampled, observer };
    let mut stages = Timings::default();
    let spread = args.normals.or(args.normal.is_none().then_some(NORMALS));
    let mut truncation = None;
    let tables = match (args.quantity, lit) {
        (Wanted::Radiance, Some(LitMaterial { material, .. })) => {
            let [theta_n, phi_n] = normals(args, args.normals)?;
            let [rows, columns] = args.exits;
            let theta_e = match rows {
                1 => Axis::listed(Variable::ThetaE, vec![PI / 4.0])?,
                _ => Axis::natural(Variable::ThetaE, rows)?,
            };
            let phi_e = match columns {
                1 => Axis::listed(Variable::PhiE, vec![0.0])?,
                _ => Axis::new(Variable::PhiE, columns, [0.0, TAU], Positions::Centers, Mapping::Linear)?,
            };
            let [exact, split] =
                order.radiance(material, &args.roughness, [theta_n, phi_n, theta_e, phi_e], &mut stages)?;
            let off = difference(&exact, &split);
            vec![exact, split, off]
        }
        (Wanted::Radiosity, Some(LitMaterial { scene, material })) => {
            order.radiosity(scene, &material.name, normals(args, spread)?, &mut stages)?.to_vec()
        }
        (Wanted::Sh, _) => {
            let irradiance = order.irradiance(normals(args, spread)?, &mut stages)?;
            let ([sh, convolved], off) = order.harmonics(&irradiance, &mut stages)?;
            truncation = Some(off);
            vec![sh, convolved, irradiance]
        }
        _ => vec![order.irradiance(normals(args, spread)?, &mut stages)?],
    };
    // A table that misses its tolerance is no reason to draw first.
    tables.iter().try_for_each(|table| order.within_tolerance(table))?;
    let mut files = Vec::new();
    if !args.no_picture {
        observer.begin("drawing");
        let materials: Vec<_> = lit.iter().map(|lit| &lit.material).collect();
        let png = picture::draw(light, &source.name, &materials, &args.roughness, evaluator, observer)?;
        files.push(("light.png", png));
    }
    let mut formats = args.format.clone();
    formats.dedup();
    let details = SetDetails {
        source,
        material: lit.map(|lit| lit.material.name.as_str()),
        formats: &formats,
        truncation,
        timings: &stages,
        files: &files,
    };
    order.write(set, tables, &details)
}

/// Computes |LD (F0·A + F90·B) − Le| / Le, with Le at least the table's floor.
fn difference(exact: &Table, split: &Table) -> Table {
    let floor = exact.error.floor.unwrap_or(0.0).max(f64::MIN_POSITIVE);
    let pairs = exact.values.iter().zip(split.values.iter());
    let off: Vec<f32> = pairs.map(|(le, ld)| ((ld - le).abs() / le.max(floor)) as f32).collect();
    Table {
        name: SPLIT_SUM_ERROR.name.into(),
        quantity: &SPLIT_SUM_ERROR,
        values: off.into(),
        rule: "difference from the exact radiance, as a share of it".into(),
        ..split.clone()
    }
}
