//! The subject of a command: a model with `--set`, or a material of a scene.

use crate::base::error::{Error, Result};
use crate::model;
use crate::scene;
use crate::scene::Scene;

/// Splits `KEY=VALUE` and trims both.
pub fn key_value(set: &str) -> Result<(&str, &str)> {
    let pair = set.split_once('=').map(|(key, value)| (key.trim(), value.trim()));
    pair.filter(|(key, value)| !key.is_empty() && !value.is_empty())
        .ok_or_else(|| Error::input(format!("--set {set}: give KEY=VALUE, as in --set roughness=0.3")))
}

/// Builds a scene of one material with one lobe: the model with these parameters. The recipe's reader reports
/// wrong names and values. The material is named after the model with its terms.
pub fn model<'a>(name: &str, sets: impl IntoIterator<Item = (&'a str, &'a str)>) -> Result<Scene> {
    let name = model::find(name)?.name;
    let mut lobe = format!("model = \"{name}\"");
    for (key, value) in sets {
        lobe += &format!(", {key} = {}", toml(value));
    }
    let text = format!("[materials.{name}]\nlobes = [{{ {lobe} }}]\n");
    let mut scene = scene::parse_recipe("--set".as_ref(), text.as_bytes())?;
    match &mut scene.materials[..] {
        [material] if scene.tables.is_empty() && material.lobes.len() == 1 => {
            material.name.clone_from(&material.lobes[0].model);
            Ok(scene)
        }
        _ => Err(Error::input("--set: give one value of one parameter each, as in --set roughness=0.3")),
    }
}

/// Writes a value as TOML: adds the quotes that a word needs there and not on a command line.
fn toml(value: &str) -> String {
    let is_word = !matches!(value, "nan" | "inf" | "true" | "false")
        && value.starts_with(|c: char| c.is_ascii_alphabetic())
        && value.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_');
    if is_word { format!("\"{value}\"") } else { value.to_owned() }
}

/// Sets the varying parameters of a material of the scene to fixed values.
pub fn material<'a>(
    mut scene: Scene,
    name: &str,
    sets: impl IntoIterator<Item = (&'a str, &'a str)>,
) -> Result<Scene> {
    let number = |(key, value): (&str, &str)| {
        let value = value.parse().map_err(|_| {
            Error::input(format!("--set {key}={value}: \"{value}\" is no number; give one, as in {key}=0.3"))
        });
        Ok((key.to_owned(), value?))
    };
    let setting = sets.into_iter().map(number).collect::<Result<Vec<_>>>()?;
    let fixed = scene.material(name)?.at(&setting)?;
    scene.materials.iter_mut().filter(|material| material.name == name).for_each(|m| m.clone_from(&fixed));
    Ok(scene)
}
