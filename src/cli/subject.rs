//! What a command is about, in a recipe's own words: a model with `--set`, or a material of a scene.

use crate::base::error::{Error, Result};
use crate::model;
use crate::scene;
use crate::scene::Scene;

/// `KEY=VALUE`, without the blanks around either.
pub fn key_value(set: &str) -> Result<(&str, &str)> {
    let pair = set.split_once('=').map(|(key, value)| (key.trim(), value.trim()));
    pair.filter(|(key, value)| !key.is_empty() && !value.is_empty())
        .ok_or_else(|| Error::input(format!("--set {set}: give KEY=VALUE, as in --set roughness=0.3")))
}

/// A scene of one material with one lobe: the model with these parameters. The recipe's own reader says what
/// is wrong with a name or a value. The material is called by the name that tells the model's terms.
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

/// A value as TOML: a word needs no quotes on a command line.
fn toml(value: &str) -> String {
    let is_word = !matches!(value, "nan" | "inf" | "true" | "false")
        && value.starts_with(|c: char| c.is_ascii_alphabetic())
        && value.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_');
    if is_word { format!("\"{value}\"") } else { value.to_owned() }
}

/// The scene, its material at one setting of what varies in it.
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
    let at = scene.material(name)?.at(&setting)?;
    scene.materials.iter_mut().filter(|material| material.name == name).for_each(|m| m.clone_from(&at));
    Ok(scene)
}
