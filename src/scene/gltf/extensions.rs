//! What the extensions of a material mean for its BRDF.

use crate::base::error::{Error, Result};
use crate::model;
use crate::scene::FormulaInput;
use crate::scene::gltf::texels::Channel;
use crate::scene::gltf::{Texture, texture};
use ::gltf::json::{self, Root, Value};

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
    /// What of it the tables do not show.
    pub warnings: Vec<String>,
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
    pub name: &'static str,
    pub factor: f64,
    pub texture: Option<(Texture, Channel)>,
}

impl Extended {
    pub fn read(root: &Root, material: &json::Material) -> Result<Self> {
        let of = |name| Extension { name, root, value: on(material).find(|(n, _)| *n == name).map(|e| e.1) };
        let (specular, ior) = (of("KHR_materials_specular"), of("KHR_materials_ior").ior()?);
        let transmission = of("KHR_materials_transmission");
        let diffuse_transmission = of("KHR_materials_diffuse_transmission");
        let emissive = of("KHR_materials_emissive_strength").value.is_some();
        let mut warnings = Vec::new();
        let film = of("KHR_materials_iridescence").film(&mut warnings)?;
        let extended = Self {
            f0: specular.dielectric_f0(ior)?,
            specular: specular.strength("specular", "specularFactor", 1.0, "specularTexture")?,
            transmission: transmission.strength(
                "transmission",
                "transmissionFactor",
                0.0,
                "transmissionTexture",
            )?,
            diffuse_transmission: diffuse_transmission.strength(
                "diffuse_transmission",
                "diffuseTransmissionFactor",
                0.0,
                "diffuseTransmissionTexture",
            )?,
            strength: of("KHR_materials_anisotropy").anisotropy(&mut warnings)?,
            film,
            coat: of("KHR_materials_clearcoat").coat(material, &mut warnings)?,
            sheen: of("KHR_materials_sheen").sheen()?,
            diffuse_roughness: of("KHR_materials_diffuse_roughness").diffuse_roughness()?,
            left_out: emissive
                .then_some(("KHR_materials_emissive_strength", "what it emits is no reflection"))
                .into_iter()
                .collect(),
            warnings: Vec::new(),
        };
        let not = |(name, what)| format!("{name} is not modelled: {what}");
        let not_modelled = unmodelled(material).into_iter().map(not);
        let diffuse_varies = material.pbr_metallic_roughness.metallic_factor.0 < 1.0;
        if let Some(film) = &extended.film {
            warnings.extend(film.warnings(material, &extended, diffuse_varies));
        }
        Ok(Self { warnings: not_modelled.chain(warnings).collect(), ..extended })
    }
}

impl Film {
    /// What its tables do not show: F of a film is not linear in the F0 of what is below.
    fn warnings(&self, material: &json::Material, extended: &Extended, has_diffuse: bool) -> Vec<String> {
        const NAME: &str = "KHR_materials_iridescence";
        let pbr = &material.pbr_metallic_roughness;
        let mut warnings = Vec::new();
        let metal = pbr.metallic_factor.0 > 0.0 && pbr.base_color_texture.is_some();
        if metal || extended.f0.varies() || extended.specular.varies() {
            warnings.push(format!(
                "{NAME}: what is below the film varies; its tables are of the factors without their textures"
            ));
        }
        if has_diffuse || pbr.metallic_roughness_texture.is_some() {
            warnings.push(format!(
                "{NAME}: the diffuse lobe below the film has what is left without a film, not 1 − max F of the film"
            ));
        }
        warnings
    }
}

/// An extension of a material; `None`: the material has it not.
struct Extension<'a> {
    name: &'static str,
    root: &'a Root,
    value: Option<&'a Value>,
}

impl Extension<'_> {
    /// A number of a range.
    fn number(&self, key: &str, default: f64, range: [f64; 2]) -> Result<f64> {
        let Some(value) = self.value.and_then(|value| value.get(key)) else { return Ok(default) };
        self.checked(key, value, range)
    }

    fn checked(&self, key: &str, value: &Value, [low, high]: [f64; 2]) -> Result<f64> {
        let number = value.as_f64().filter(|number| (low..=high).contains(number));
        number.ok_or_else(|| {
            let value = crate::scene::gltf::printable(&value.to_string());
            let allowed =
                if high < f64::MAX { format!("in [{low}, {high}]") } else { format!("from {low} on") };
            Error::input(format!(
                "{}: {key} is {value}, which glTF does not allow; correct it to a number {allowed}",
                self.name
            ))
        })
    }

    /// R, G and B.
    fn color(&self, key: &str, default: f64, range: [f64; 2]) -> Result<[f64; 3]> {
        let Some(value) = self.value.and_then(|value| value.get(key)) else { return Ok([default; 3]) };
        let list = value.as_array().map(Vec::as_slice).unwrap_or_default();
        let [r, g, b] = list else {
            return Err(Error::input(format!(
                "{}: {key} is no list of three numbers; correct it",
                self.name
            )));
        };
        Ok([self.checked(key, r, range)?, self.checked(key, g, range)?, self.checked(key, b, range)?])
    }

    /// The texture of a key, looked up.
    fn texture(&self, key: &str) -> Result<Option<Texture>> {
        let Some(info) = self.value.and_then(|value| value.get(key)) else { return Ok(None) };
        let at = |e: Error| e.at(format!("{}.{key}", self.name));
        let index = info.get("index").and_then(index);
        let index = index.ok_or_else(|| at(Error::input("it has no index; export the file again")))?;
        texture(self.root, index).map(Some).map_err(at)
    }

    /// A factor in [0, 1] that a texture may multiply.
    fn strength(
        &self,
        name: &'static str,
        factor: &str,
        default: f64,
        texture: &str,
    ) -> Result<FormulaInput> {
        let value = self.number(factor, default, [0.0, 1.0])?;
        let varies = self.texture(texture)?.is_some() && value > 0.0;
        Ok(FormulaInput { name, value: [value; 3], least: varies.then_some(0.0) })
    }

    fn ior(&self) -> Result<f64> {
        match self.value.and_then(|value| value.get("ior")).map(|ior| ior.as_f64()) {
            Some(Some(0.0)) => Ok(0.0),
            _ => self.number("ior", 1.5, [1.0, f64::MAX]),
        }
    }

    /// min(((ior − 1)/(ior + 1))² specularColor, 1); an ior of 0 stands for ∞.
    fn dielectric_f0(&self, ior: f64) -> Result<FormulaInput> {
        let f0 = match ior {
            0.0 => 1.0,
            1.5 => 0.04,
            ior => ((ior - 1.0) / (ior + 1.0)).powi(2),
        };
        let color = self.color("specularColorFactor", 1.0, [0.0, f64::MAX])?;
        let value = color.map(|color| (f0 * color).min(1.0));
        let varies = self.texture("specularColorTexture")?.is_some() && value != [0.0; 3];
        Ok(FormulaInput { name: "dielectric_f0", value, least: varies.then_some(0.0) })
    }

    /// The strength, the largest where a texture has it.
    fn anisotropy(&self, warnings: &mut Vec<String>) -> Result<f64> {
        let strength = self.number("anisotropyStrength", 0.0, [0.0, 1.0])?;
        let rotation = self.number("anisotropyRotation", 0.0, [-f64::MAX, f64::MAX])?;
        let textured = self.texture("anisotropyTexture")?.is_some();
        let name = self.name;
        match (strength > 0.0, textured) {
            (false, _) => {}
            (true, true) => warnings.push(format!(
                "{name}: its texture varies strength and direction; the tables are of strength {strength}, and of \
                 azimuths from the texture's direction, turned by {rotation} rad"
            )),
            (true, false) if rotation != 0.0 => warnings.push(format!(
                "{name}: the tables' azimuths are from the direction of anisotropy: turn the tangent frame by \
                 anisotropyRotation, {rotation} rad"
            )),
            (true, false) => {}
        }
        Ok(strength)
    }

    /// The film, if it is there and we have it.
    fn film(&self, warnings: &mut Vec<String>) -> Result<Option<Film>> {
        const MOST: f64 = 2000.0;
        let factor = self.strength("iridescence", "iridescenceFactor", 0.0, "iridescenceTexture")?;
        let eta = self.number("iridescenceIor", 1.3, [1.0, f64::MAX])?;
        let least = self.number("iridescenceThicknessMinimum", 100.0, [0.0, f64::MAX])?;
        let most = self.number("iridescenceThicknessMaximum", 400.0, [0.0, f64::MAX])?;
        let textured = self.texture("iridescenceThicknessTexture")?.is_some();
        if factor.value == [0.0; 3] {
            return Ok(None);
        }
        let name = self.name;
        if textured && least != most {
            warnings.push(format!(
                "{name}: its texture varies the thickness from {least} to {most} nm; the tables are of {most} nm"
            ));
        }
        if most > MOST {
            warnings.push(format!("{name}: a film of {most} nm has no colour; the tables are of {MOST} nm"));
        }
        let film = Film { factor, thickness: most.min(MOST), eta };
        if let Some(why) = film.refused()? {
            warnings.push(format!("{name}: {why}; the film is left out of the tables"));
            return Ok(None);
        }
        Ok(Some(film))
    }

    fn coat(&self, material: &json::Material, warnings: &mut Vec<String>) -> Result<Option<Coat>> {
        let factor = self.strength("clearcoat", "clearcoatFactor", 0.0, "clearcoatTexture")?;
        let roughness =
            self.scaled(["clearcoatRoughnessFactor", "clearcoatRoughnessTexture"], Channel::Green)?;
        let own = self.texture("clearcoatNormalTexture")?.map(|texture| texture.index);
        if factor.value == [0.0; 3] {
            return Ok(None);
        }
        if own != material.normal_texture.as_ref().map(|info| info.index.value()) {
            warnings.push(format!(
                "{}: the coat's normal map is not that of what it coats; the tables are of one normal for both",
                self.name
            ));
        }
        Ok(Some(Coat { factor, roughness }))
    }

    fn sheen(&self) -> Result<Option<Sheen>> {
        let value = self.color("sheenColorFactor", 0.0, [0.0, 1.0])?;
        let varies = self.texture("sheenColorTexture")?.is_some();
        let roughness = self.scaled(["sheenRoughnessFactor", "sheenRoughnessTexture"], Channel::Alpha)?;
        let color = FormulaInput { name: "sheen_color", value, least: varies.then_some(0.0) };
        Ok((value != [0.0; 3]).then_some(Sheen { color, roughness }))
    }

    fn diffuse_roughness(&self) -> Result<Option<Scaled>> {
        let roughness = self.scaled(["diffuseRoughnessFactor", "diffuseRoughnessTexture"], Channel::Red)?;
        Ok((roughness.factor > 0.0).then_some(roughness))
    }

    fn scaled(&self, [factor, texture]: [&'static str; 2], channel: Channel) -> Result<Scaled> {
        let value = self.number(factor, 0.0, [0.0, 1.0])?;
        let texture_of = self.texture(texture)?.map(|texture| (texture, channel));
        Ok(Scaled { name: texture, factor: value, texture: texture_of })
    }
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

/// The extensions of a material, by name.
pub fn on(material: &json::Material) -> impl Iterator<Item = (&str, &Value)> {
    material.extensions.iter().flat_map(|e| &e.others).map(|(name, value)| (name.as_str(), value))
}

/// The extensions of a material that change its BRDF, or may, with what is missing in the tables.
fn unmodelled(material: &json::Material) -> Vec<(String, &'static str)> {
    let known = |name: &&str| HARMLESS.contains(name) || MODELLED.contains(name);
    let not_harmless = on(material).filter(|(name, _)| !known(name));
    not_harmless
        .filter_map(|(name, value)| match UNMODELLED.iter().find(|e| e.name == name) {
            Some(known) if known.is_idle(value) => None,
            Some(known) => Some((name.into(), known.effect)),
            None => Some((
                crate::scene::gltf::printable(name),
                "if it changes the BRDF, the tables do not show it",
            )),
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
