//! glTF 2.0: what the metallic-roughness materials of a scene really take, factors times texels.
//!
//! With base colour c and metalness m (glTF 2.0, Appendix B; Fc = (1 − ωi·ωm)⁵):
//!
//! f = 0.96 (1 − m) c · (1 − Fc)/π + (0.04 (1 − m) + m c) · A + B
//!
//! so that a material is at most two lobes, `gltf_diffuse` and `ggx`. Geometry is not read; only
//! which materials it uses.

mod extensions;
mod file;
mod texels;

use super::{Distribution, LeftOut, Material, MaterialLobe, Scene, Weights, metallic_roughness};
use crate::error::{Error, Result};
use crate::factor::Compensation;
use ::gltf::json::{self, Root};
use file::GltfFile;
use std::collections::{BTreeMap, HashSet};
use std::path::Path;
use texels::Texels;

/// Reads a `.gltf` or a `.glb`.
pub(super) fn read(path: &Path) -> Result<Scene> {
    let file = GltfFile::open(path)?;
    let mut scene = Scene { file: path.to_owned(), ..Scene::default() };
    let sources = sources(&file.root, &mut scene).map_err(|e| e.at(path.display()))?;
    let texels = file.texels(sources.iter().filter_map(Source::image).collect());
    for source in &sources {
        scene.warnings.extend(source.extension_warnings());
        let material = source.read(&file, &texels, &mut scene);
        scene.materials.push(material);
    }
    Ok(scene)
}

/// The materials to bake, checked: those that a mesh uses, or all where the file has no mesh.
fn sources(root: &Root, scene: &mut Scene) -> Result<Vec<Source>> {
    check_nodes(root)?;
    let names = unique_names(root);
    let users = users(root)?;
    let mut sources = Vec::new();
    for (index, (material, name)) in root.materials.iter().zip(&names).enumerate() {
        let what = || format!("material {name}");
        let user = users.get(&Some(index));
        if user.is_none() && !users.is_empty() {
            scene.left_out.push(LeftOut { what: what(), why: "no mesh uses it".into() });
        } else if extensions::on(material).any(|(extension, _)| extension == "KHR_materials_unlit") {
            let why = "KHR_materials_unlit: it shows its base colour as it is and reflects nothing";
            scene.left_out.push(LeftOut { what: what(), why: why.into() });
        } else {
            let place = format!("materials[{index}] ({name})");
            let vertex_colors = user.is_some_and(|u| u.vertex_colors);
            sources.push(Source::check(root, material, name, vertex_colors).map_err(|e| e.at(place))?);
        }
    }
    if let Some(user) = users.get(&None) {
        let name = unused_name(&names.into_iter().collect(), "default".into(), "_gltf");
        sources.push(Source::check(root, &json::Material::default(), &name, user.vertex_colors)?);
    }
    if root.materials.is_empty() && users.is_empty() {
        return Err(Error::input("it has neither a material nor a mesh; nothing in it can be baked"));
    }
    Ok(sources)
}

/// glTF's nodes form trees. Nothing here walks them, but a file in which they form a ring is
/// broken, and saying so beats baking half of what its author meant.
fn check_nodes(root: &Root) -> Result<()> {
    let children = |node: usize| {
        let list = root.nodes.get(node).and_then(|n| n.children.as_deref());
        list.unwrap_or_default().iter().map(|child| child.value())
    };
    let mut parents = vec![0_usize; root.nodes.len()];
    for node in 0..root.nodes.len() {
        for child in children(node) {
            look_up(&root.nodes, child, "nodes").map_err(|e| e.at(format!("nodes[{node}].children")))?;
            parents[child] += 1;
        }
    }
    // Take parentless nodes away until none is left; what stays hangs on a ring.
    let mut free: Vec<_> = (0..parents.len()).filter(|&node| parents[node] == 0).collect();
    while let Some(node) = free.pop() {
        for child in children(node) {
            parents[child] -= 1;
            if parents[child] == 0 {
                free.push(child);
            }
        }
    }
    match parents.iter().position(|&count| count > 0) {
        Some(node) => Err(Error::input(format!(
            "nodes[{node}] is its own ancestor, or hangs on a node that is; export the scene again"
        ))),
        None => Ok(()),
    }
}

/// How meshes use a material.
#[derive(Default)]
struct User {
    /// Whether a primitive multiplies the base colour by COLOR_0.
    vertex_colors: bool,
}

/// The materials that primitives use, by index; `None` is glTF's default material. A material that
/// only a variant selects is used too.
fn users(root: &Root) -> Result<BTreeMap<Option<usize>, User>> {
    const COLOR_0: json::validation::Checked<json::mesh::Semantic> =
        json::validation::Checked::Valid(json::mesh::Semantic::Colors(0));
    let mut users: BTreeMap<_, User> = BTreeMap::new();
    for (m, mesh) in root.meshes.iter().enumerate() {
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let variants = primitive.extensions.iter().flat_map(extensions::variant_materials).map(Some);
            for index in std::iter::once(primitive.material.map(|i| i.value())).chain(variants) {
                if let Some(index) = index {
                    look_up(&root.materials, index, "materials")
                        .map_err(|e| e.at(format!("meshes[{m}].primitives[{p}].material")))?;
                }
                let user = users.entry(index).or_default();
                user.vertex_colors |= primitive.attributes.contains_key(&COLOR_0);
            }
        }
    }
    Ok(users)
}

/// A name for each material of the file: its own, `material_3` where it has none, and with its index
/// behind it where another has the same.
fn unique_names(root: &Root) -> Vec<String> {
    let mut taken = HashSet::new();
    let mut names = Vec::new();
    for (index, material) in root.materials.iter().enumerate() {
        let name = material.name.as_deref().map(printable).filter(|name| !name.is_empty());
        let name = name.unwrap_or_else(|| format!("material_{index}"));
        let name = unused_name(&taken, name, &format!("_{index}"));
        taken.insert(name.clone());
        names.push(name);
    }
    names
}

fn unused_name(taken: &HashSet<String>, mut name: String, suffix: &str) -> String {
    while taken.contains(&name) {
        name.push_str(suffix);
    }
    name
}

/// Without control characters: names are printed on terminals.
fn printable(text: &str) -> String {
    text.trim().chars().map(|c| if c.is_control() { '_' } else { c }).collect()
}

/// A material of the file, with its numbers checked and its texture looked up, not yet decoded.
struct Source {
    name: String,
    base_color: [f64; 3],
    /// A texture or vertex colours multiply the base colour.
    base_color_varies: bool,
    metallic: f64,
    roughness: f64,
    texture: Option<Texture>,
    /// Extensions that change the BRDF and that gonio does not model, and what that means.
    unmodelled: Vec<(String, &'static str)>,
}

/// What stands behind a metallicRoughnessTexture.
#[derive(Clone, Copy)]
struct Texture {
    index: usize,
    /// `None`: the texture names no image.
    image: Option<usize>,
}

impl Source {
    fn check(root: &Root, material: &json::Material, name: &str, vertex_colors: bool) -> Result<Self> {
        let pbr = &material.pbr_metallic_roughness;
        let [r, g, b, _] = pbr.base_color_factor.0;
        if let Some(info) = &pbr.base_color_texture {
            texture(root, info).map_err(|e| e.at("baseColorTexture"))?;
        }
        let metallic_roughness = pbr.metallic_roughness_texture.as_ref();
        Ok(Self {
            name: name.into(),
            base_color: [
                unit("baseColorFactor[0]", r)?,
                unit("baseColorFactor[1]", g)?,
                unit("baseColorFactor[2]", b)?,
            ],
            base_color_varies: pbr.base_color_texture.is_some() || vertex_colors,
            metallic: unit("metallicFactor", pbr.metallic_factor.0)?,
            roughness: unit("roughnessFactor", pbr.roughness_factor.0)?,
            texture: metallic_roughness
                .map(|info| texture(root, info).map_err(|e| e.at("metallicRoughnessTexture")))
                .transpose()?,
            unmodelled: extensions::unmodelled(material),
        })
    }

    /// The image whose texels decide this material's ranges; none where the factors leave it no say.
    fn image(&self) -> Option<usize> {
        let matters = self.roughness > 0.0 || self.metallic > 0.0;
        self.texture.filter(|_| matters).and_then(|texture| texture.image)
    }

    fn extension_warnings(&self) -> impl Iterator<Item = String> {
        self.unmodelled
            .iter()
            .map(|(extension, what)| format!("material {}: {extension} is not modelled: {what}", self.name))
    }

    fn read(
        &self,
        file: &GltfFile,
        texels: &BTreeMap<usize, Result<Texels, String>>,
        scene: &mut Scene,
    ) -> Material {
        let (roughness, metallic) = match self.texture {
            None => (Distribution::constant(self.roughness), [self.metallic; 2]),
            Some(Texture { index, image }) => {
                let read = match image.map(|i| (i, texels.get(&i))) {
                    None => Err((format!("textures[{index}]"), "it names no image".to_owned())),
                    Some((_, None)) => Ok(None), // both factors are 0
                    Some((_, Some(Ok(texels)))) => Ok(Some(texels)),
                    Some((i, Some(Err(why)))) => Err((file.image_label(i), why.clone())),
                };
                match read {
                    Ok(Some(texels)) => (texels.roughness(self.roughness), texels.metallic(self.metallic)),
                    Ok(None) => (Distribution::constant(0.0), [0.0; 2]),
                    Err((label, why)) => {
                        scene.warnings.push(format!(
                            "material {}: metallicRoughnessTexture {label}: {why}; roughness is taken over \
                             all of [0, {}] and metalness over [0, {}]; give a PNG or JPEG for tables that fit",
                            self.name, self.roughness, self.metallic
                        ));
                        (Distribution::uniform(0.0, self.roughness), [0.0, self.metallic])
                    }
                }
            }
        };
        let mut lobes = Vec::new();
        match self.why_no_diffuse(metallic) {
            Some(why) => scene.left_out.push(LeftOut {
                what: format!("the lobe gltf_diffuse of material {}", self.name),
                why: why.into(),
            }),
            None => lobes.push(MaterialLobe {
                model: "gltf_diffuse".into(),
                roughness: None,
                parameters: Vec::new(),
                weights: self.weights("gltf_diffuse", metallic, ["0.96 (1 − metallic) base_color", "0"]),
                compensation: Compensation::None,
                factors: Vec::new(),
            }),
        }
        lobes.push(MaterialLobe {
            model: "ggx".into(),
            roughness: Some(roughness),
            parameters: Vec::new(),
            weights: self.weights("ggx", metallic, ["0.04 (1 − metallic) + metallic base_color", "1"]),
            compensation: Compensation::None,
            factors: Vec::new(),
        });
        // Texels and vertex colours are at most 1, and may be 0.
        let [low, high] = [f64::min, f64::max].map(|f| self.base_color.into_iter().reduce(f).unwrap_or(1.0));
        let base_color = Some([if self.base_color_varies { 0.0 } else { low }, high]);
        Material { name: self.name.clone(), lobes, metallic: Some(metallic), base_color }
    }

    fn why_no_diffuse(&self, metallic: [f64; 2]) -> Option<&'static str> {
        if metallic[0] == 1.0 {
            Some("it is metal everywhere, and its weight 0.96 (1 − metallic) base_color is 0")
        } else if self.base_color == [0.0; 3] {
            Some("its base colour is black, and its weight 0.96 (1 − metallic) base_color is 0")
        } else {
            None
        }
    }

    /// The weights (a, b), as numbers where colour and metalness are the same everywhere.
    fn weights(&self, model: &str, metallic: [f64; 2], words: [&str; 2]) -> Weights {
        if self.base_color_varies || metallic[0] != metallic[1] {
            return Weights::Textured(words.map(Into::into));
        }
        let ab = self.base_color.map(|c| metallic_roughness::weights(model, c, metallic[0]));
        Weights::Constant([ab.map(|[a, _]| a), ab.map(|[_, b]| b)])
    }
}

/// A factor, which glTF wants in [0, 1].
fn unit(field: &str, value: f32) -> Result<f64> {
    if (0.0..=1.0).contains(&value) {
        // The shortest decimal that gives this f32 is what the file says: 0.3, not 0.30000001192….
        return Ok(value.to_string().parse().unwrap_or(f64::from(value)));
    }
    Err(Error::input(format!(
        "{field} is {value}, which glTF does not allow; correct it to a number in [0, 1]"
    )))
}

/// Where a texture's texels are. An image in a format of an extension (Basis, WebP) counts only where
/// the file has no PNG or JPEG beside it.
fn texture(root: &Root, info: &json::texture::Info) -> Result<Texture> {
    let index = info.index.value();
    let texture = look_up(&root.textures, index, "textures")?;
    let plain = Some(texture.source.value()).filter(|&source| source != u32::MAX as usize);
    let image = plain.or_else(|| texture.extensions.as_ref().and_then(extensions::texture_source));
    if let Some(image) = image {
        look_up(&root.images, image, "images").map_err(|e| e.at(format!("textures[{index}]")))?;
    }
    Ok(Texture { index, image })
}

/// `list[index]`, or the error that says how the file is broken.
fn look_up<'a, T>(list: &'a [T], index: usize, what: &str) -> Result<&'a T> {
    list.get(index).ok_or_else(|| {
        Error::input(format!(
            "there is no {what}[{index}], the file has {} of them; export it again",
            list.len()
        ))
    })
}
