//! `gonio eval`

use super::{HEADING, print, print_json};
use crate::axis::{Axis, Variable};
use crate::bake::{Evaluator, Stages, Unobserved};
use crate::check::{self, Check};
use crate::error::{Error, Result};
use crate::gpu::DeviceChoice;
use crate::models;
use crate::plan::TablePlan;
use crate::quantity::BRDF;
use crate::scene;
use serde_json::json;
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
    /// A model: lambert, gltf_diffuse or ggx
    #[arg(long, value_name = "NAME", required_unless_present = "scene")]
    model: Option<String>,
    /// A parameter of the model, by its name in recipes; repeat for more
    #[arg(long, value_name = "KEY=VALUE", requires = "model")]
    set: Vec<String>,
    /// Zenith angle of incidence: radians, or degrees as 45deg
    #[arg(long, value_name = "ANGLE", value_parser = angle, allow_hyphen_values = true)]
    theta_i: f64,
    /// Azimuth of incidence
    #[arg(long, value_name = "ANGLE", value_parser = angle, default_value = "0", allow_hyphen_values = true)]
    phi_i: f64,
    /// Zenith angle of exitance
    #[arg(long, value_name = "ANGLE", value_parser = angle, allow_hyphen_values = true)]
    theta_e: f64,
    /// Azimuth of exitance [default: opposite to that of incidence, where a mirror reflects]
    #[arg(long, value_name = "ANGLE", value_parser = angle, allow_hyphen_values = true)]
    phi_e: Option<f64>,
    /// auto, cpu, or a part of an adapter's name
    #[arg(long, value_name = "NAME", default_value = "auto")]
    device: DeviceChoice,
    /// Print JSON on stdout
    #[arg(long)]
    json: bool,
}

const AFTER_HELP: &str = "\
Examples:
  gonio eval --model ggx --set roughness=0.3 --theta-i 45deg --theta-e 45deg
  gonio eval --model ggx --set alpha=0.1 --set f0=[1.0,0.78,0.34] --theta-i 0.5 --theta-e 0.5 --phi-e 3.0
  gonio eval recipe.toml --material gold --theta-i 30deg --theta-e 60deg

Exit codes: 0 success, 2 bad input, 3 no device";

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
    let delta_phi = args.phi_e.map_or(0.0, |phi_e| wrap(phi_e - args.phi_i - PI));
    let axes = vec![
        Axis::listed(Variable::ThetaI, vec![args.theta_i])?,
        Axis::listed(Variable::ThetaE, vec![args.theta_e])?,
        // The models do not tell left from right.
        Axis::listed(Variable::DeltaPhi, vec![delta_phi.abs()])?,
    ];
    let plan = subject(args, axes)?;
    let (evaluator, line) = Evaluator::choose(&args.device)?;
    let table = evaluator.bake(&plan, Check::All, &mut Stages::default(), &Unobserved)?;
    let reference = check::reference(&plan, 0);
    let difference = table.error.measured_max;

    if args.json {
        return print_json(&json!({
            "subject": plan.subject, "parameters": table.parameters, "unit": table.unit,
            "theta_i": args.theta_i, "theta_e": args.theta_e, "delta_phi": delta_phi,
            "channels": table.channels, "device": line, "value": table.values, "precision": table.precision,
            "reference": reference, "relative_difference": difference,
        }));
    }
    let show = |values: &[f64]| {
        let words: Vec<_> =
            table.channels.iter().zip(values).map(|(c, v)| format!("{c} = {v:.8e}")).collect();
        words.join("  ")
    };
    print(&format!("{HEADING}f({}){HEADING:#} in sr⁻¹, δφ = {delta_phi:.6} rad", plan.subject))?;
    print(&format!("device      {}    {line}", show(&table.texel(0))))?;
    print(&format!("reference   {}    f64", show(&reference)))?;
    print(&format!("difference  {:.1e} relative", difference.unwrap_or(f64::NAN)))
}

/// What to evaluate: a material, or a model with parameters, in a recipe's own words.
fn subject(args: &Args, axes: Vec<Axis>) -> Result<TablePlan> {
    let (scene, name) = match (&args.scene, &args.material, &args.model) {
        (Some(path), Some(name), _) => (scene::read(path)?, name.clone()),
        (_, _, Some(model)) => {
            let model = models::find(model)?.name;
            let mut lobe = format!("model = \"{model}\"");
            for set in &args.set {
                let (key, value) = set.split_once('=').ok_or_else(|| {
                    Error::input(format!("--set {set}: give KEY=VALUE, as in --set roughness=0.3"))
                })?;
                lobe += &format!(", {key} = {value}");
            }
            let text = format!("[materials.{model}]\nlobes = [{{ {lobe} }}]\n");
            (scene::parse_recipe("--set".as_ref(), text.as_bytes())?, model.to_owned())
        }
        _ => return Err(Error::input("give --model NAME, or a SCENE and --material NAME")),
    };
    TablePlan::material("eval", &BRDF, &scene, &name, axes)
}

/// An angle in (−π, π].
fn wrap(angle: f64) -> f64 {
    let wrapped = angle.rem_euclid(TAU);
    if wrapped > PI { wrapped - TAU } else { wrapped }
}
