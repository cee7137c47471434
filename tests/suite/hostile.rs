//! Whatever bytes a file has, reading and planning it ends with a scene or with an error that says what is wrong:
//! never with a panic, and never in an endless loop. Files that work are cut short at every length, and changed at
//! random, reproducibly. `GONIO_MUTATIONS` makes more of them.

use gonio::scene;
use gonio::scene::planner::{Plan, Selection};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

#[test]
fn a_scene_cut_short_is_refused() {
    let folder = Folder::new();
    let text = fs::read(demo("demo.gltf")).unwrap();
    for length in (0..text.trim_ascii_end().len()).step_by(7) {
        let error = folder.read("cut.gltf", &text[..length]).expect_err("a scene without its end");
        assert!(error.contains("cut.gltf"), "{length} bytes: {error}");
    }
}

/// What is left of a recipe may be one too.
#[test]
fn a_recipe_cut_short_is_read_or_refused() {
    let folder = Folder::new();
    let text = fs::read(demo("recipe.toml")).unwrap();
    for length in 0..text.len() {
        if let Err(error) = folder.read("cut.toml", &text[..length]) {
            assert!(error.contains("cut.toml"), "{length} bytes: {error}");
        }
    }
}

#[test]
fn changed_files_are_read_or_refused() {
    let folder = Folder::new();
    for (name, extension) in [("demo.gltf", "gltf"), ("recipe.toml", "toml")] {
        let text = fs::read(demo(name)).unwrap();
        let mut chance = Chance(0x9e37_79b9);
        for _ in 0..mutations() {
            let changed = chance.change(&text);
            let name = format!("changed.{extension}");
            if let Err(error) = folder.read(&name, &changed) {
                assert!(!error.is_empty() && !error.contains("internal"), "{error}");
            }
        }
    }
}

/// The data beside a scene: a buffer and pictures that are empty, short or something else.
#[test]
fn changed_data_beside_a_scene_are_read_or_refused() {
    let folder = Folder::new();
    let scene = fs::read(demo("demo.gltf")).unwrap();
    for name in ["demo.bin", "demo_base_color.png", "demo_metal_rough.png"] {
        let data = fs::read(demo(name)).unwrap();
        let mut chance = Chance(0x85eb_ca6b);
        for k in 0..mutations() / 10 {
            let changed = if k == 0 { Vec::new() } else { chance.change(&data) };
            fs::write(folder.0.path().join(name), &changed).unwrap();
            // Textures that cannot be read are taken over their whole range, with a warning.
            folder.read("whole.gltf", &scene).ok();
        }
        fs::write(folder.0.path().join(name), &data).unwrap();
    }
}

/// Sizes are limited before memory is taken.
#[test]
fn files_that_are_too_large_are_refused() {
    let folder = Folder::new();
    for (name, size, why) in [("x.toml", 1 << 24, "8 MiB"), ("x.gltf", (1 << 28) + 1, "256 MiB")] {
        let path = folder.0.path().join(name);
        fs::File::create(&path).unwrap().set_len(size).unwrap();
        let error = scene::read(&path).unwrap_err().to_string();
        assert!(error.contains(name) && error.contains(why), "{error}");
    }
    let many = format!(r#"{{"asset":{{"version":"2.0"}},"materials":[{}[]]}}"#, "[],".repeat(1 << 21));
    let error = folder.read("x.gltf", many.as_bytes()).unwrap_err();
    assert!(error.contains("more than 2097152 values"), "{error}");
}

/// Reading and planning take a time that grows with the file, not with its square.
#[test]
fn many_materials_are_planned_in_seconds() {
    const MATERIALS: usize = 20_000;
    let folder = Folder::new();
    let start = Instant::now();
    let gltf: Vec<_> = (0..MATERIALS)
        .map(|k| {
            let extensions = format!(r#"{{"KHR_materials_anisotropy":{{"anisotropyStrength":{}}}}}"#, k % 500);
            let (name, roughness) = (k % 7, (k % 997) as f64 / 997.0);
            let extensions = if k % 40 == 0 { extensions } else { "{}".into() };
            format!(
                r#"{{"name":"M{name}","pbrMetallicRoughness":{{"roughnessFactor":{roughness}}},"extensions":{extensions}}}"#
            )
        })
        .collect();
    let gltf = format!(r#"{{"asset":{{"version":"2.0"}},"materials":[{}]}}"#, gltf.join(","));
    assert_eq!(folder.read("x.gltf", gltf.as_bytes()).unwrap().materials.len(), MATERIALS);
    let recipe: Vec<_> = (0..MATERIALS)
        .map(|k| format!("[materials.m{k}]\nlobes = [{{ model = 'ggx', roughness = 0.5 }}]\n"))
        .chain((0..MATERIALS).map(|k| format!("[[tables]]\nquantity = 'rho_dh'\nmaterial = 'm{k}'\n")))
        .collect();
    assert_eq!(folder.read("x.toml", recipe.concat().as_bytes()).unwrap().tables.len(), MATERIALS);
    let elapsed = start.elapsed();
    println!("{elapsed:?}");
    assert!(elapsed < Duration::from_secs(40), "{elapsed:?}");
}

/// A buffer of base64 is decoded once, however many images are in it.
#[test]
fn a_buffer_of_base64_is_decoded_once() {
    const IMAGES: usize = 1000;
    let folder = Folder::new();
    let list = |element: &dyn Fn(usize) -> String| (0..IMAGES).map(element).collect::<Vec<_>>().join(",");
    let texture = |k| format!(r#"{{"pbrMetallicRoughness":{{"metallicRoughnessTexture":{{"index":{k}}}}}}}"#);
    let root = format!(
        r#"{{"asset":{{"version":"2.0"}},"materials":[{}],"textures":[{}],"images":[{}],"bufferViews":[{}],
            "buffers":[{{"uri":"data:;base64,{}"}}]}}"#,
        list(&texture),
        list(&|k| format!(r#"{{"source":{k}}}"#)),
        list(&|k| format!(r#"{{"bufferView":{k}}}"#)),
        list(&|k| format!(r#"{{"buffer":0,"byteOffset":{k},"byteLength":100}}"#)),
        "A".repeat(1 << 24),
    );
    let start = Instant::now();
    let plan = folder.read("x.gltf", root.as_bytes()).unwrap();
    assert_eq!((plan.materials.len(), plan.warnings.len()), (IMAGES, IMAGES));
    assert!(start.elapsed() < Duration::from_secs(15), "{:?}", start.elapsed());
}

/// A folder with the demo's data.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        for name in ["demo.bin", "demo_base_color.png", "demo_metal_rough.png"] {
            fs::copy(demo(name), folder.path().join(name)).unwrap();
        }
        Self(folder)
    }

    /// A scene of these bytes, and its plan.
    fn read(&self, name: &str, bytes: &[u8]) -> Result<Plan, String> {
        let path = self.0.path().join(name);
        fs::write(&path, bytes).unwrap();
        let scene = scene::read(&path).map_err(|error| error.to_string())?;
        Plan::new(&scene, &Selection::default()).map_err(|error| error.to_string())
    }
}

fn demo(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/demo").join(name)
}

fn mutations() -> usize {
    std::env::var("GONIO_MUTATIONS").map_or(1000, |count| count.parse().unwrap())
}

/// Xorshift (Marsaglia 2003).
struct Chance(u32);

impl Chance {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        self.0 as usize % n.max(1)
    }

    /// Some bytes changed, taken away, repeated, or put in the place of numbers.
    fn change(&mut self, bytes: &[u8]) -> Vec<u8> {
        const WORDS: [&[u8]; 10] = [
            b"-1",
            b"2147483648",
            b"18446744073709551616",
            b"1e999",
            b"nan",
            b"inf",
            b"null",
            b"\"\"",
            b"[]",
            b"\xff\xfe",
        ];
        let mut bytes = bytes.to_vec();
        for _ in 0..=self.below(4) {
            let at = self.below(bytes.len());
            let length = self.below(12).min(bytes.len() - at);
            match self.below(4) {
                0 => bytes[at] = self.below(256) as u8,
                1 => drop(bytes.drain(at..at + length)),
                2 => {
                    let part = bytes[at..at + length].to_vec();
                    bytes.splice(at..at, part);
                }
                _ => {
                    // A number, if there is one from here on.
                    let start = bytes[at..].iter().position(u8::is_ascii_digit).map_or(at, |k| at + k);
                    let digits = bytes[start..].iter().take_while(|b| b.is_ascii_digit()).count();
                    let word = WORDS[self.below(WORDS.len())];
                    bytes.splice(start..start + digits, word.iter().copied());
                }
            }
            if bytes.is_empty() {
                bytes.push(b' ');
            }
        }
        bytes
    }
}
