//! Files: one writer a format, and whole sets of tables written all or nothing; lists of directions, and
//! values at them.

pub(crate) mod draw;
mod entry;
pub mod format;
#[cfg(feature = "cli")]
mod list;
mod manifest;
#[cfg(feature = "cli")]
mod pairs;
mod set;
mod stream;
pub mod target;

pub use entry::TableEntry;
pub use format::Format;
#[cfg(feature = "cli")]
pub(crate) use list::List;
pub(crate) use manifest::hash;
pub use manifest::{read_manifest, sha256, verify};
#[cfg(feature = "cli")]
pub(crate) use pairs::Pairs;
pub use set::{Files, TableSet};
pub(crate) use stream::Tiles;

use crate::base::error::{Error, Result};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// What a table came from, by name: the scene, its hash, the device. No times: the same input gives
/// the same bytes.
pub type Provenance = BTreeMap<String, String>;

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
