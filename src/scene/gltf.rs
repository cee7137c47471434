//! glTF 2.0: what the metallic-roughness materials of a scene really take, factors times texels.
//!
//! With base colour c and metalness m (glTF 2.0, Appendix B; Fc = (1 − ωi·ωm)⁵):
//!
//! f = 0.96 (1 − m) c · (1 − Fc)/π + (0.04 (1 − m) + m c) · A + B
//!
//! so that a material is at most two lobes, `gltf_diffuse` and `ggx`, and what its extensions make of them
//! (`gltf/layers.rs`). Geometry is not read; only which materials it uses.
//!
//! A mistake in one material refuses no other, and a mistake in what is not needed refuses none.

mod extensions;
mod fields;
mod file;
mod jpeg;
mod ktx2;
mod layers;
mod png;
mod root;
mod source;
mod texels;
mod uri;

use crate::base::error::{Error, Result};
use crate::scene::{LeftOut, Scene};
use file::GltfFile;
use root::{Root, look_up};
use serde_json::Value;
use source::MaterialSource;
use std::cell::RefCell;
use std::collections::{BTreeMap, HashSet};
use std::path::Path;

/// Reads a `.gltf` or a `.glb`.
pub(super) fn read(path: &Path) -> Result<Scene> {
    let (file, warnings) = GltfFile::open(path)?;
    let mut scene = Scene { file: path.to_owned(), warnings, ..Scene::default() };
    scene.warnings.extend(extensions::required(&file.root));
    let sources = sources(&file.root, &mut scene);
    if sources.is_empty() {
        return Err(Error::input(why_nothing(&scene.left_out)).at(path.display()));
    }
    let texels = file.texels(sources.iter().flat_map(MaterialSource::images).collect());
    for source in &sources {
        let material = source.read(&file, &texels, &mut scene);
        scene.materials.push(material);
    }
    Ok(scene)
}

/// The materials to bake, checked: those that a mesh uses, or all where the file has no mesh.
fn sources(root: &Root, scene: &mut Scene) -> Vec<MaterialSource> {
    let names = unique_names(root);
    let users = users(root, &mut scene.warnings);
    let mut sources = Vec::new();
    let mut check = |scene: &mut Scene, material: &Value, name: &str, place: String, vertex_colors| {
        let warnings = RefCell::default();
        let checked = MaterialSource::check(root, material, name, vertex_colors, &warnings);
        let named = |warning| format!("material {name}: {warning}");
        scene.warnings.extend(warnings.into_inner().into_iter().map(named));
        match checked {
            Ok(source) => sources.push(source),
            Err(error) => {
                let why = error.at(place).to_string();
                scene.warnings.push(format!("material {name} is not baked: {why}"));
                scene.left_out.push(LeftOut::material(name, why));
            }
        }
    };
    for (index, (material, name)) in root.materials.iter().zip(&names).enumerate() {
        let user = users.get(&Some(index));
        if user.is_none() && !users.is_empty() {
            scene.left_out.push(LeftOut::material(name, "no mesh uses it"));
        } else if extensions::on(material).any(|(extension, _)| extension == "KHR_materials_unlit") {
            let why = "KHR_materials_unlit: it shows its base colour as it is and reflects nothing";
            scene.left_out.push(LeftOut::material(name, why));
        } else {
            let place = format!("materials[{index}] ({name})");
            check(scene, material, name, place, user.is_some_and(|u| u.vertex_colors));
        }
    }
    if let Some(user) = users.get(&None) {
        let name = unused_name(&names.into_iter().collect(), "default".into(), "_gltf");
        check(scene, &Value::Null, &name, name.clone(), user.vertex_colors);
    }
    sources
}

/// Why nothing of a file can be baked.
fn why_nothing(left_out: &[LeftOut]) -> String {
    const MOST: usize = 5;
    if left_out.is_empty() {
        return "it has neither a material nor a mesh; nothing in it can be baked".into();
    }
    let reasons = left_out.iter().take(MOST).map(|LeftOut { what, why }| format!("{what}: {why}"));
    let reasons: Vec<_> = reasons.collect();
    let more = match left_out.len().saturating_sub(MOST) {
        0 => String::new(),
        more => format!("; and {more} more"),
    };
    format!("nothing in it can be baked; {}{more}", reasons.join("; "))
}

/// How meshes use a material.
#[derive(Default)]
struct User {
    /// Whether a primitive multiplies the base colour by COLOR_0.
    vertex_colors: bool,
}

/// The materials that primitives use, by index; `None` is glTF's default material. A material that
/// only a variant selects is used too.
fn users(root: &Root, warnings: &mut Vec<String>) -> BTreeMap<Option<usize>, User> {
    let mut users: BTreeMap<_, User> = BTreeMap::new();
    for (m, mesh) in root.meshes.iter().enumerate() {
        for (p, primitive) in elements(&mesh["primitives"]).enumerate() {
            let mappings = elements(&primitive["extensions"]["KHR_materials_variants"]["mappings"]);
            let variants = mappings.map(|mapping| &mapping["material"]).filter(|index| !index.is_null());
            for index in std::iter::once(&primitive["material"]).chain(variants) {
                let material = match (index, look_up(&root.materials, index, "materials")) {
                    (Value::Null, _) => None,
                    (_, Ok((index, _))) => Some(index),
                    (_, Err(why)) => {
                        warnings.push(format!("meshes[{m}].primitives[{p}].material: {}", printable(&why)));
                        continue;
                    }
                };
                let user = users.entry(material).or_default();
                user.vertex_colors |= primitive["attributes"].get("COLOR_0").is_some();
            }
        }
    }
    users
}

/// The elements of a list; of anything else none.
fn elements(value: &Value) -> std::slice::Iter<'_, Value> {
    value.as_array().map_or(&[][..], Vec::as_slice).iter()
}

/// A name for each material of the file: its own, `material_3` where it has none, and with its index
/// behind it where another has the same.
fn unique_names(root: &Root) -> Vec<String> {
    let mut taken = HashSet::new();
    let mut names = Vec::new();
    for (index, material) in root.materials.iter().enumerate() {
        let name = material["name"].as_str().map(printable).filter(|name| !name.is_empty());
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
