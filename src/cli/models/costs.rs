//! `gonio models --costs`

use crate::backend::gpu::DeviceChoice;
use crate::bake::Observer;
use crate::base::error::{Error, Result};
use crate::cli::watch::Watch;
use crate::cli::{HEADING, device_json, open, print_beside, print_json};
use crate::lab::trade::{Cost, costs};
use crate::model::Model;
use serde_json::json;

/// Measures the evaluations and the error of each model at each tolerance.
pub(super) fn run(
    models: &[&'static Model],
    tolerances: &[f64],
    device: &DeviceChoice,
    json: bool,
) -> Result<()> {
    let (evaluator, name) = open(device)?;
    let say = |text: &str| print_beside(json, text);
    say(&format!("{HEADING}device{HEADING:#}  {name}"))?;
    say("for each tolerance: evaluations of the integrand for a texel, arithmetic, largest error")?;
    let tolerance = |t: &f64| format!("  {:>26}", format!("{t:e}"));
    let heads: String = tolerances.iter().map(tolerance).collect();
    say(&format!("{HEADING}  {:26}{:8}{heads}{HEADING:#}", "model", "quantity"))?;
    let watch = Watch::new(models.len());
    let mut all = Vec::new();
    for model in models {
        watch.begin(model.name);
        let measured = costs(evaluator, model, tolerances, &watch)?;
        for quantity in measured.chunks(tolerances.len()) {
            watch.hide(|| say(&line(quantity)))?;
        }
        all.extend(measured);
    }
    watch.finish();
    if json {
        print_json(&json!({ "device": device_json(evaluator), "costs": all }))?;
    }
    let missed: Vec<_> = all.iter().filter(|cost| !cost.is_met()).collect();
    match missed[..] {
        [] => Ok(()),
        [Cost { model, quantity, tolerance, error, .. }, ..] => Err(Error::Promise(format!(
            "{} of {} tolerances missed; the first: {quantity} of {model} to {tolerance:e} is off by {error:.1e}",
            missed.len(),
            all.len()
        ))),
    }
}

/// Formats one quantity of a model at all tolerances.
fn line(costs: &[Cost]) -> String {
    let cell = |cost: &Cost| {
        let mark = if cost.is_met() { ' ' } else { '!' };
        format!("  {:>10}  {}  {:>8}{mark}", cost.evaluations, cost.precision, format!("{:.1e}", cost.error))
    };
    let cells: String = costs.iter().map(cell).collect();
    format!("  {:26}{:8}{cells}", costs[0].model, costs[0].quantity)
}
