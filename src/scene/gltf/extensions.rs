//! What the extensions of a material mean for its BRDF.

use crate::base::error::Result;
use crate::model;
use crate::scene::FormulaInput;
use crate::scene::gltf::fields::{Fields, Texture};
use crate::scene::gltf::printable;
use crate::scene::gltf::root::Root;
use crate::scene::gltf::texels::Channel;
use serde_json::Value;
use std::cell::RefCell;

/// What the extensions of a material say of its reflection, with defaults for those that it has not.
pub struct Extended {
    /// F0 of the dielectric without `specular`: `dielectric_f0`.
    pub f0: FormulaInput,
    /// The strength of the dielectric's reflection, which is its F90.
    pub specular: FormulaInput,
    pub transmission: FormulaInput,
    pub diffuse_transmission: FormulaInput,
    /// The strength of anisotropy.
    pub strength: f64,
    pub film: Option<Film>,
    pub coat: Option<Coat>,
    pub sheen: Option<Sheen>,
    pub diffuse_roughness: Option<Scaled>,
    /// What it has beside reflection.
    pub left_out: Vec<(&'static str, &'static str)>,
}

/// KHR_materials_iridescence.
pub struct Film {
    pub factor: FormulaInput,
    /// nm
    pub thickness: f64,
    pub eta: f64,
}

/// KHR_materials_clearcoat.
pub struct Coat {
    pub factor: FormulaInput,
    pub roughness: Scaled,
}

/// KHR_materials_sheen.
pub struct Sheen {
    pub color: FormulaInput,
    pub roughness: Scaled,
}

/// A roughness that a channel of a texture may multiply.
pub struct Scaled {
    /// What messages call it.
    pub name: String,
    pub factor: f64,
    pub texture: Option<(Texture, Channel)>,
}

impl Extended {
    /// `base` is the material's `pbrMetallicRoughness`.
    pub fn read(
        root: &Root,
        material: &Value,
        base: &Fields,
        warnings: &RefCell<Vec<String>>,
    ) -> Result<Self> {
        let none = Value::Null;
        let extension = |name: &str| {
            let value = on(material).find(|(known, _)| *known == name).map_or(&none, |(_, value)| value);
            Fields::new(name, root, value, warnings)
        };
        for (name, what) in unmodelled(material) {
            warnings.borrow_mut().push(format!("{name} is not modelled: {what}"));
        }
        let film = film(&extension("KHR_materials_iridescence")?)?;
        let specular = extension("KHR_materials_specular")?;
        let ior = ior(&extension("KHR_materials_ior")?)?;
        let transmission = extension("KHR_materials_transmission")?;
        let diffuse_transmission = extension("KHR_materials_diffuse_transmission")?;
        let emissive = extension("KHR_materials_emissive_strength")?.is_there();
        let extended = Self {
            f0: dielectric_f0(&specular, ior)?,
            specular: strength(&specular, "specular", "specularFactor", 1.0, "specularTexture")?,
            transmission: strength(
                &transmission,
                "transmission",
                "transmissionFactor",
                0.0,
                "transmissionTexture",
            )?,
            diffuse_transmission: strength(
                &diffuse_transmission,
                "diffuse_transmission",
                "diffuseTransmissionFactor",
                0.0,
                "diffuseTransmissionTexture",
            )?,
            strength: anisotropy(&extension("KHR_materials_anisotropy")?)?,
            film,
            coat: coat(&extension("KHR_materials_clearcoat")?, material)?,
            sheen: sheen(&extension("KHR_materials_sheen")?)?,
            diffuse_roughness: diffuse_roughness(&extension("KHR_materials_diffuse_roughness")?)?,
            left_out: emissive
                .then_some(("KHR_materials_emissive_strength", "what it emits is no reflection"))
                .into_iter()
                .collect(),
        };
        if let Some(film) = &extended.film {
            film.warn(base, &extended, warnings)?;
        }
        Ok(extended)
    }
}

impl Film {
    /// Warns of what its tables do not show: F of a film is not linear in the F0 of what is below.
    fn warn(&self, base: &Fields, extended: &Extended, warnings: &RefCell<Vec<String>>) -> Result<()> {
        const NAME: &str = "KHR_materials_iridescence";
        let metallic = base.get("metallicFactor").and_then(Value::as_f64).unwrap_or(1.0);
        let metal = metallic > 0.0 && base.get("baseColorTexture").is_some();
        let mut warnings = warnings.borrow_mut();
        if metal || extended.f0.varies() || extended.specular.varies() {
            warnings.push(format!(
                "{NAME}: what is below the film varies; its tables are of the factors without their textures"
            ));
        }
        if metallic < 1.0 || base.get("metallicRoughnessTexture").is_some() {
            warnings.push(format!(
                "{NAME}: the diffuse lobe below the film has what is left without a film, not 1 − max F of the film"
            ));
        }
        Ok(())
    }
}

/// A factor in [0, 1] that a texture may multiply.
fn strength(
    fields: &Fields,
    name: &'static str,
    factor: &str,
    default: f64,
    texture: &str,
) -> Result<FormulaInput> {
    let value = fields.number(factor, default, [0.0, 1.0])?;
    let varies = fields.is_textured(texture) && value > 0.0;
    Ok(FormulaInput { name, value: [value; 3], least: varies.then_some(0.0) })
}

fn ior(fields: &Fields) -> Result<f64> {
    match fields.get("ior").and_then(Value::as_f64) {
        Some(0.0) => Ok(0.0),
        _ => fields.number("ior", 1.5, [1.0, f64::MAX]),
    }
}

/// min(((ior − 1)/(ior + 1))² specularColor, 1); an ior of 0 stands for ∞.
fn dielectric_f0(specular: &Fields, ior: f64) -> Result<FormulaInput> {
    let f0 = match ior {
        0.0 => 1.0,
        1.5 => 0.04,
        ior => ((ior - 1.0) / (ior + 1.0)).powi(2),
    };
    let color = specular.color("specularColorFactor", 1.0, [0.0, f64::MAX])?;
    let value = color.map(|color| (f0 * color).min(1.0));
    let varies = specular.is_textured("specularColorTexture") && value != [0.0; 3];
    Ok(FormulaInput { name: "dielectric_f0", value, least: varies.then_some(0.0) })
}

/// The strength of anisotropy, the largest where a texture has it.
fn anisotropy(fields: &Fields) -> Result<f64> {
    let strength = fields.number("anisotropyStrength", 0.0, [0.0, 1.0])?;
    let rotation = fields.number("anisotropyRotation", 0.0, [-f64::MAX, f64::MAX])?;
    let textured = fields.is_textured("anisotropyTexture");
    let say = |what: String| fields.warn(format!("KHR_materials_anisotropy: {what}"));
    match (strength > 0.0, textured) {
        (false, _) => {}
        (true, true) => say(format!(
            "its texture varies strength and direction; the tables are of strength {strength}, and of \
             azimuths from the texture's direction, turned by {rotation} rad"
        )),
        (true, false) if rotation != 0.0 => say(format!(
            "the tables' azimuths are from the direction of anisotropy: turn the tangent frame by \
             anisotropyRotation, {rotation} rad"
        )),
        (true, false) => {}
    }
    Ok(strength)
}

/// The film, if it is there and we have it.
fn film(fields: &Fields) -> Result<Option<Film>> {
    const MOST: f64 = 2000.0;
    let factor = strength(fields, "iridescence", "iridescenceFactor", 0.0, "iridescenceTexture")?;
    let eta = fields.number("iridescenceIor", 1.3, [1.0, f64::MAX])?;
    let least = fields.number("iridescenceThicknessMinimum", 100.0, [0.0, f64::MAX])?;
    let most = fields.number("iridescenceThicknessMaximum", 400.0, [0.0, f64::MAX])?;
    let textured = fields.is_textured("iridescenceThicknessTexture");
    if factor.value == [0.0; 3] {
        return Ok(None);
    }
    let say = |what: String| fields.warn(format!("KHR_materials_iridescence: {what}"));
    if textured && least != most {
        say(format!(
            "its texture varies the thickness from {least} to {most} nm; the tables are of {most} nm"
        ));
    }
    if most > MOST {
        say(format!("a film of {most} nm has no colour; the tables are of {MOST} nm"));
    }
    let film = Film { factor, thickness: most.min(MOST), eta };
    if let Some(why) = film.refused()? {
        say(format!("{why}; the film is left out of the tables"));
        return Ok(None);
    }
    Ok(Some(film))
}

fn coat(fields: &Fields, material: &Value) -> Result<Option<Coat>> {
    let factor = strength(fields, "clearcoat", "clearcoatFactor", 0.0, "clearcoatTexture")?;
    let roughness =
        scaled(fields, ["clearcoatRoughnessFactor", "clearcoatRoughnessTexture"], Channel::Green)?;
    if factor.value == [0.0; 3] {
        return Ok(None);
    }
    let own = fields.get("clearcoatNormalTexture").map(|texture| &texture["index"]);
    if own != material.get("normalTexture").map(|texture| &texture["index"]) {
        fields.warn(
            "KHR_materials_clearcoat: the coat's normal map is not that of what it coats; the tables are of one \
             normal for both"
                .into(),
        );
    }
    Ok(Some(Coat { factor, roughness }))
}

fn sheen(fields: &Fields) -> Result<Option<Sheen>> {
    let value = fields.color("sheenColorFactor", 0.0, [0.0, 1.0])?;
    let varies = fields.is_textured("sheenColorTexture");
    let roughness = scaled(fields, ["sheenRoughnessFactor", "sheenRoughnessTexture"], Channel::Alpha)?;
    let color = FormulaInput { name: "sheen_color", value, least: varies.then_some(0.0) };
    Ok((value != [0.0; 3]).then_some(Sheen { color, roughness }))
}

fn diffuse_roughness(fields: &Fields) -> Result<Option<Scaled>> {
    let roughness = scaled(fields, ["diffuseRoughnessFactor", "diffuseRoughnessTexture"], Channel::Red)?;
    Ok((roughness.factor > 0.0).then_some(roughness))
}

fn scaled(fields: &Fields, [factor, texture]: [&str; 2], channel: Channel) -> Result<Scaled> {
    let factor = fields.number(factor, 0.0, [0.0, 1.0])?;
    let of = fields.texture(texture).map(|texture| (texture, channel));
    Ok(Scaled { name: fields.name(texture), factor, texture: of })
}

impl Film {
    /// Why our model has no such film, if it has none.
    fn refused(&self) -> Result<Option<String>> {
        let model = model::find("ggx")?.with_terms(None, Some("thin-film"))?;
        let mut parameters = model.defaults();
        for (name, value) in [("thickness", self.thickness), ("film_eta", self.eta)] {
            let parameter = model.parameters.iter().find(|parameter| parameter.name == name);
            let Some(parameter) = parameter else { continue };
            let [low, high] = parameter.range;
            if !(low..=high).contains(&value) {
                return Ok(Some(format!("its {name} of {value} is outside [{low}, {high}]")));
            }
            parameters[parameter.place] = value;
        }
        Ok(model.refused(&parameters).map(Into::into))
    }
}

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
        name: "KHR_materials_diffuse_transmission",
        effect: "the tables are of reflection alone, of which it takes its share",
        idle: (&["diffuseTransmissionFactor"], 0.0),
    },
    Unmodelled {
        name: "KHR_materials_dispersion",
        effect: "the tables do not depend on wavelength",
        idle: (&["dispersion"], 0.0),
    },
    Unmodelled {
        name: "KHR_materials_pbrSpecularGlossiness",
        effect: "its metallic-roughness values are baked instead",
        idle: (&[], 0.0),
    },
    Unmodelled {
        name: "KHR_materials_transmission",
        effect: "the tables are of reflection alone, of which it takes its share",
        idle: (&["transmissionFactor"], 0.0),
    },
    Unmodelled {
        name: "KHR_materials_volume",
        effect: "the tables are of its surface alone",
        idle: (&["thicknessFactor"], 0.0),
    },
];

/// What this file reads, beside what it only warns of.
const MODELLED: &[&str] = &[
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_roughness",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
    "KHR_materials_specular",
];

/// Extensions that leave the BRDF as it is.
const HARMLESS: &[&str] =
    &["KHR_materials_emissive_strength", "KHR_materials_unlit", "KHR_xmp_json_ld", "KHR_animation_pointer"];

/// Extensions that textures, meshes and nodes may require and that leave every material as it is.
const BESIDE_MATERIALS: &[&str] = &[
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_avif",
    "EXT_texture_webp",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_variants",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_node_visibility",
    "KHR_texture_basisu",
    "KHR_texture_transform",
    "MSFT_texture_dds",
];

/// Warnings of what the file says that its readers must know, and gonio does not.
pub fn required(root: &Root) -> Vec<String> {
    let listed = root.extensions_required.as_array().into_iter().flatten().filter_map(Value::as_str);
    let is_known = |name: &str| {
        let known = [MODELLED, HARMLESS, BESIDE_MATERIALS];
        known.iter().any(|list| list.contains(&name)) || UNMODELLED.iter().any(|e| e.name == name)
    };
    let unknown = listed.filter(|name| !is_known(name)).map(|name| {
        let name = printable(name);
        format!("the file requires {name}, which gonio does not know; if it changes a BRDF, the tables do not show it")
    });
    let version = root.asset["minVersion"].as_str().filter(|version| {
        let mut numbers = version.split('.').map(str::parse::<u32>);
        !matches!((numbers.next(), numbers.next()), (Some(Ok(0..=1)), _) | (Some(Ok(2)), None | Some(Ok(0))))
    });
    let newer = version.map(|version| {
        let version = printable(version);
        format!("asset.minVersion is {version}, and gonio reads glTF 2.0: what is new since then is not in the tables")
    });
    newer.into_iter().chain(unknown).collect()
}

/// The extensions of a material, by name.
pub fn on(material: &Value) -> impl Iterator<Item = (&str, &Value)> {
    let extensions = material["extensions"].as_object().into_iter().flatten();
    extensions.map(|(name, value)| (name.as_str(), value))
}

/// The extensions of a material that change its BRDF, or may, with what is missing in the tables.
fn unmodelled(material: &Value) -> Vec<(String, &'static str)> {
    let known = |name: &&str| HARMLESS.contains(name) || MODELLED.contains(name);
    let not_harmless = on(material).filter(|(name, _)| !known(name));
    not_harmless
        .filter_map(|(name, value)| match UNMODELLED.iter().find(|e| e.name == name) {
            Some(known) if known.is_idle(value) => None,
            Some(known) => Some((name.into(), known.effect)),
            None => Some((printable(name), "if it changes the BRDF, the tables do not show it")),
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
