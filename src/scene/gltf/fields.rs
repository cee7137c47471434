//! Numbers and textures of a material, by their keys.

use crate::base::error::{Error, Result};
use crate::scene::gltf::printable;
use crate::scene::gltf::root::{Root, look_up};
use serde_json::Value;
use std::cell::RefCell;

/// What stands behind a texture.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    /// Its index, as it stands in the file.
    pub index: String,
    /// The image of its texels; else why there is none.
    pub image: Result<usize, String>,
}

/// An object of a material: `pbrMetallicRoughness`, or an extension.
pub struct Fields<'a> {
    /// What stands before its keys in messages.
    place: String,
    root: &'a Root,
    value: &'a Value,
    /// What of it is corrected.
    warnings: &'a RefCell<Vec<String>>,
}

impl<'a> Fields<'a> {
    /// # Errors
    /// When `value` is there and is no object.
    pub fn new(
        name: &str,
        root: &'a Root,
        value: &'a Value,
        warnings: &'a RefCell<Vec<String>>,
    ) -> Result<Self> {
        match value {
            Value::Null | Value::Object(_) => Ok(Self { place: name.into(), root, value, warnings }),
            _ => Err(Error::input(format!("{name} is no object; export the file again"))),
        }
    }

    /// The same, whose keys speak for themselves.
    pub fn nameless(self) -> Self {
        Self { place: String::new(), ..self }
    }

    /// Whether the material has it.
    pub fn is_there(&self) -> bool {
        self.value.is_object()
    }

    /// What messages call a key.
    pub fn name(&self, key: &str) -> String {
        if self.place.is_empty() { key.into() } else { format!("{}: {key}", self.place) }
    }

    pub fn warn(&self, warning: String) {
        self.warnings.borrow_mut().push(warning);
    }

    pub fn get(&self, key: &str) -> Option<&'a Value> {
        self.value.get(key)
    }

    /// A number of a range. One beyond it is warned of, and the nearest that glTF allows is taken.
    pub fn number(&self, key: &str, default: f64, range: [f64; 2]) -> Result<f64> {
        self.get(key).map_or(Ok(default), |value| self.checked(key, value, range))
    }

    fn checked(&self, key: &str, value: &Value, [low, high]: [f64; 2]) -> Result<f64> {
        let name = self.name(key);
        let Some(number) = value.as_f64() else {
            let value = printable(&value.to_string());
            let allowed =
                if high < f64::MAX { format!("in [{low}, {high}]") } else { format!("from {low} on") };
            return Err(Error::input(format!(
                "{name} is {value}, which glTF does not allow; correct it to a number {allowed}"
            )));
        };
        let clamped = number.clamp(low, high);
        if clamped != number {
            self.warn(format!("{name} is {number}, which glTF does not allow; it is taken as {clamped}"));
        }
        Ok(clamped)
    }

    /// R, G and B; what stands behind them is not read.
    pub fn color(&self, key: &str, default: f64, range: [f64; 2]) -> Result<[f64; 3]> {
        let Some(value) = self.get(key) else { return Ok([default; 3]) };
        let Some([r, g, b, ..]) = value.as_array().map(Vec::as_slice) else {
            return Err(Error::input(format!("{} is no list of three numbers; correct it", self.name(key))));
        };
        let channel = |k, value| self.checked(&format!("{key}[{k}]"), value, range);
        Ok([channel(0, r)?, channel(1, g)?, channel(2, b)?])
    }

    /// The texture of a key, looked up.
    pub fn texture(&self, key: &str) -> Option<Texture> {
        let index = &self.get(key)?["index"];
        Some(Texture { index: printable(&index.to_string()), image: self.image(index) })
    }

    /// Where a texture's texels are. An image in a format of an extension (Basis, WebP) counts only where the file has no
    /// PNG or JPEG beside it.
    fn image(&self, index: &Value) -> Result<usize, String> {
        if index.is_null() {
            return Err("it has no index".into());
        }
        let (_, texture) = look_up(&self.root.textures, index, "textures")?;
        let extended = || texture["extensions"].as_object()?.values().find_map(|value| value.get("source"));
        let source = texture.get("source").or_else(extended).ok_or("it names no image")?;
        look_up(&self.root.images, source, "images").map(|(index, _)| index)
    }

    /// Whether a texture multiplies a factor of which the whole range is taken, whatever its texels are.
    pub fn is_textured(&self, key: &str) -> bool {
        let Some(texture) = self.texture(key) else { return false };
        if let Err(why) = &texture.image {
            self.warn(format!("{}: {why}; it is taken over its whole range", self.name(key)));
        }
        true
    }
}
