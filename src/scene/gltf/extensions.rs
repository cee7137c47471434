//! What the extensions of a material mean for its BRDF.

use ::gltf::json::{self, Value};

/// An extension that changes the BRDF and that gonio does not model.
struct Unmodelled {
    name: &'static str,
    /// What its absence does to the tables.
    effect: &'static str,
    /// It changes nothing where all of these have the value beside them, which is also their default.
    /// Exporters write such idle extensions often.
    idle: (&'static [&'static str], f64),
}

const UNMODELLED: &[Unmodelled] = &[
    Unmodelled {
        name: "KHR_materials_anisotropy",
        effect: "the tables are isotropic",
        idle: (&["anisotropyStrength"], 0.0),
    },
    Unmodelled {
        name: "KHR_materials_clearcoat",
        effect: "the coat is left out of the tables",
        idle: (&["clearcoatFactor"], 0.0),
    },
    Unmodelled {
        name: "KHR_materials_diffuse_transmission",
        effect: "what is transmitted stays in the diffuse reflection",
        idle: (&["diffuseTransmissionFactor"], 0.0),
    },
    Unmodelled {
        name: "KHR_materials_dispersion",
        effect: "the tables do not depend on wavelength",
        idle: (&["dispersion"], 0.0),
    },
    Unmodelled {
        name: "KHR_materials_ior",
        effect: "the dielectric F0 stays 0.04 (index 1.5)",
        idle: (&["ior"], 1.5),
    },
    Unmodelled {
        name: "KHR_materials_iridescence",
        effect: "the Fresnel term stays Schlick's",
        idle: (&["iridescenceFactor"], 0.0),
    },
    Unmodelled {
        name: "KHR_materials_pbrSpecularGlossiness",
        effect: "its metallic-roughness values are baked instead",
        idle: (&[], 0.0),
    },
    Unmodelled {
        name: "KHR_materials_sheen",
        effect: "the sheen is left out of the tables",
        idle: (&["sheenColorFactor"], 0.0),
    },
    Unmodelled {
        name: "KHR_materials_specular",
        effect: "the dielectric F0 stays 0.04 and F90 stays 1",
        // A texture is no number, so its presence is never idle.
        idle: (&["specularFactor", "specularColorFactor", "specularTexture", "specularColorTexture"], 1.0),
    },
    Unmodelled {
        name: "KHR_materials_transmission",
        effect: "what is transmitted stays in the diffuse reflection",
        idle: (&["transmissionFactor"], 0.0),
    },
    Unmodelled {
        name: "KHR_materials_volume",
        effect: "the tables are of its surface alone",
        idle: (&["thicknessFactor"], 0.0),
    },
];

/// Extensions that leave the BRDF as it is.
const HARMLESS: &[&str] =
    &["KHR_materials_emissive_strength", "KHR_materials_unlit", "KHR_xmp_json_ld", "KHR_animation_pointer"];

/// The extensions of a material, by name.
pub fn on(material: &json::Material) -> impl Iterator<Item = (&str, &Value)> {
    material.extensions.iter().flat_map(|e| &e.others).map(|(name, value)| (name.as_str(), value))
}

/// The extensions of a material that change its BRDF, or may, with what is missing in the tables.
pub fn unmodelled(material: &json::Material) -> Vec<(String, &'static str)> {
    let not_harmless = on(material).filter(|(name, _)| !HARMLESS.contains(name));
    not_harmless
        .filter_map(|(name, value)| match UNMODELLED.iter().find(|e| e.name == name) {
            Some(known) if known.is_idle(value) => None,
            Some(known) => Some((name.into(), known.effect)),
            None => Some((super::printable(name), "if it changes the BRDF, the tables do not show it")),
        })
        .collect()
}

impl Unmodelled {
    fn is_idle(&self, extension: &Value) -> bool {
        let (keys, neutral) = self.idle;
        let is_neutral = |value: &Value| value.as_f64() == Some(neutral);
        !keys.is_empty()
            && keys.iter().all(|key| match extension.get(key) {
                None => true,
                Some(Value::Array(values)) => values.iter().all(is_neutral),
                Some(value) => is_neutral(value),
            })
    }
}

/// The materials that KHR_materials_variants can put on a primitive.
pub fn variant_materials(on: &json::extensions::mesh::Primitive) -> impl Iterator<Item = usize> {
    let mappings = on.others.get("KHR_materials_variants").and_then(|v| v.get("mappings")?.as_array());
    mappings.into_iter().flatten().filter_map(|mapping| index(mapping.get("material")?))
}

/// The image that an extension (KHR_texture_basisu, EXT_texture_webp, …) gives a texture.
pub fn texture_source(on: &json::extensions::texture::Texture) -> Option<usize> {
    on.others.values().find_map(|extension| index(extension.get("source")?))
}

/// An index as it stands; one beyond usize is out of any list's range all the same.
fn index(value: &Value) -> Option<usize> {
    value.as_u64().map(|index| usize::try_from(index).unwrap_or(usize::MAX))
}
