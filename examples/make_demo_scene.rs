//! Makes the demo scene that the repository carries: three spheres, one of them textured.
//!
//!     cargo run --example make_demo_scene [FOLDER]
//!
//! Any glTF viewer opens it; `gonio bake` reads its materials. What is put in is known exactly, so the
//! tests compare it with what `gonio` finds.

use image::{Rgb, RgbImage};
use serde_json::{Value, json};
use std::f64::consts::{PI, TAU};
use std::io;
use std::path::{Path, PathBuf};

/// The roughness of the whole scene: the textured sphere takes all of it, gold its smallest value and
/// clay its greatest.
pub const ROUGHNESS: [f64; 2] = [0.3, 0.6];

/// Texels are multiplied by this; with 0.75, both ends of [`ROUGHNESS`] are whole levels of 255.
const ROUGHNESS_FACTOR: f64 = 0.75;

/// Texels on a side of a texture.
const SIDE: u32 = 64;

fn main() -> io::Result<()> {
    let folder = std::env::args_os().nth(1).map_or_else(|| PathBuf::from("assets/demo"), PathBuf::from);
    write(&folder)?;
    println!("wrote {}", folder.join("demo.gltf").display());
    Ok(())
}

/// Writes `demo.gltf`, its geometry and its two textures.
pub fn write(folder: &Path) -> io::Result<()> {
    std::fs::create_dir_all(folder)?;
    let (base_color, metal_rough) = textures();
    base_color.save(folder.join("demo_base_color.png")).map_err(io::Error::other)?;
    metal_rough.save(folder.join("demo_metal_rough.png")).map_err(io::Error::other)?;
    let sphere = Sphere::new(32, 16);
    std::fs::write(folder.join("demo.bin"), &sphere.bytes)?;
    let text = serde_json::to_string_pretty(&document(&sphere))?;
    std::fs::write(folder.join("demo.gltf"), text + "\n")
}

/// Old blue paint, worn to the copper: metal is smooth, paint is rough.
fn textures() -> (RgbImage, RgbImage) {
    let field: Vec<f64> = (0..SIDE * SIDE).map(|k| waves(k % SIDE, k / SIDE)).collect();
    let min = field.iter().copied().fold(f64::INFINITY, f64::min);
    let max = field.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    // Scaled so that 0 and 1 are both reached, and with them both ends of every range.
    let worn = |x: u32, y: u32| (field[(y * SIDE + x) as usize] - min) / (max - min);
    let level = |value: f64| (255.0 * value).round() as u8;

    let base_color = RgbImage::from_fn(SIDE, SIDE, |x, y| {
        let metal = metalness(worn(x, y));
        let [paint, copper] = [[0.20, 0.42, 0.62], [0.98, 0.81, 0.75]]; // sRGB
        Rgb([0, 1, 2].map(|c| level(paint[c] + (copper[c] - paint[c]) * metal)))
    });
    let metal_rough = RgbImage::from_fn(SIDE, SIDE, |x, y| {
        let roughness = ROUGHNESS[1] + (ROUGHNESS[0] - ROUGHNESS[1]) * worn(x, y);
        // glTF: roughness in G, metalness in B.
        Rgb([0, level(roughness / ROUGHNESS_FACTOR), level(metalness(worn(x, y)))])
    });
    (base_color, metal_rough)
}

/// Smooth, and periodic over the texture so that the sphere shows no seam.
fn waves(x: u32, y: u32) -> f64 {
    let [u, v] = [x, y].map(|k| TAU * (f64::from(k) + 0.5) / f64::from(SIDE));
    (2.0 * u + v).sin() + (3.0 * u - 2.0 * v + 1.0).sin() + 0.5 * (5.0 * v + 2.0 * u.sin()).sin()
}

/// Paint below, metal above, with a soft edge.
fn metalness(worn: f64) -> f64 {
    let t = ((worn - 0.5) / 0.2).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// A unit sphere; its positions are its normals.
struct Sphere {
    /// Positions, texture coordinates, indices.
    bytes: Vec<u8>,
    vertices: usize,
    indices: usize,
}

impl Sphere {
    fn new(slices: u16, stacks: u16) -> Self {
        let grid = || (0..=stacks).flat_map(|j| (0..=slices).map(move |i| (i, j)));
        let uv = |i: u16, j: u16| [f64::from(i) / f64::from(slices), f64::from(j) / f64::from(stacks)];
        let positions = grid().flat_map(|(i, j)| {
            let [phi, theta] = [TAU * uv(i, j)[0], PI * uv(i, j)[1]];
            [theta.sin() * phi.cos(), theta.cos(), -theta.sin() * phi.sin()]
        });
        let floats = positions.chain(grid().flat_map(|(i, j)| uv(i, j)));
        let mut bytes: Vec<u8> = floats.flat_map(|x| (x as f32).to_le_bytes()).collect();

        let row = slices + 1;
        let quads = (0..stacks).flat_map(|j| (0..slices).map(move |i| j * row + i));
        let indices: Vec<u16> =
            quads.flat_map(|k| [k, k + row, k + 1, k + 1, k + row, k + row + 1]).collect();
        bytes.extend(indices.iter().flat_map(|k| k.to_le_bytes()));
        Self { bytes, vertices: grid().count(), indices: indices.len() }
    }
}

fn document(sphere: &Sphere) -> Value {
    let [float, u16] = [5126, 5123]; // component types
    let [vertex_buffer, index_buffer] = [34962, 34963]; // targets
    let [positions, uvs, indices] = [sphere.vertices * 12, sphere.vertices * 8, sphere.indices * 2];
    let materials = materials();
    let names = || materials.iter().map(|material| material["name"].clone());
    json!({
        "asset": { "version": "2.0", "generator": "gonio: examples/make_demo_scene.rs" },
        "scene": 0,
        "scenes": [{ "nodes": [0, 1, 2] }],
        "nodes": names().enumerate().map(|(k, name)| json!({
            "name": name, "mesh": k, "translation": [2.5 * (k as f64 - 1.0), 0.0, 0.0],
        })).collect::<Vec<_>>(),
        "meshes": names().enumerate().map(|(k, name)| json!({
            "name": name,
            "primitives": [{
                "attributes": { "POSITION": 0, "NORMAL": 0, "TEXCOORD_0": 1 }, "indices": 2, "material": k,
            }],
        })).collect::<Vec<_>>(),
        "materials": materials,
        "textures": [{ "source": 0, "sampler": 0 }, { "source": 1, "sampler": 0 }],
        "images": [{ "uri": "demo_base_color.png" }, { "uri": "demo_metal_rough.png" }],
        "samplers": [{ "magFilter": 9729, "minFilter": 9987, "wrapS": 10497, "wrapT": 10497 }],
        "buffers": [{ "uri": "demo.bin", "byteLength": sphere.bytes.len() }],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": positions, "target": vertex_buffer },
            { "buffer": 0, "byteOffset": positions, "byteLength": uvs, "target": vertex_buffer },
            { "buffer": 0, "byteOffset": positions + uvs, "byteLength": indices, "target": index_buffer },
        ],
        "accessors": [
            { "bufferView": 0, "componentType": float, "count": sphere.vertices, "type": "VEC3",
              "min": [-1.0, -1.0, -1.0], "max": [1.0, 1.0, 1.0] },
            { "bufferView": 1, "componentType": float, "count": sphere.vertices, "type": "VEC2" },
            { "bufferView": 2, "componentType": u16, "count": sphere.indices, "type": "SCALAR" },
        ],
    })
}

fn materials() -> Vec<Value> {
    vec![
        json!({
            "name": "worn paint",
            "pbrMetallicRoughness": {
                "baseColorTexture": { "index": 0 },
                "metallicRoughnessTexture": { "index": 1 },
                "roughnessFactor": ROUGHNESS_FACTOR,
            },
        }),
        json!({
            "name": "gold",
            "pbrMetallicRoughness": {
                "baseColorFactor": [1.0, 0.78, 0.34, 1.0],
                "metallicFactor": 1.0,
                "roughnessFactor": ROUGHNESS[0],
            },
        }),
        json!({
            "name": "clay",
            "pbrMetallicRoughness": {
                "baseColorFactor": [0.55, 0.27, 0.18, 1.0],
                "metallicFactor": 0.0,
                "roughnessFactor": ROUGHNESS[1],
            },
        }),
    ]
}
