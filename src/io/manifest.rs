//! The manifest as a file: reading it with suspicion, writing it to be read by people.

use crate::base::error::{Error, Result};
use crate::io::disk;
use crate::io::format::FORMATS;
use serde::Serialize;
use serde_json::Value;
use serde_json::ser::{Formatter, PrettyFormatter, Serializer};
use sha2::{Digest, Sha256};
use std::io::{self, Write};
use std::path::{Component, Path};
use std::{fmt::Write as _, fs};

/// The manifest of a finished set.
pub(super) const MANIFEST: &str = "manifest.json";

/// Reads the manifest of the set in `dir`. The files that it lists are there, whole, whatever was killed (see
/// [`TableSet`](crate::io::TableSet)).
pub fn read_manifest(dir: &Path) -> Result<Value> {
    let path = dir.join(MANIFEST);
    read(&path)?
        .ok_or_else(|| Error::input(format!("{}: not there; bake into this folder first", path.display())))
}

/// The SHA-256 of a file, in hexadecimal.
pub fn sha256(path: &Path) -> Result<String> {
    hash_of(path).map_err(Error::io("read", path))
}

/// The SHA-256 of a file, read piece by piece.
pub(super) fn hash_of(path: &Path) -> io::Result<String> {
    let mut sha256 = Sha256::new();
    io::copy(&mut fs::File::open(path)?, &mut sha256)?;
    Ok(hex(&sha256.finalize()))
}

/// A file that a manifest lists, by its name and hash.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Listed {
    pub name: String,
    pub sha256: String,
}

/// The table files that a manifest lists. A manifest is untrusted: names that lead out of the folder, or
/// that are not of a table format, are left out.
pub(super) fn listed(manifest: &Value) -> Vec<Listed> {
    let plain = entries(manifest).filter(|(name, _)| is_plain(name));
    plain.map(|(name, sha256)| Listed { name: name.into(), sha256: sha256.into() }).collect()
}

/// The number of files that a manifest lists.
#[cfg(feature = "cli")]
pub(crate) fn listed_files(manifest: &Value) -> usize {
    entries(manifest).count()
}

/// Reads a manifest; `None` where there is no such file.
///
/// # Errors
/// When the file is not a manifest of gonio: it is then somebody else's, and stays.
pub(super) fn read(path: &Path) -> Result<Option<Value>> {
    let bytes = match disk::read(path) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(disk::explain("read", path)(error)),
    };
    let foreign = |why: &str| {
        let path = path.display();
        Error::input(format!("{path}: not a manifest of gonio ({why}); move it away or give another folder"))
    };
    let manifest: Value = serde_json::from_slice(&bytes).map_err(|error| foreign(&error.to_string()))?;
    if manifest.get("gonio").is_none() {
        return Err(foreign("no \"gonio\" in it"));
    }
    match manifest.get("schema").and_then(Value::as_u64) {
        Some(1) => Ok(Some(manifest)),
        Some(other) => Err(foreign(&format!("schema {other}; this version reads schema 1"))),
        None => Err(foreign("no \"schema\" in it")),
    }
}

/// JSON for people: a line for each member of an object, arrays on one line.
pub(super) fn to_json(manifest: &impl Serialize) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut serializer = Serializer::with_formatter(&mut bytes, FlatArrays(PrettyFormatter::new()));
    let done = manifest.serialize(&mut serializer);
    done.map_err(|error| Error::Internal(format!("{MANIFEST}: {error}")))?;
    bytes.push(b'\n');
    Ok(bytes)
}

/// The SHA-256 of a file's bytes, in hexadecimal.
pub(crate) fn hash(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

/// Bytes in hexadecimal.
pub(super) fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut hex, byte| {
        let _ = write!(hex, "{byte:02x}"); // a String takes anything
        hex
    })
}

/// Every (file, hash) of a manifest, whatever they are.
pub(super) fn entries(manifest: &Value) -> impl Iterator<Item = (&str, &str)> {
    let tables = manifest.get("tables").and_then(Value::as_array).into_iter().flatten();
    let of_tables = tables.flat_map(|table| {
        let files = table.get("files").and_then(Value::as_object).into_iter().flatten();
        files.filter_map(|(format, name)| {
            let sha256 = table.get("sha256").and_then(|all| all.get(format)).and_then(Value::as_str);
            Some((name.as_str()?, sha256.unwrap_or_default()))
        })
    });
    // Files of no table: pictures and pages.
    let others = manifest.get("files").and_then(Value::as_object).into_iter().flatten();
    of_tables.chain(others.map(|(name, sha256)| (name.as_str(), sha256.as_str().unwrap_or_default())))
}

/// What a set has besides tables.
const OTHERS: [&str; 3] = ["svg", "html", "md"];

/// Whether a name can only mean a file of a set inside the folder, or in its folder of files.
pub(super) fn is_plain(name: &str) -> bool {
    let name = name.strip_prefix("files/").unwrap_or(name);
    let path = Path::new(name);
    let one = matches!(path.components().next(), Some(Component::Normal(part)) if part == name);
    let extension = path.extension().and_then(|extension| extension.to_str());
    let mut extensions = FORMATS.iter().map(|format| format.extension).chain(OTHERS);
    let ours = extensions.any(|format| extension == Some(format));
    one && ours && !name.starts_with('.') && !name.contains(['/', '\\', ':', '\0'])
}

/// Objects as [`PrettyFormatter`] has them; arrays without line breaks, or each axis would fill a page.
struct FlatArrays<'a>(PrettyFormatter<'a>);

impl Formatter for FlatArrays<'_> {
    fn begin_array_value<W: ?Sized + Write>(&mut self, writer: &mut W, first: bool) -> io::Result<()> {
        writer.write_all(if first { b"" } else { b", " })
    }

    fn begin_object<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.0.begin_object(writer)
    }

    fn end_object<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.0.end_object(writer)
    }

    fn begin_object_key<W: ?Sized + Write>(&mut self, writer: &mut W, first: bool) -> io::Result<()> {
        self.0.begin_object_key(writer, first)
    }

    fn begin_object_value<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.0.begin_object_value(writer)
    }

    fn end_object_value<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.0.end_object_value(writer)
    }
}
