//! Draws a check: ρ_dh over θi for several parameters, and the relative error against the reference over θi and
//! θe, at the parameters and the δφ of its worst input.

use crate::base::angles::Angles;
use crate::base::error::Result;
use crate::base::precision::Precision;
use crate::io::format::PNG;
use crate::io::{Outputs, Provenance};
use crate::table::axis::{Axis, Variable};
use crate::table::quantity::{BRDF, Quantity, RHO_DH};
use crate::table::storage::Storage;
use crate::table::{ErrorKind, Table, TableError};
use crate::verify::{FAINT, Finding, ParameterRange, Report, Subject};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::path::{Path, PathBuf};

/// Lines, and samples of θ.
const LINES: usize = 6;
const ANGLES: usize = 181;
const SIDE: usize = 181;

/// Quantities whose names are the labels of the pictures.
static ALBEDO: Quantity = Quantity { name: "ρ_dh", ..RHO_DH };
static DEVIATION: Quantity =
    Quantity {
        name: "error", unit: "1", summary: "|f − reference| / reference", is_promised: false, ..BRDF
    };

/// Stages `STEM.rho_dh.png`, and `STEM.error.png` if the subject has values; returns their paths.
pub fn write(
    dir: &Path,
    stem: &str,
    subject: &mut dyn Subject,
    report: &Report,
    outputs: &mut Outputs,
) -> Result<Vec<PathBuf>> {
    let tables = [furnace(subject, report)?, errors(subject, report)?];
    let mut files = Vec::new();
    for (table, what) in tables.into_iter().zip(["rho_dh", "error"]) {
        if let Some(table) = table {
            let path = dir.join(format!("{stem}.{what}.png"));
            outputs.add(&path, PNG.encode(&table, &Provenance::new())?)?;
            files.push(path);
        }
    }
    Ok(files)
}

/// Tabulates ρ_dh over θi, a line for each of `LINES` values of the first parameter that has a range, with the
/// others as at the largest ρ_dh. If none has a range: a line for each of R, G and B.
fn furnace(subject: &mut dyn Subject, report: &Report) -> Result<Option<Table>> {
    let parameters = subject.integral_parameters().to_vec();
    let Some(base) = setting(report, "energy") else { return Ok(None) };
    let theta = Axis::natural(Variable::ThetaI, ANGLES)?;
    let free = parameters.iter().position(|parameter| parameter.low < parameter.high);
    let (names, settings): (Vec<_>, Vec<_>) = match free {
        None => (Vec::new(), vec![base.clone()]),
        Some(k) => (0..LINES)
            .map(|line| {
                let value = between(&parameters[k], line as f64 / (LINES - 1) as f64);
                let mut setting = base.clone();
                setting[k] = value;
                (short(value), setting)
            })
            .unzip(),
    };
    let Some(rho) = subject.rho_dh(&settings, theta.values())? else { return Ok(None) };
    let channels = subject.channels();
    let (lines, values): (_, Vec<_>) = if names.is_empty() {
        (["R", "G", "B"].map(String::from).to_vec(), rho)
    } else {
        let largest: Vec<_> =
            rho.chunks_exact(channels).map(|rho| rho.iter().copied().fold(0.0, f64::max)).collect();
        let columns = theta.len();
        let by_angle = (0..columns).flat_map(|j| (0..settings.len()).map(move |k| k * columns + j));
        (names, by_angle.map(|index| largest[index]).collect())
    };
    let fixed = pinned(&parameters, &base, free);
    let name = free.map_or("furnace".into(), |k| format!("furnace, a line for each {}", parameters[k].name));
    Ok(Some(table(&name, &ALBEDO, report, vec![theta], lines, values, fixed, None)))
}

/// Tabulates |f − reference| / reference over θi and θe, the largest of the channels.
fn errors(subject: &mut dyn Subject, report: &Report) -> Result<Option<Table>> {
    let Some(finding) = report.find("agreement") else { return Ok(None) };
    let (Some(input), Some(base)) = (&finding.input, setting(report, "agreement")) else { return Ok(None) };
    let delta_phi = input.angles.delta_phi();
    let axes = [Variable::ThetaI, Variable::ThetaE].map(|variable| Axis::natural(variable, SIDE));
    let axes = axes.into_iter().collect::<Result<Vec<_>>>()?;
    let pairs = axes[0].values().iter().flat_map(|&i| axes[1].values().iter().map(move |&e| (i, e)));
    let angles: Vec<_> = pairs
        .map(|(theta_i, theta_e)| Angles { theta_i, phi_i: 0.0, theta_e, phi_e: PI + delta_phi })
        .collect();
    let mut values = Vec::new();
    subject.evaluate(&base, &angles, &mut values)?;
    let error = |(angles, f): (&Angles, &[f32])| {
        let truth = subject.reference(&base, angles).unwrap_or_default();
        let errors = f.iter().zip(truth).map(|(&f, truth)| (f64::from(f) - truth).abs() / truth.max(FAINT));
        errors.fold(0.0, f64::max)
    };
    let errors: Vec<_> = angles.iter().zip(values.chunks_exact(subject.channels())).map(error).collect();
    let mut fixed = pinned(subject.parameters(), &base, None);
    fixed.insert("δφ [rad]".into(), delta_phi);
    let channel = vec!["relative error".to_owned()];
    Ok(Some(table("agreement", &DEVIATION, report, axes, channel, errors, fixed, finding.deviation)))
}

/// Returns the parameters of a promise's worst input.
fn setting(report: &Report, property: &str) -> Option<Vec<f64>> {
    let Finding { input, .. } = report.find(property)?;
    Some(input.as_ref()?.setting.iter().map(|&(_, value)| value).collect())
}

fn pinned(parameters: &[ParameterRange], setting: &[f64], but: Option<usize>) -> BTreeMap<String, f64> {
    let names = parameters.iter().map(|parameter| parameter.name.clone());
    let all = names.zip(setting.iter().copied()).enumerate();
    all.filter(|(k, _)| Some(*k) != but).map(|(_, pair)| pair).collect()
}

#[allow(clippy::too_many_arguments)] // each is one label of the picture
fn table(
    name: &str,
    quantity: &'static Quantity,
    report: &Report,
    axes: Vec<Axis>,
    channels: Vec<String>,
    values: Vec<f64>,
    parameters: BTreeMap<String, f64>,
    worst: Option<f64>,
) -> Table {
    let kind = if worst.is_some() { ErrorKind::Relative } else { ErrorKind::Absolute };
    let error = TableError {
        measured_max: worst,
        texels_checked: values.len(),
        ..TableError::unmeasured(kind, None, None)
    };
    Table {
        name: name.into(),
        quantity,
        subject: report.subject.clone(),
        parameters,
        axes,
        channels,
        values: values.into(),
        rule: "gonio check".into(),
        storage: Storage::F64,
        bilinear: None,
        precision: Precision::F32,
        error,
        seconds: 0.0,
    }
}

/// Interpolates a parameter's range at u in [0, 1]. α has even steps in roughness = √α, in which lobes change
/// evenly.
fn between(parameter: &ParameterRange, u: f64) -> f64 {
    let ParameterRange { ref name, low, high, .. } = *parameter;
    let value = match name.as_str() {
        "alpha" => (low.sqrt() + u * (high.sqrt() - low.sqrt())).powi(2),
        _ => low + u * (high - low),
    };
    value.clamp(low, high)
}

/// Formats a number for a legend.
fn short(value: f64) -> String {
    if value != 0.0 && value < 1e-3 { format!("{value:.0e}") } else { format!("{value:.3}") }
}
