//! Parses the lights of `--sky`.

use crate::base::error::Error;
use crate::cli::subject::key_value;
use crate::light::{Directional, Disk, Light, Radiance, Sky, direction};

/// Parses an angle: degrees, or radians as 0.5rad.
pub fn angle(text: &str) -> Result<f64, String> {
    let (number, scale) = match text.trim().strip_suffix("rad") {
        Some(radians) => (radians, 1.0),
        None => (text.trim().trim_end_matches("deg"), 1f64.to_radians()),
    };
    let value: Option<f64> = number.trim().parse().ok().filter(|x: &f64| x.is_finite());
    value.map(|x| x * scale).ok_or_else(|| format!("\"{text}\" is not an angle; give 45 or 0.5rad"))
}

/// Parses two angles: "θ,φ".
pub fn pair(text: &str) -> Result<[f64; 2], String> {
    let (theta, phi) = text.split_once(',').ok_or_else(|| format!("\"{text}\": give θ,φ, as in 45,90"))?;
    Ok([angle(theta)?, angle(phi)?])
}

/// Parses a radiance: a number, or R/G/B.
fn radiance(text: &str) -> Result<[f64; 3], String> {
    let numbers: Option<Vec<f64>> = text.split('/').map(|number| number.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[grey]) => Ok([grey; 3]),
        Some(&[r, g, b]) => Ok([r, g, b]),
        _ => Err(format!("\"{text}\" is no radiance; give a number, or three as 1/0.5/0.2")),
    }
}

/// Parses a light: KIND:PARAMETERS.
pub fn parse(text: &str) -> Result<Light, String> {
    let (kind, rest) = text.split_once(':').unwrap_or((text, ""));
    if kind == "constant" {
        let rgb = radiance(if rest.is_empty() { "1" } else { rest })?;
        return Radiance::new(rgb).map(Light::Constant).map_err(|error| error.to_string());
    }
    let pairs = rest.split(',').filter(|part| !part.trim().is_empty());
    let pairs = pairs.map(|part| key_value(part).map_err(|_| format!("\"{part}\": give KEY=VALUE")));
    let pairs = pairs.collect::<Result<Vec<_>, _>>()?;
    let names: &[&str] = match kind {
        "sky" => &["zenith", "horizon", "ground"],
        "disk" => &["theta", "phi", "radius", "radiance"],
        "sun" => &["theta", "phi", "irradiance"],
        _ => return Err(format!("\"{kind}\" is no light; give constant, sky, disk or sun")),
    };
    if let Some((unknown, _)) = pairs.iter().find(|(key, _)| !names.contains(key)) {
        return Err(format!("{kind} has no \"{unknown}\"; it takes {}", names.join(", ")));
    }
    let get = |name: &str| pairs.iter().find(|(key, _)| *key == name).map(|&(_, value)| value);
    let rgb = |name: &str, default: &str| radiance(get(name).unwrap_or(default));
    let towards = || -> Result<[f64; 3], String> {
        Ok(direction(angle(get("theta").unwrap_or("45"))?, angle(get("phi").unwrap_or("0"))?))
    };
    let light = match kind {
        "sky" => Sky::new(rgb("zenith", "1")?, rgb("horizon", "0.5")?, rgb("ground", "0.1")?).map(Light::Sky),
        "disk" => {
            // The default is the half angle of the sun as seen from the earth.
            let radius = angle(get("radius").unwrap_or("0.2665"))?;
            Disk::new(towards()?, radius, rgb("radiance", "1")?).map(Light::Disk)
        }
        _ => Directional::new(towards()?, rgb("irradiance", "1")?).map(Light::Directional),
    };
    light.map_err(|error: Error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lights_are_read_and_faults_named() {
        assert_eq!(parse("constant:2").unwrap(), Light::Constant(Radiance::new([2.0; 3]).unwrap()));
        assert_eq!(
            parse("constant:1/2/3").unwrap(),
            Light::Constant(Radiance::new([1.0, 2.0, 3.0]).unwrap())
        );
        let Light::Disk(disk) = parse("disk:theta=0,radius=1rad,radiance=5").unwrap() else { panic!() };
        assert_eq!((disk.direction()[2], disk.radius(), disk.radiance()), (1.0, 1.0, [5.0; 3]));
        assert!(matches!(parse("sky").unwrap(), Light::Sky(_)));
        assert!(parse("moon").unwrap_err().contains("constant, sky, disk or sun"));
        assert!(parse("sun:radius=2").unwrap_err().contains("theta, phi, irradiance"));
        assert!(parse("disk:radiance=1/2").unwrap_err().contains("no radiance"));
        assert!((angle("90").unwrap() - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
        assert!(angle("nan").is_err());
    }
}
