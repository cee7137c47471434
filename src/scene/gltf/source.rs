//! A material of the file: its numbers, and the ranges that its textures leave of them.

use crate::base::error::Result;
use crate::scene::gltf::extensions::{Extended, Scaled};
use crate::scene::gltf::file::GltfFile;
use crate::scene::gltf::layers::Layers;
use crate::scene::gltf::texels::{Channel, Texels};
use crate::scene::gltf::{Texture, texture, unit};
use crate::scene::{Distribution, FormulaInput, LeftOut, Material, Scene};
use ::gltf::json::{self, Root};
use std::collections::BTreeMap;

/// A material of the file, with its numbers checked and its textures looked up, not yet decoded.
pub struct MaterialSource {
    name: String,
    base_color: FormulaInput,
    metallic: f64,
    roughness: f64,
    texture: Option<Texture>,
    extended: Extended,
}

/// Decoded images, by index; what cannot be read says why.
type Images = BTreeMap<usize, Result<Texels, String>>;

impl MaterialSource {
    pub fn check(root: &Root, material: &json::Material, name: &str, vertex_colors: bool) -> Result<Self> {
        let pbr = &material.pbr_metallic_roughness;
        let [r, g, b, _] = pbr.base_color_factor.0.map(exact);
        if let Some(info) = &pbr.base_color_texture {
            texture(root, info.index.value()).map_err(|e| e.at("baseColorTexture"))?;
        }
        let metallic_roughness = pbr.metallic_roughness_texture.as_ref();
        let value =
            [unit("baseColorFactor[0]", r)?, unit("baseColorFactor[1]", g)?, unit("baseColorFactor[2]", b)?];
        // Black stays black.
        let base_color_varies = (pbr.base_color_texture.is_some() || vertex_colors) && value != [0.0; 3];
        Ok(Self {
            name: name.into(),
            base_color: FormulaInput { name: "base_color", value, least: base_color_varies.then_some(0.0) },
            metallic: unit("metallicFactor", exact(pbr.metallic_factor.0))?,
            roughness: unit("roughnessFactor", exact(pbr.roughness_factor.0))?,
            texture: metallic_roughness
                .map(|info| texture(root, info.index.value()).map_err(|e| e.at("metallicRoughnessTexture")))
                .transpose()?,
            extended: Extended::read(root, material)?,
        })
    }

    /// The images whose texels decide this material's ranges; none where the factors leave them no say.
    pub fn images(&self) -> impl Iterator<Item = usize> {
        let matters = self.roughness > 0.0 || self.metallic > 0.0;
        let own = self.texture.filter(|_| matters);
        let scaled = self.scaled().filter_map(|scaled| scaled.needs()).map(|(texture, _)| texture);
        own.into_iter().chain(scaled).filter_map(|texture| texture.image)
    }

    /// The roughnesses of its extensions.
    fn scaled(&self) -> impl Iterator<Item = &Scaled> {
        let Extended { coat, sheen, diffuse_roughness, .. } = &self.extended;
        let coat = coat.iter().map(|coat| &coat.roughness);
        coat.chain(sheen.iter().map(|sheen| &sheen.roughness)).chain(diffuse_roughness)
    }

    /// What of its extensions the tables do not show.
    pub fn warnings(&self) -> impl Iterator<Item = String> {
        self.extended.warnings.iter().map(|warning| format!("material {}: {warning}", self.name))
    }

    pub fn read(&self, file: &GltfFile, images: &Images, scene: &mut Scene) -> Material {
        let mut warn = |what: &str, (label, why): (String, String), ranges: String| {
            scene.warnings.push(format!(
                "material {}: {what} {label}: {why}; {ranges}; give a PNG or JPEG for tables that fit",
                self.name
            ));
        };
        let (roughness, [least, most]) = match self.texture {
            None => (Distribution::constant(self.roughness), [self.metallic; 2]),
            Some(_) if self.roughness == 0.0 && self.metallic == 0.0 => {
                (Distribution::constant(0.0), [0.0; 2])
            }
            Some(texture) => match texels(texture, file, images) {
                Ok(texels) => {
                    (texels.roughness(Channel::Green, self.roughness), texels.metallic(self.metallic))
                }
                Err(why) => {
                    let ranges = format!(
                        "roughness is taken over all of [0, {}] and metalness over [0, {}]",
                        self.roughness, self.metallic
                    );
                    warn("metallicRoughnessTexture", why, ranges);
                    (Distribution::uniform(0.0, self.roughness), [0.0, self.metallic])
                }
            },
        };
        let mut scaled = |what: &str, scaled: &Scaled| match scaled.needs() {
            None => Distribution::constant(scaled.factor),
            Some((texture, channel)) => match texels(texture, file, images) {
                Ok(texels) => texels.roughness(channel, scaled.factor),
                Err(why) => {
                    let ranges = format!("{what} is taken over all of [0, {}]", scaled.factor);
                    warn(scaled.name, why, ranges);
                    Distribution::uniform(0.0, scaled.factor)
                }
            },
        };
        let Extended { coat, sheen, diffuse_roughness, .. } = &self.extended;
        let coat_roughness = coat.as_ref().map(|coat| scaled("the coat's roughness", &coat.roughness));
        let sheen_roughness = sheen.as_ref().map(|sheen| scaled("the sheen's roughness", &sheen.roughness));
        let diffuse_roughness = diffuse_roughness.as_ref().map(|of| scaled("the diffuse roughness", of));
        let metallic =
            FormulaInput { name: "metallic", value: [most; 3], least: (least < most).then_some(least) };
        let layers = Layers {
            base_color: &self.base_color,
            metallic: &metallic,
            roughness,
            coat_roughness,
            sheen_roughness,
            diffuse_roughness,
            extended: &self.extended,
        };
        let (lobes, nothing) = layers.lobes();
        scene.left_out.extend(
            nothing.into_iter().map(|(lobe, why)| LeftOut {
                what: format!("the lobe {lobe} of material {}", self.name),
                why,
            }),
        );
        let emitted = self.extended.left_out.iter().map(|(what, why)| LeftOut {
            what: format!("{what} of material {}", self.name),
            why: (*why).into(),
        });
        scene.left_out.extend(emitted);
        Material {
            name: self.name.clone(),
            lobes,
            metallic: Some([least, most]),
            base_color: Some(self.base_color.range()),
        }
    }
}

impl Scaled {
    /// The texture, where the factor leaves it a say.
    fn needs(&self) -> Option<(Texture, Channel)> {
        self.texture.filter(|_| self.factor > 0.0)
    }
}

/// The shortest decimal that gives this f32 is what the file says: 0.3, not 0.30000001192….
fn exact(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(f64::from(value))
}

/// What an image holds; else what it is called and why it cannot be read.
fn texels<'a>(texture: Texture, file: &GltfFile, images: &'a Images) -> Result<&'a Texels, (String, String)> {
    let Texture { index, image } = texture;
    match image.map(|i| (i, images.get(&i))) {
        Some((_, Some(Ok(texels)))) => Ok(texels),
        Some((i, Some(Err(why)))) => Err((file.image_label(i), why.clone())),
        Some((i, None)) => Err((file.image_label(i), "it was not read".into())),
        None => Err((format!("textures[{index}]"), "it names no image".into())),
    }
}
