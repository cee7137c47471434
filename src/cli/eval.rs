//! `gonio eval`

mod many;
mod one;

use crate::backend::gpu::DeviceChoice;
use crate::base::angles::Angles;
use crate::base::error::{Error, Result};
use crate::cli::subject;
use crate::plan::TablePlan;
use crate::scene;
use crate::table::axis::{Axis, Variable};
use crate::table::quantity::BRDF;
use std::f64::consts::{PI, TAU};
use std::path::PathBuf;

#[derive(clap::Args)]
#[command(after_help = AFTER_HELP)]
pub struct Args {
    /// A scene or recipe that has the material
    #[arg(value_name = "SCENE", requires = "material", conflicts_with = "model")]
    scene: Option<PathBuf>,
    /// A material of the scene
    #[arg(long, value_name = "NAME", requires = "scene")]
    material: Option<String>,
    /// A model; gonio models lists them
    #[arg(long, value_name = "NAME", required_unless_present = "scene")]
    model: Option<String>,
    /// Set a parameter of the model, or a varying parameter of the material; may be repeated
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Zenith angle of incidence: radians, or degrees as 45deg
    #[arg(long, value_name = "ANGLE", value_parser = angle, allow_hyphen_values = true,
          required_unless_present = "pairs")]
    theta_i: Option<f64>,
    /// Azimuth of incidence [default: 0]
    #[arg(long, value_name = "ANGLE", value_parser = angle, allow_hyphen_values = true)]
    phi_i: Option<f64>,
    /// Zenith angle of exitance
    #[arg(long, value_name = "ANGLE", value_parser = angle, allow_hyphen_values = true,
          required_unless_present = "pairs")]
    theta_e: Option<f64>,
    /// Azimuth of exitance [default: phi_i + 180°, as a mirror reflects]
    #[arg(long, value_name = "ANGLE", value_parser = angle, allow_hyphen_values = true)]
    phi_e: Option<f64>,
    /// A file with a list of pairs: NPY (n, 4) in float64 or float32, or CSV; columns theta_i, phi_i, theta_e,
    /// phi_e in radians
    #[arg(long, value_name = "FILE", requires = "out",
          conflicts_with_all = ["theta_i", "phi_i", "theta_e", "phi_e"])]
    pairs: Option<PathBuf>,
    /// The file for the values of the list: NPY (n, channels) in float32, or CSV, by its extension
    #[arg(long, short, value_name = "FILE", requires = "pairs")]
    out: Option<PathBuf>,
    /// `auto` (best GPU, else software Vulkan, else CPU), `cpu`, or part of an adapter's name
    #[arg(long, value_name = "NAME", default_value = "auto")]
    device: DeviceChoice,
    /// Print JSON on stdout
    #[arg(long)]
    json: bool,
}

const AFTER_HELP: &str = "\
Examples:
  gonio eval --model ggx --set roughness=0.3 --theta-i 45deg --theta-e 45deg
  gonio eval --model ggx --set alpha=0.1 --set f0=[1,0.78,0.34] --theta-i 0.5 --theta-e 0.5 --phi-e 3
  gonio eval --model ggx --set alpha=0.1 --set masking=smith-separable --set fresnel=none --theta-i 0.5 --theta-e 0.5
  gonio eval recipe.toml --material gold --theta-i 30deg --theta-e 60deg
  gonio eval recipe.toml --material gold --pairs pairs.npy --out values.npy

A list in CSV; the header line and lines that begin with # are optional:
  theta_i,phi_i,theta_e,phi_e
  # the mirror direction, and a millionth of a radian from it
  0.7,0,0.7,3.141592653589793
  0.7,0,0.700001,3.141592653589793

Exit codes: 0 success, 1 values not finite or negative, 2 bad input, 3 no device, 130 interrupted";

fn angle(text: &str) -> Result<f64, String> {
    let (number, scale) = match text.strip_suffix("deg") {
        Some(degrees) => (degrees, PI / 180.0),
        None => (text, 1.0),
    };
    let value: f64 =
        number.trim().parse().map_err(|_| format!("\"{text}\" is not an angle; give 0.5 or 30deg"))?;
    if value.is_finite() { Ok(value * scale) } else { Err(format!("\"{text}\" is not finite")) }
}

pub fn run(args: &Args) -> Result<()> {
    match (&args.pairs, &args.out, args.theta_i, args.theta_e) {
        (Some(pairs), Some(out), ..) => many::run(args, pairs, out),
        (None, _, Some(theta_i), Some(theta_e)) => {
            let phi_i = args.phi_i.unwrap_or(0.0);
            one::run(args, &Angles { theta_i, phi_i, theta_e, phi_e: args.phi_e.unwrap_or(phi_i + PI) })
        }
        _ => Err(Error::input("give --theta-i and --theta-e, or --pairs and --out")),
    }
}

/// Plans a table of one texel: a material, or a model with parameters, at one pair of directions.
fn subject(args: &Args, angles: &Angles) -> Result<TablePlan> {
    let sets = args.set.iter().map(|set| subject::key_value(set)).collect::<Result<Vec<_>>>()?;
    let (scene, name) = match (&args.scene, &args.material, &args.model) {
        (Some(path), Some(name), _) => (subject::material(scene::read(path)?, name, sets)?, name.clone()),
        (_, _, Some(model)) => {
            let scene = subject::model(model, sets)?;
            let name = scene.materials[0].name.clone();
            (scene, name)
        }
        _ => return Err(Error::input("give --model NAME, or a SCENE and --material NAME")),
    };
    let axes = axes(scene.material(&name)?.is_anisotropic(), angles)?;
    TablePlan::material("eval", &BRDF, &scene, &name, axes)
}

/// Builds axes of one sample each: (θi, θe, δφ), or (θi, φi, θe, φe) if azimuths matter.
fn axes(anisotropic: bool, angles: &Angles) -> Result<Vec<Axis>> {
    let sample = |&variable: &Variable| {
        let value = match variable {
            Variable::ThetaI => angles.theta_i,
            Variable::PhiI => angles.phi_i.rem_euclid(TAU),
            Variable::ThetaE => angles.theta_e,
            Variable::PhiE => angles.phi_e.rem_euclid(TAU),
            // Isotropic models are symmetric about the plane of incidence.
            _ => angles.delta_phi().abs(),
        };
        Axis::listed(variable, vec![value])
    };
    BRDF.variables(anisotropic).iter().map(sample).collect()
}

/// Tells whether a value is finite and not negative, as every BRDF's must be.
fn is_sane(value: f32) -> bool {
    value.is_finite() && value >= 0.0
}
