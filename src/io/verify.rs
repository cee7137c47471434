//! Compares a set of files with its manifest.

use crate::base::error::Result;
#[cfg(feature = "cli")]
use crate::io::disk;
use crate::io::format::{EXR, NPY};
use crate::io::manifest;
use crate::io::manifest::{MANIFEST, entries, hash_of, is_plain, read_manifest};
use crate::io::set;
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// Compares the files of the set in `dir` with its manifest: their hashes, the shapes of tables, and their plain names.
/// Returns the faults, one line each, naming the file; a whole set has none.
pub fn verify(dir: &Path) -> Result<Vec<String>> {
    let manifest = read_manifest(dir)?;
    let mut faults = Vec::new();
    let mut fault = |name: &str, what: &str| faults.push(format!("{}: {what}", dir.join(name).display()));
    let mut names = BTreeSet::new();
    for (name, sha256) in entries(&manifest) {
        if !is_plain(name) {
            fault(name, "not a name that gonio gives, so it is not ours");
            continue;
        }
        if !names.insert(name) {
            fault(name, "listed twice");
        }
        match hash_of(&dir.join(name)) {
            Ok(hash) if hash == sha256 => {}
            Ok(_) => fault(name, &format!("differs from its SHA-256 in {MANIFEST}; bake again")),
            Err(error) => fault(name, &format!("cannot be read: {error}; bake again")),
        }
        let plain = set::plain_name(name);
        match hash_of(&dir.join(&plain)) {
            _ if plain == name => {}
            Ok(hash) if hash == sha256 => {}
            Ok(_) => fault(&plain, &format!("is not {name}, which {MANIFEST} lists; bake again")),
            Err(error) => fault(&plain, &format!("cannot be read: {error}; bake again")),
        }
    }
    for table in manifest.get("tables").and_then(Value::as_array).into_iter().flatten() {
        for format in [EXR.name, NPY.name] {
            let name = table.get("files").and_then(|files| files.get(format)).and_then(Value::as_str);
            let Some(name) = name.filter(|name| is_plain(name)) else { continue };
            let Ok(file) = File::open(dir.join(name)) else { continue };
            let (expected, found) =
                (shape(table, format == EXR.name), shape_of_file(format, BufReader::new(file)));
            if found != expected {
                let words =
                    |shape: Option<Vec<u64>>| shape.map_or("no table".into(), |shape| format!("{shape:?}"));
                let (expected, found) = (words(expected), words(found));
                fault(name, &format!("its shape is {found}, and {MANIFEST} says {expected}; bake again"));
            }
        }
    }
    Ok(faults)
}

/// What is in the folder of a set and of no use: the rest of a bake that was killed, or of one that is under way.
#[cfg(feature = "cli")]
pub(crate) fn leftovers(dir: &Path) -> Result<Vec<String>> {
    let listed = manifest::listed(&read_manifest(dir)?);
    let line = |name: &str, what: &str| format!("{}: {what}", dir.join(name).display());
    let unlisted = set::leftovers(dir, &listed)?;
    let mut lines: Vec<_> =
        unlisted.iter().map(|name| line(name, "left over; the next bake removes it")).collect();
    for (name, what) in set::UNFINISHED {
        if disk::is_there(&dir.join(name))? {
            lines.push(line(name, what));
        }
    }
    Ok(lines)
}

/// The shape that a manifest gives a table, the channels last: by its axes, or as an image.
fn shape(table: &Value, is_image: bool) -> Option<Vec<u64>> {
    let count = |list: &Value| Some(list.as_array()?.len() as u64);
    let axes = table.get("axes")?.as_array()?.iter().map(|axis| count(axis.get("values")?));
    let axes = axes.collect::<Option<Vec<_>>>()?;
    let channels = count(table.get("channels")?)?;
    if !is_image {
        return Some(axes.into_iter().chain([channels]).collect());
    }
    let (width, others) = axes.split_last().map_or((1, &[][..]), |(&width, others)| (width, others));
    Some(vec![others.iter().try_fold(1u64, |product, &n| product.checked_mul(n))?, width, channels])
}

/// The shape in a file's header.
fn shape_of_file(format: &str, file: BufReader<File>) -> Option<Vec<u64>> {
    if format == NPY.name {
        return Some(npyz::NpyFile::new(file).ok()?.shape().to_vec());
    }
    let meta = exr::meta::MetaData::read_from_buffered(file, false).ok()?;
    let header = meta.headers.first()?;
    let size = header.layer_size;
    Some(vec![size.height() as u64, size.width() as u64, header.channels.list.len() as u64])
}
