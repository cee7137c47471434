//! Whatever bytes a file has, reading and planning it ends with a scene or with an error that says what is wrong:
//! never with a panic, and never in an endless loop. Files that work are cut short at every length, and changed at
//! random, reproducibly. `GONIO_MUTATIONS` makes more of them.

use gonio::scene;
use gonio::scene::planner::{Plan, Selection};
use std::fs;
use std::path::{Path, PathBuf};

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
