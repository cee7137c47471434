//! What a check is to forgive: from `gonio-check.toml` beside the file that is checked, and from options, which count more.

use crate::base::error::{Error, Result};
use crate::verify::Exceptions;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;
use std::io::ErrorKind;
use std::path::Path;

/// The file's name.
const FILE: &str = "gonio-check.toml";

#[derive(clap::Args)]
pub struct ExceptionArgs {
    /// Allow a promise to be broken up to this worst value, e.g. energy=1.56
    #[arg(long, value_name = "PROMISE=VALUE")]
    allow: Vec<String>,
    /// Hold a promise to this tolerance, e.g. reciprocity=1e-3
    #[arg(long, value_name = "PROMISE=VALUE")]
    tolerance: Vec<String>,
    /// Judge only pairs of directions whose zenith angles are both in this range, e.g. 0..89.9deg or 0..1.5rad
    #[arg(long, value_name = "LOW..HIGH")]
    theta: Option<String>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct CheckFile {
    #[serde(default)]
    allow: BTreeMap<String, f64>,
    #[serde(default)]
    tolerance: BTreeMap<String, f64>,
    theta: Option<String>,
}

/// Reads both. `subject` is the file that is checked, if there is one.
pub fn read(args: &ExceptionArgs, subject: Option<&Path>) -> Result<Exceptions> {
    let mut exceptions = Exceptions::default();
    if let Some((name, text)) = subject.map(beside).transpose()?.flatten() {
        let file: CheckFile = toml::from_str(&text).map_err(|e| Error::input(format!("{name}: {e}")))?;
        let at = |result: Result<()>| result.map_err(|error| error.at(&name));
        for (promise, &bound) in &file.allow {
            at(exceptions.allow(promise, bound, FILE))?;
        }
        for (promise, &tolerance) in &file.tolerance {
            at(exceptions.tolerance(promise, tolerance))?;
        }
        if let Some(theta) = &file.theta {
            at(range(theta).and_then(|range| exceptions.theta(range)))?;
        }
    }
    for text in &args.allow {
        let (promise, bound) = pair("--allow", text)?;
        exceptions.allow(promise, bound, "--allow")?;
    }
    for text in &args.tolerance {
        let (promise, tolerance) = pair("--tolerance", text)?;
        exceptions.tolerance(promise, tolerance)?;
    }
    if let Some(theta) = &args.theta {
        range(theta).and_then(|range| exceptions.theta(range)).map_err(|error| error.at("--theta"))?;
    }
    Ok(exceptions)
}

/// The name and the text of the file beside a subject, if there is one. One that cannot be read is not passed over.
fn beside(subject: &Path) -> Result<Option<(String, String)>> {
    let path = subject.with_file_name(FILE);
    match std::fs::read_to_string(&path) {
        Ok(text) => Ok(Some((path.display().to_string(), text))),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(Error::io("read", &path)(error)),
    }
}

fn pair<'a>(option: &str, text: &'a str) -> Result<(&'a str, f64)> {
    let parsed =
        text.split_once('=').and_then(|(name, value)| Some((name.trim(), value.trim().parse().ok()?)));
    parsed.ok_or_else(|| Error::input(format!("{option} {text}: give PROMISE=VALUE, as in energy=1.2")))
}

/// A range of angles in deg or rad.
fn range(text: &str) -> Result<[f64; 2]> {
    let fault =
        || Error::input(format!("\"{text}\": give LOW..HIGH with a unit, as in 0..89.9deg or 0..1.5rad"));
    let (low, high) = text.split_once("..").ok_or_else(fault)?;
    let split = |text: &str| -> Result<(f64, Option<f64>)> {
        let text = text.trim();
        let units = [("deg", FRAC_PI_2 / 90.0), ("°", FRAC_PI_2 / 90.0), ("rad", 1.0)];
        let unit = units.iter().find_map(|(unit, size)| Some((text.strip_suffix(unit)?, *size)));
        let number = unit.map_or(text, |(number, _)| number).trim().parse().map_err(|_| fault())?;
        Ok((number, unit.map(|(_, size)| size)))
    };
    let ((low, low_unit), (high, unit)) = (split(low)?, split(high)?);
    let unit = unit.ok_or_else(fault)?;
    Ok([low * low_unit.unwrap_or(unit), high * unit])
}
