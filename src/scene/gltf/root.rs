//! The parts of a glTF's JSON that say what its materials are. Everything else is skipped unread, so that a mistake in an
//! animation or in `extras` refuses no scene.

use serde::de::{DeserializeSeed, Deserializer, Error as _, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value};
use std::cell::Cell;
use std::fmt;

/// The most values that are kept of one file: a hundred for each of 20 000 materials.
const MAX_VALUES: usize = 1 << 21;

/// The lists of the file's top level. Their elements are as they stand in the file.
#[derive(Default)]
pub struct Root {
    pub asset: Value,
    pub extensions_required: Value,
    pub materials: Vec<Value>,
    pub textures: Vec<Value>,
    pub images: Vec<Value>,
    pub buffers: Vec<Value>,
    pub buffer_views: Vec<Value>,
    pub meshes: Vec<Value>,
}

impl Root {
    /// Reads the JSON; an error says why it is none, with line and column.
    pub fn parse(json: &str) -> Result<Self, String> {
        let mut reader = serde_json::Deserializer::from_str(json);
        let left = Cell::new(MAX_VALUES);
        let root = reader.deserialize_map(TopLevel(&left)).and_then(|root| reader.end().map(|()| root));
        root.map_err(|error| error.to_string())
    }
}

/// `list[index]`, or why there is none.
pub fn look_up<'a>(list: &'a [Value], index: &Value, name: &str) -> Result<(usize, &'a Value), String> {
    let number = index.as_u64().and_then(|index| usize::try_from(index).ok());
    let found = number.and_then(|index| Some((index, list.get(index)?)));
    found.ok_or_else(|| format!("there is no {name}[{index}], the file has {} of them", list.len()))
}

struct TopLevel<'a>(&'a Cell<usize>);

impl<'de> Visitor<'de> for TopLevel<'_> {
    type Value = Root;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Root, A::Error> {
        let mut root = Root::default();
        while let Some(key) = map.next_key::<String>()? {
            let (list, keys): (_, Option<&[_]>) = match key.as_str() {
                "materials" => (&mut root.materials, None),
                "textures" => (&mut root.textures, Some(&["source", "extensions", ANY])),
                "images" => (&mut root.images, Some(&["uri", "bufferView", "name"])),
                "buffers" => (&mut root.buffers, Some(&["uri"])),
                "bufferViews" => (&mut root.buffer_views, Some(&["buffer", "byteOffset", "byteLength"])),
                "meshes" => (&mut root.meshes, Some(&USES)),
                "asset" | "extensionsRequired" => {
                    let value = map.next_value_seed(Kept { keys: None, left: self.0 })?;
                    *(if key == "asset" { &mut root.asset } else { &mut root.extensions_required }) = value;
                    continue;
                }
                _ => {
                    map.next_value::<IgnoredAny>()?;
                    continue;
                }
            };
            *list = match map.next_value_seed(Kept { keys, left: self.0 })? {
                Value::Array(values) => values,
                Value::Null => Vec::new(),
                _ => return Err(A::Error::custom(format_args!("{key} is no list"))),
            };
        }
        Ok(root)
    }
}

/// Among a list's keys it stands for all.
const ANY: &str = "";

/// How meshes use materials.
const USES: [&str; 7] =
    ["primitives", "material", "attributes", "COLOR_0", "extensions", "KHR_materials_variants", "mappings"];

/// A value without `extras`, and without keys that nobody asks for.
struct Kept<'a> {
    /// The keys of objects, at every depth; `None`: all.
    keys: Option<&'static [&'static str]>,
    /// The number of values that may still be kept.
    left: &'a Cell<usize>,
}

impl<'de> DeserializeSeed<'de> for &Kept<'_> {
    type Value = Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Value, D::Error> {
        let left = self.left.get().checked_sub(1).ok_or_else(|| {
            D::Error::custom(format_args!("it has more than {MAX_VALUES} values that gonio would need"))
        })?;
        self.left.set(left);
        deserializer.deserialize_any(self)
    }
}

impl<'de> DeserializeSeed<'de> for Kept<'_> {
    type Value = Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Value, D::Error> {
        (&self).deserialize(deserializer)
    }
}

impl<'de> Visitor<'de> for &Kept<'_> {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_f64<E>(self, value: f64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_str<E>(self, value: &str) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_string<E>(self, value: String) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<Value, A::Error> {
        let mut values = Vec::new();
        while let Some(value) = sequence.next_element_seed(self)? {
            values.push(value);
        }
        Ok(Value::Array(values))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Value, A::Error> {
        let mut object = Map::new();
        while let Some(key) = map.next_key::<String>()? {
            let wanted = |keys: &[&str]| keys.contains(&ANY) || keys.contains(&key.as_str());
            if key == "extras" || !self.keys.is_none_or(wanted) {
                map.next_value::<IgnoredAny>()?;
            } else {
                object.insert(key, map.next_value_seed(self)?);
            }
        }
        Ok(Value::Object(object))
    }
}
