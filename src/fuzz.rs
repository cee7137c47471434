//! Every parser of files that others wrote, for fuzzers: `fuzz/` drives them by coverage, a long test by chance.
//!
//! This room is no part of the library: it is compiled for tests and with the feature `fuzz` alone.

mod seeds;

use crate::base::error::{Error, Result};
use crate::io::Pairs;
use crate::light::{self, InvalidTexels};
use crate::scene;
use crate::scene::planner::{Plan, Selection};
use crate::verify::user_shader::UserFunction;
use std::fs;
use std::path::Path;

/// A parser, as the command calls it.
pub struct Parser {
    /// Its name, as in `cargo fuzz run NAME`.
    pub name: &'static str,
    /// The name of its file.
    file: &'static str,
    run: fn(&Path) -> Result<()>,
    /// Small files that it reads.
    pub seeds: fn() -> Vec<Vec<u8>>,
}

/// All of them.
pub const PARSERS: &[Parser] = &[
    Parser { name: "gltf", file: "x.gltf", run: read_scene, seeds: seeds::gltf },
    Parser { name: "glb", file: "x.glb", run: read_scene, seeds: seeds::glb },
    Parser { name: "recipe", file: "x.toml", run: read_scene, seeds: seeds::recipe },
    Parser { name: "ktx2", file: "texture", run: read_texture, seeds: seeds::ktx2 },
    Parser { name: "jpeg", file: "texture", run: read_texture, seeds: seeds::jpeg },
    Parser { name: "png", file: "texture", run: read_texture, seeds: seeds::png },
    Parser { name: "exr", file: "x.exr", run: read_light, seeds: seeds::exr },
    Parser { name: "hdr", file: "x.hdr", run: read_light, seeds: seeds::hdr },
    Parser { name: "npy", file: "x.npy", run: read_pairs, seeds: seeds::npy },
    Parser { name: "csv", file: "x.csv", run: read_pairs, seeds: seeds::csv },
    Parser { name: "wgsl", file: "x.wgsl", run: read_shader, seeds: seeds::wgsl },
];

impl Parser {
    /// The parser of this name.
    pub fn find(name: &str) -> Option<&'static Self> {
        PARSERS.iter().find(|parser| parser.name == name)
    }

    /// Puts the scene that a texture belongs to into a folder.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn prepare(folder: &Path) -> Result<()> {
        let path = folder.join("textured.gltf");
        fs::write(&path, seeds::TEXTURED).map_err(Error::io("write", &path))
    }

    /// Parses bytes as a file in a prepared folder. They may be refused.
    ///
    /// # Errors
    /// Says why they are refused.
    ///
    /// # Panics
    /// When the fault is ours: an internal error, or what panics inside.
    pub fn run(&self, folder: &Path, bytes: &[u8]) -> Result<()> {
        let path = folder.join(self.file);
        fs::write(&path, bytes).map_err(Error::io("write", &path))?;
        let result = (self.run)(&path);
        if let Err(error @ Error::Internal(_)) = &result {
            panic!("{}: {error}", self.name);
        }
        result
    }
}

fn read_scene(path: &Path) -> Result<()> {
    let scene = scene::read(path)?;
    Plan::new(&scene, &Selection::default()).map(drop)
}

/// Textures that cannot be believed are warned of.
fn read_texture(path: &Path) -> Result<()> {
    let scene = scene::read(&path.with_file_name("textured.gltf"))?;
    scene.warnings.first().map_or(Ok(()), |warning| Err(Error::input(warning)))
}

fn read_light(path: &Path) -> Result<()> {
    light::read(path, InvalidTexels::Clamp).map(drop)
}

fn read_pairs(path: &Path) -> Result<()> {
    let mut pairs = Pairs::open(path)?;
    let mut angles = Vec::new();
    loop {
        pairs.next(1 << 10, &mut angles)?;
        if angles.is_empty() {
            return Ok(());
        }
    }
}

fn read_shader(path: &Path) -> Result<()> {
    let source = fs::read(path).map_err(Error::io("read", path))?;
    UserFunction::parse("x.wgsl", String::from_utf8_lossy(&source), "brdf")?.compose(Some(65_535)).map(drop)
}

#[cfg(test)]
mod tests;
