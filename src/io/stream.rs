//! Tables larger than memory: finished tiles on disk, and the files that are put together from them.
//!
//! The header of a file has the table's error, which is known at the end: so tiles are kept first, and
//! the files written in one go from front to back, hashed as they grow.

use crate::base::error::{Error, Result};
use crate::io::Provenance;
use crate::io::disk::explain;
use crate::io::format::BeginRows;
use crate::table::Table;
use sha2::{Digest, Sha256};
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// The finished tiles of one table, by number: little-endian f32, then their SHA-256. A tile that was cut
/// off or damaged does not match its hash and counts as not there.
#[derive(Debug)]
pub(crate) struct Tiles {
    dir: PathBuf,
}

const HASH: usize = 32;

impl Tiles {
    pub fn new(dir: PathBuf) -> Self {
        Self { dir }
    }

    /// A finished tile of so many values, if it is there and whole.
    pub fn load(&self, k: usize, count: usize) -> Option<Vec<f32>> {
        let bytes = fs::read(self.path(k)).ok()?;
        let (values, hash) = bytes.split_at_checked(4 * count)?;
        (Sha256::digest(values)[..] == *hash).then(|| floats(values))
    }

    /// Whether a tile seems to be there. One that cannot be looked at is computed again.
    pub fn has(&self, k: usize) -> bool {
        self.path(k).exists()
    }

    pub fn store(&self, k: usize, values: &[f32]) -> Result<()> {
        let mut bytes: Vec<u8> = Vec::with_capacity(4 * values.len() + HASH);
        bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
        bytes.extend(Sha256::digest(&bytes));
        let path = self.path(k);
        fs::write(&path, bytes).map_err(explain("write", &path))
    }

    /// Tile after tile, to the first that is not there.
    fn each(&self) -> impl Iterator<Item = Result<Vec<f32>>> {
        let read = |path: PathBuf| match fs::read(&path) {
            Ok(bytes) => Some(Ok(floats(&bytes[..bytes.len().saturating_sub(HASH)]))),
            Err(error) if error.kind() == io::ErrorKind::NotFound => None,
            Err(error) => Some(Err(explain("read", &path)(error))),
        };
        (0..).map(|k| self.path(k)).map_while(read)
    }

    fn path(&self, k: usize) -> PathBuf {
        self.dir.join(format!("{k:06}.tile"))
    }
}

/// Whether a tile's file has this name.
pub(super) fn is_tile(name: &str) -> bool {
    name.strip_suffix(".tile").is_some_and(|k| k.len() >= 6 && k.bytes().all(|b| b.is_ascii_digit()))
}

fn floats(bytes: &[u8]) -> Vec<f32> {
    bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
}

/// Writes a table's file from its tiles, row by row. Returns the SHA-256 of
/// the file.
pub(super) fn write(
    begin: BeginRows,
    table: &Table,
    tiles: &Tiles,
    provenance: &Provenance,
    path: &Path,
    tick: &mut dyn FnMut(f64) -> Result<()>,
) -> Result<String> {
    let mut bytes = Vec::new();
    let mut rows = begin(table, provenance, &mut bytes)?;
    let file = File::create(path).map_err(explain("write", path))?;
    let mut out = Hashed { file: BufWriter::new(file), hash: Sha256::new() };
    out.write_all(&bytes).map_err(explain("write", path))?;

    let (width, height) = table.image_size();
    let row = width * table.channels.len();
    let mut y = 0;
    for tile in tiles.each() {
        let tile = tile?;
        bytes.clear();
        for texels in tile.chunks_exact(row) {
            rows.append(texels, &mut bytes);
            y += 1;
        }
        out.write_all(&bytes).map_err(explain("write", path))?;
        tick((tile.len() / row) as f64 / height as f64)?;
    }
    if y != height {
        return Err(Error::Internal(format!("table {}: {y} of {height} rows are in its tiles", table.name)));
    }
    bytes.clear();
    rows.finish(&mut bytes);
    out.write_all(&bytes).map_err(explain("write", path))?;
    out.finish().map_err(explain("write", path))
}

/// A file and the hash of what went into it.
struct Hashed {
    file: BufWriter<File>,
    hash: Sha256,
}

impl Hashed {
    fn write_all(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.hash.update(bytes);
        self.file.write_all(bytes)
    }

    fn finish(self) -> io::Result<String> {
        self.file.into_inner().map_err(io::IntoInnerError::into_error)?.sync_all()?;
        Ok(crate::io::manifest::hex(&self.hash.finalize()))
    }
}
