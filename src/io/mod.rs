//! Files: one writer a format, and whole sets of tables written all or nothing; lists of directions, and
//! values at them.

pub(crate) mod draw;
mod entry;
mod exr;
#[cfg(feature = "cli")]
mod list;
mod manifest;
mod npy;
#[cfg(feature = "cli")]
mod pairs;
mod png;
mod set;
mod stream;

pub use entry::TableEntry;
#[cfg(feature = "cli")]
pub(crate) use list::List;
pub(crate) use manifest::hash;
pub use manifest::{read_manifest, sha256, verify};
#[cfg(feature = "cli")]
pub(crate) use pairs::Pairs;
pub use set::{Files, TableSet};
pub(crate) use stream::Tiles;

use crate::base::error::{Error, Result};
use crate::table::Table;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::{fmt, fs, str};

/// What a table came from, by name: the scene, its hash, the device. No times: the same input gives
/// the same bytes.
pub type Provenance = BTreeMap<String, String>;

/// A file format for tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    /// OpenEXR: 32-bit float (16-bit for tables in f16), named channels, uncompressed scanlines; width is the last axis, height the
    /// product of the others, row 0 the first value; axes and provenance as attributes.
    Exr,
    /// NumPy: little-endian float32, float64, float16 or uint16 as the table is stored, shape = axes in order, channel last.
    Npy,
    /// A preview to look at, not to read values from.
    Png,
}

/// Writes files into a folder, which is made if it is not there.
pub(crate) fn write_together(dir: &Path, files: &[(String, Vec<u8>)]) -> Result<()> {
    fs::create_dir_all(dir).map_err(Error::io("create the folder", dir))?;
    write_files(&files.iter().map(|(name, bytes)| (dir.join(name), bytes.as_slice())).collect::<Vec<_>>())
}

/// Writes files: each under another name first, and all are renamed once all are there. Of what fails nothing
/// stays.
pub(crate) fn write_files(files: &[(PathBuf, impl AsRef<[u8]>)]) -> Result<()> {
    let partial = |path: &Path| {
        path.with_file_name(format!(".{}.partial", path.file_name().unwrap_or_default().to_string_lossy()))
    };
    let write = || {
        for (path, bytes) in files {
            if path.is_dir() {
                return Err(Error::input(format!("{}: it is a folder; give a file", path.display())));
            }
            fs::write(partial(path), bytes).map_err(set::explain("write", path))?;
        }
        for (path, _) in files {
            fs::rename(partial(path), path).map_err(set::explain("write", path))?;
        }
        Ok(())
    };
    let written = write();
    if written.is_err() {
        files.iter().for_each(|(path, _)| drop(fs::remove_file(partial(path))));
    }
    written
}

impl Format {
    /// All formats.
    pub const ALL: [Self; 3] = [Self::Exr, Self::Npy, Self::Png];

    /// The name on the command line and in manifests; also the file's extension.
    pub fn name(self) -> &'static str {
        match self {
            Self::Exr => "exr",
            Self::Npy => "npy",
            Self::Png => "png",
        }
    }

    /// The bytes of a file that holds the table: the same table, the same bytes.
    ///
    /// # Errors
    /// When the format cannot hold the table: an image too large for EXR, say.
    pub fn encode(self, table: &Table, provenance: &Provenance) -> Result<Vec<u8>> {
        let (channels, values) = (table.channels.len(), table.values.len());
        if channels == 0 || table.texels().checked_mul(channels) != Some(values) {
            return Err(Error::Internal(format!(
                "table {}: {values} values for shape {:?} and {channels} channels",
                table.name,
                table.shape()
            )));
        }
        match self {
            Self::Exr => exr::encode(table, provenance),
            Self::Npy => npy::encode(table),
            Self::Png => png::encode(table),
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl str::FromStr for Format {
    type Err = Error;

    fn from_str(word: &str) -> Result<Self> {
        let found = Self::ALL.into_iter().find(|format| format.name() == word.trim());
        found.ok_or_else(|| Error::input(format!("unknown format \"{word}\"; use exr, npy or png")))
    }
}
