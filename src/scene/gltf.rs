//! glTF 2.0: what the metallic-roughness materials of a scene really take, factors times texels.
//!
//! With base colour c and metalness m (glTF 2.0, Appendix B; Fc = (1 − ωi·ωm)⁵):
//!
//! f = 0.96 (1 − m) c · (1 − Fc)/π + (0.04 (1 − m) + m c) · A + B
//!
//! so that a material is at most two lobes, `gltf_diffuse` and `ggx`, and what its extensions make of them
//! (`gltf/layers.rs`). Geometry is not read; only which materials it uses.

mod extensions;
mod file;
mod ktx2;
mod layers;
mod source;
mod texels;

use crate::base::error::{Error, Result};
use crate::scene::{LeftOut, Scene};
use ::gltf::json::{self, Root};
use file::GltfFile;
use source::MaterialSource;
use std::collections::{BTreeMap, HashSet};
use std::path::Path;

/// Reads a `.gltf` or a `.glb`.
pub(super) fn read(path: &Path) -> Result<Scene> {
    let file = GltfFile::open(path)?;
    let mut scene = Scene { file: path.to_owned(), ..Scene::default() };
    let sources = sources(&file.root, &mut scene).map_err(|e| e.at(path.display()))?;
    let texels = file.texels(sources.iter().flat_map(MaterialSource::images).collect());
    for source in &sources {
        scene.warnings.extend(source.warnings());
        let material = source.read(&file, &texels, &mut scene);
        scene.materials.push(material);
    }
    Ok(scene)
}

/// The materials to bake, checked: those that a mesh uses, or all where the file has no mesh.
fn sources(root: &Root, scene: &mut Scene) -> Result<Vec<MaterialSource>> {
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
            sources
                .push(MaterialSource::check(root, material, name, vertex_colors).map_err(|e| e.at(place))?);
        }
    }
    if let Some(user) = users.get(&None) {
        let name = unused_name(&names.into_iter().collect(), "default".into(), "_gltf");
        sources.push(MaterialSource::check(root, &json::Material::default(), &name, user.vertex_colors)?);
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

/// A factor, which glTF wants in [0, 1].
fn unit(field: &str, value: f64) -> Result<f64> {
    if (0.0..=1.0).contains(&value) {
        return Ok(value);
    }
    Err(Error::input(format!(
        "{field} is {value}, which glTF does not allow; correct it to a number in [0, 1]"
    )))
}

/// What stands behind a texture.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Texture {
    index: usize,
    /// `None`: the texture names no image.
    image: Option<usize>,
}

/// Where a texture's texels are. An image in a format of an extension (Basis, WebP) counts only where
/// the file has no PNG or JPEG beside it.
fn texture(root: &Root, index: usize) -> Result<Texture> {
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
