//! Evaluates one pair of directions: f on the device and by the reference, and its factors D, G2 and F.

use crate::bake::Evaluator;
use crate::bake::points::Points;
use crate::base::angles::Angles;
use crate::base::error::{Error, Result};
use crate::base::half_angle::MU_MIN;
use crate::check;
use crate::check::{ReferenceLobe, VALUE_FLOOR, reference_angles};
use crate::cli::eval::{Args, is_sane, subject};
use crate::cli::{HEADING, open, print, print_json};
use crate::model::lobe::Lobe;
use crate::plan::TablePlan;
use serde::Serialize;
use serde_json::json;

/// The factors of a microfacet lobe, by the reference.
#[derive(Serialize)]
struct LobeFactors {
    model: &'static str,
    /// D(ωm), sr⁻¹.
    #[serde(rename = "D")]
    d: f64,
    #[serde(rename = "G2")]
    g2: f64,
    /// The weighted sum of the Fresnel term's components, for each channel.
    #[serde(rename = "F")]
    f: Vec<f64>,
}

pub fn run(args: &Args, angles: &Angles) -> Result<()> {
    let plan = subject(args, angles)?;
    angles.check()?;
    let (evaluator, line) = open(&args.device)?;
    let mut value = Vec::new();
    Points::new(evaluator, plan.lobes())?.evaluate(&[*angles], &mut value)?;
    let reference = check::reference(&plan, 0);
    let difference = relative_difference(&value, &reference);
    let factors: Vec<_> = plan.lobes().iter().filter_map(|lobe| factors(lobe, angles)).collect();
    // f diverges if both directions graze: all paths bound cos θ below by 2⁻²⁴.
    let mu_i = angles.theta_i.cos().max(MU_MIN);
    let f_cos: Vec<_> = value.iter().map(|&f| f64::from(f) * mu_i).collect();
    // δφ = φe − φi − π is exact to the last digit of an azimuth, about 1e-15: below that it is 0.
    let delta_phi = Some(angles.delta_phi()).filter(|d| d.abs() > 1e-15).unwrap_or(0.0);
    let precision = if matches!(evaluator, Evaluator::Cpu) { "f64" } else { "f32" };

    if args.json {
        print_json(&json!({
            "subject": plan.subject(), "parameters": plan.parameters(), "unit": plan.quantity().unit,
            "theta_i": angles.theta_i, "phi_i": angles.phi_i, "theta_e": angles.theta_e, "phi_e": angles.phi_e,
            "delta_phi": delta_phi,
            "channels": plan.channels(), "device": line, "value": value, "precision": precision,
            "reference": reference, "relative_difference": difference,
            "f_cos_theta_i": f_cos, "factors": factors,
        }))?;
    } else {
        let value: Vec<_> = value.iter().copied().map(f64::from).collect();
        print(&format!("{HEADING}f({}){HEADING:#} in sr⁻¹, δφ = {delta_phi} rad", plan.subject()))?;
        print(&format!("device      {}    {line}", by_channel(&plan, &value)))?;
        print(&format!("reference   {}    f64", by_channel(&plan, &reference)))?;
        print(&format!("difference  {difference:.1e} relative"))?;
        print(&format!("f cos θi    {}    of the device's f", by_channel(&plan, &f_cos)))?;
        for LobeFactors { model, d, g2, f } in &factors {
            print(&format!("{HEADING}{model}{HEADING:#}, f = F D G2 / (4 cos θi cos θe), by the reference"))?;
            print(&format!("D           {d:.8e} sr⁻¹"))?;
            print(&format!("G2          {g2:.8e}"))?;
            print(&format!("F           {}", by_channel(&plan, f)))?;
        }
    }
    if value.iter().copied().all(is_sane) {
        return Ok(());
    }
    Err(Error::Promise(format!("f({}) is not finite, or negative", plan.subject())))
}

/// Returns the largest relative difference of the channels; NaN if one is NaN.
fn relative_difference(value: &[f32], reference: &[f64]) -> f64 {
    let differences =
        value.iter().zip(reference).map(|(&f, r)| (f64::from(f) - r).abs() / r.max(VALUE_FLOOR));
    differences.fold(0.0, |max, d| if max >= d { max } else { d })
}

fn factors(lobe: &Lobe, angles: &Angles) -> Option<LobeFactors> {
    let factors = ReferenceLobe::exact(lobe, None)?.factors(&reference_angles(angles))?;
    let f = |&[a, b]: &[f64; 2]| a * factors.f[0] + b * factors.f[1];
    let f = lobe.weights().iter().map(f).collect();
    Some(LobeFactors { model: lobe.model().name, d: factors.d, g2: factors.g2, f })
}

fn by_channel(plan: &TablePlan, values: &[f64]) -> String {
    let words: Vec<_> = plan.channels().iter().zip(values).map(|(c, v)| format!("{c} = {v:.8e}")).collect();
    words.join("  ")
}
