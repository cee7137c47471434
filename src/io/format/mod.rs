//! The file formats of tables. A format is a file here and a line of the registry.

use crate::base::error::{Error, Result};
use crate::base::words::alternatives;
use crate::io::Provenance;
use crate::table::Table;
use std::fmt;

/// A file format for tables.
#[non_exhaustive]
pub struct Format {
    /// The name on the command line and in manifests.
    pub name: &'static str,
    /// The extension of its files.
    pub extension: &'static str,
    /// One line for people.
    pub summary: &'static str,
    /// The bytes of the file of a table whose values fit its shape.
    pub(crate) encode: fn(&Table, &Provenance) -> Result<Vec<u8>>,
    /// How a table larger than memory is written.
    pub(crate) streamed: Streamed,
}

/// How a format writes a table larger than memory.
pub(crate) enum Streamed {
    /// Row by row.
    Rows(BeginRows),
    /// Only a part of it is shown: a picture.
    Preview,
}

/// Appends all that precedes the first row to a file, and returns the writer of its rows.
pub(crate) type BeginRows = fn(&Table, &Provenance, &mut Vec<u8>) -> Result<Box<dyn RowWriter>>;

/// Writes the rows of a table in f32, from the first to the last. The file has the bytes that
/// [`Format::encode`] makes of the whole table.
pub(crate) trait RowWriter {
    /// Appends a row of texels, their channels last.
    fn append(&mut self, texels: &[f32], file: &mut Vec<u8>);

    /// Appends what follows the last row.
    fn finish(&mut self, _file: &mut Vec<u8>) {}
}

/// Declares the modules of the formats and [`FORMATS`] from one list.
macro_rules! formats {
    ($($module:ident::$name:ident,)*) => {
        $(pub(in crate::io) mod $module; pub use $module::$name;)*

        /// The registry.
        pub static FORMATS: &[&Format] = &[$(&$name),*];
    };
}

formats! {
    exr::EXR,
    npy::NPY,
    png::PNG,
}

/// The format of this name.
///
/// # Errors
/// When there is none.
pub fn find(name: &str) -> Result<&'static Format> {
    FORMATS.iter().copied().find(|format| format.name == name.trim()).ok_or_else(|| {
        let names = alternatives(FORMATS.iter().map(|format| format.name));
        Error::input(format!("unknown format \"{name}\"; use {names}"))
    })
}

impl Format {
    /// The bytes of a file that holds the table: the same table, the same bytes.
    ///
    /// # Errors
    /// When the format cannot hold the table: an image too large for EXR, say.
    pub fn encode(&self, table: &Table, provenance: &Provenance) -> Result<Vec<u8>> {
        let (channels, values) = (table.channels.len(), table.values.len());
        if channels == 0 || table.texels().checked_mul(channels) != Some(values) {
            return Err(Error::Internal(format!(
                "table {}: {values} values for shape {:?} and {channels} channels",
                table.name,
                table.shape()
            )));
        }
        (self.encode)(table, provenance)
    }
}

impl PartialEq for Format {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Eq for Format {}

impl fmt::Debug for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}
