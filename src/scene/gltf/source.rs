//! A material of the file: its numbers, and the ranges that its textures leave of them.

use crate::base::error::Result;
use crate::scene::gltf::extensions::{Extended, Scaled};
use crate::scene::gltf::fields::{Fields, Texture};
use crate::scene::gltf::file::{GltfFile, Images};
use crate::scene::gltf::layers::Layers;
use crate::scene::gltf::root::Root;
use crate::scene::gltf::texels::{Channel, Texels};
use crate::scene::{Distribution, FormulaInput, LeftOut, Material, Scene};
use serde_json::Value;
use std::cell::RefCell;

/// A material of the file, with its numbers checked and its textures looked up, not yet decoded.
pub struct MaterialSource {
    name: String,
    base_color: FormulaInput,
    metallic: f64,
    roughness: f64,
    texture: Option<Texture>,
    extended: Extended,
}

impl MaterialSource {
    /// Reads the numbers of a material. The warnings are of what is corrected, and of what the tables do not show.
    ///
    /// # Errors
    /// When one of them is no number: what its author meant is then unknown.
    pub fn check(
        root: &Root,
        material: &Value,
        name: &str,
        vertex_colors: bool,
        warnings: &RefCell<Vec<String>>,
    ) -> Result<Self> {
        Fields::new("it", root, material, warnings)?;
        Fields::new("extensions", root, &material["extensions"], warnings)?;
        let pbr = Fields::new("pbrMetallicRoughness", root, &material["pbrMetallicRoughness"], warnings)?;
        let pbr = pbr.nameless();
        let unit = |key| pbr.number(key, 1.0, [0.0, 1.0]).map(|x| exact(x as f32));
        let value = pbr.color("baseColorFactor", 1.0, [0.0, 1.0])?.map(|x| exact(x as f32));
        // Black stays black.
        let base_color_varies = (pbr.is_textured("baseColorTexture") || vertex_colors) && value != [0.0; 3];
        Ok(Self {
            name: name.into(),
            base_color: FormulaInput { name: "base_color", value, least: base_color_varies.then_some(0.0) },
            metallic: unit("metallicFactor")?,
            roughness: unit("roughnessFactor")?,
            texture: pbr.texture("metallicRoughnessTexture"),
            extended: Extended::read(root, material, &pbr, warnings)?,
        })
    }

    /// The images whose texels decide this material's ranges; none where the factors leave them no say.
    pub fn images(&self) -> impl Iterator<Item = usize> {
        let matters = self.roughness > 0.0 || self.metallic > 0.0;
        let own = self.texture.iter().filter(move |_| matters);
        let scaled = self.scaled().filter_map(|scaled| scaled.needs()).map(|(texture, _)| texture);
        own.chain(scaled).filter_map(|texture| texture.image.clone().ok())
    }

    /// The roughnesses of its extensions.
    fn scaled(&self) -> impl Iterator<Item = &Scaled> {
        let Extended { coat, sheen, diffuse_roughness, .. } = &self.extended;
        let coat = coat.iter().map(|coat| &coat.roughness);
        coat.chain(sheen.iter().map(|sheen| &sheen.roughness)).chain(diffuse_roughness)
    }

    pub fn read(&self, file: &GltfFile, images: &Images, scene: &mut Scene) -> Material {
        let mut warn = |what: &str, (label, why): (String, String), ranges: String| {
            scene.warnings.push(format!(
                "material {}: {what} {label}: {why}; {ranges}; give a whole PNG or JPEG for tables that fit",
                self.name
            ));
        };
        let (roughness, [least, most]) = match &self.texture {
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
                Ok(texels) => texels.roughness(*channel, scaled.factor),
                Err(why) => {
                    let ranges = format!("{what} is taken over all of [0, {}]", scaled.factor);
                    warn(&scaled.name, why, ranges);
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
    fn needs(&self) -> Option<&(Texture, Channel)> {
        self.texture.as_ref().filter(|_| self.factor > 0.0)
    }
}

/// The shortest decimal that gives this f32 is what the file says: 0.3, not 0.30000001192….
fn exact(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(f64::from(value))
}

/// What an image holds; else what it is called and why it cannot be read.
fn texels<'a>(
    texture: &Texture,
    file: &GltfFile,
    images: &'a Images,
) -> Result<&'a Texels, (String, String)> {
    let image = match &texture.image {
        Ok(image) => *image,
        Err(why) => return Err((format!("textures[{}]", texture.index), why.clone())),
    };
    match images.get(&image).map(|image| &**image) {
        Some(Ok(texels)) => Ok(texels),
        Some(Err(why)) => Err((file.image_label(image), why.clone())),
        None => Err((file.image_label(image), "it was not read".into())),
    }
}
