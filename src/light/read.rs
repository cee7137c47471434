//! Reading environment maps: OpenEXR and Radiance HDR.

mod openexr;
mod radiance;

use crate::base::error::{Error, Result};
use crate::light::environment::{Clamped, Environment};
use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::path::Path;

/// The largest file that is opened: twice the size of 2²⁵ uncompressed texels.
const MAX_BYTES: u64 = 1 << 30;

/// OpenEXR, "OpenEXR File Layout": the magic number.
const EXR: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// What to do with a map that has texels which are no radiance: negative, infinite or NaN.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InvalidTexels<'a> {
    /// Refuse the map. The message offers to correct it, or this remedy of the caller's: "clamp it".
    Refuse {
        /// The end of "mend the map, or …".
        remedy: &'a str,
    },
    /// Replace them as [`Environment::clamped`] does, and count them.
    Clamp,
}

/// An environment map as its file has it.
#[derive(Debug, Clone, PartialEq)]
pub struct MapFile {
    /// The map.
    pub map: Environment,
    /// The texels that were replaced.
    pub clamped: Clamped,
    /// What the file says beside its texels and how it was taken, in sentences: windows that differ, exposures.
    pub notes: Vec<String>,
}

/// Texels of a file, row by row from the top, R, G, B.
struct MapPicture {
    width: usize,
    height: usize,
    texels: Vec<[f32; 3]>,
    notes: Vec<String>,
}

/// Reads an environment map in latitude and longitude. Its first bytes, not its name, tell OpenEXR from Radiance HDR.
///
/// # Errors
/// When the file is not such a map, is cut short, has too many texels, or texels that are no radiance.
pub fn read(path: &Path, invalid: InvalidTexels) -> Result<MapFile> {
    read_picture(path)
        .and_then(|MapPicture { width, height, texels, notes }| {
            let (map, clamped) = match invalid {
                InvalidTexels::Clamp => Environment::clamped(width, height, texels)?,
                InvalidTexels::Refuse { remedy } => {
                    (Environment::checked(width, height, texels, remedy)?, Clamped::default())
                }
            };
            Ok(MapFile { map, clamped, notes })
        })
        .map_err(|error| error.at(path.display()))
}

fn read_picture(path: &Path) -> Result<MapPicture> {
    let mut file = File::open(path).map_err(Error::io("read", path))?;
    let bytes = file.metadata().map_err(Error::io("read", path))?.len();
    if bytes > MAX_BYTES {
        return Err(Error::input(format!("{bytes} bytes, more than the {MAX_BYTES} that are read")));
    }
    let mut head = Vec::new();
    file.by_ref().take(4).read_to_end(&mut head).map_err(Error::io("read", path))?;
    file.rewind().map_err(Error::io("read", path))?;
    let file = BufReader::new(file);
    match head[..] {
        [] => Err(Error::input("it is empty; give an OpenEXR or a Radiance HDR map")),
        _ if head == EXR => openexr::read(file),
        [b'#', b'?', ..] => radiance::read(file),
        _ => Err(Error::input("neither OpenEXR nor Radiance HDR; give a map in one of these")),
    }
}
