//! A set of tables and its manifest, written all or nothing.

use crate::base::error::{Error, Result};
use crate::io::format::Streamed;
use crate::io::manifest;
use crate::io::manifest::{Listed, MANIFEST};
use crate::io::stream;
use crate::io::stream::Tiles;
use crate::io::{Format, Provenance};
use crate::table::Table;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File, TryLockError};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Where files wait for the commit.
const STAGING: &str = ".gonio-staging";
/// Finished tiles of tables that are too large for memory. A bake that was killed finds them again.
const PARTIAL: &str = ".gonio-partial";
/// The new manifest from the commit point until every table is in its place.
const NEXT: &str = "manifest.json.next";
/// Held while a bake runs. It stays behind: removing a lock file is a race.
const LOCK: &str = ".gonio.lock";

/// Writes a set of tables and its manifest into a folder, all or nothing.
///
/// Files go to `.gonio-staging` first. [`commit`](Self::commit) then
/// 1. renames the finished manifest to `manifest.json.next`: **the commit point**;
/// 2. renames each table into place;
/// 3. removes the files that the old manifest lists and the new one does not;
/// 4. renames `manifest.json.next` to `manifest.json`;
/// 5. removes the staging folder.
///
/// Whoever comes after a kill ([`create`](Self::create), [`read_manifest`](crate::io::read_manifest)) finds
/// `manifest.json.next` and does steps 2 to 5 again, or does not find it and drops the staging folder. So
/// readers see the old set or the new one. Files that are not of the set are never touched.
///
/// Tables larger than memory come in tiles, which wait in `.gonio-partial` until the commit. They outlast a
/// bake that was cut off, under a name that stands for all that made them.
#[derive(Debug)]
pub struct TableSet {
    dir: PathBuf,
    /// The files of the set that is being replaced.
    old: Vec<Listed>,
    /// The stems taken so far, in lower case.
    stems: BTreeSet<String>,
    /// The files staged so far.
    staged: BTreeSet<String>,
    /// Whether the folder was made here: then it goes again if nothing comes of it.
    is_new: bool,
    committed: bool,
    _lock: File,
}

/// The files of one table and their hashes, by format.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Files {
    /// File names in the set's folder.
    pub files: BTreeMap<&'static str, String>,
    /// SHA-256 of each file, in hexadecimal.
    pub sha256: BTreeMap<&'static str, String>,
}

impl TableSet {
    /// Begins a set in `dir`, which is made if it is not there. The set that is there stays as it is
    /// until [`commit`](Self::commit).
    ///
    /// # Errors
    /// When the folder cannot be written, another bake is writing into it, or it holds a `manifest.json`
    /// that is not ours.
    pub fn create(dir: &Path) -> Result<Self> {
        let is_new = !dir.exists();
        fs::create_dir_all(dir).map_err(explain("create the folder", dir))?;
        let lock = open_lock(dir)?;
        match lock.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let dir = dir.display();
                return Err(Error::input(format!(
                    "{dir}: another bake is writing here; wait for it or give another folder"
                )));
            }
            Err(TryLockError::Error(error)) => lockless(error, dir)?,
        }
        complete_or_discard(dir)?;
        let old = manifest::read(&dir.join(MANIFEST))?.as_ref().map(manifest::listed).unwrap_or_default();
        let staging = dir.join(STAGING);
        fs::create_dir(&staging).map_err(explain("create the folder", &staging))?;
        Ok(Self {
            dir: dir.to_owned(),
            old,
            stems: BTreeSet::new(),
            staged: BTreeSet::new(),
            is_new,
            committed: false,
            _lock: lock,
        })
    }

    /// Adds a table in the given formats; nothing shows before [`commit`](Self::commit).
    ///
    /// # Errors
    /// When a file cannot be written, or one of that name is there which is not of the old set.
    pub fn write(
        &mut self,
        table: &Table,
        formats: &[&'static Format],
        provenance: &Provenance,
    ) -> Result<Files> {
        let stem = self.free_stem(&table.name);
        let mut written = Files { files: BTreeMap::new(), sha256: BTreeMap::new() };
        for &format in formats {
            let name = format!("{stem}.{}", format.extension);
            self.refuse_foreign(&name)?;
            let bytes = format.encode(table, provenance)?;
            save(&self.dir.join(STAGING).join(&name), &bytes)?;
            written.sha256.insert(format.name, manifest::hash(&bytes));
            self.staged.insert(name.clone());
            written.files.insert(format.name, name);
        }
        Ok(written)
    }

    /// Adds a file of another kind, a picture or a page, under its own name. Returns its SHA-256, which
    /// belongs beside the name in the manifest's `files`.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub(crate) fn add(&mut self, name: &str, bytes: &[u8]) -> Result<String> {
        self.refuse_foreign(name)?;
        save(&self.dir.join(STAGING).join(name), bytes)?;
        self.staged.insert(name.to_owned());
        Ok(manifest::hash(bytes))
    }

    /// Where the tiles of a streamed table are kept; `keys` name all that this bake streams, and tiles of
    /// anything else go.
    ///
    /// # Errors
    /// When the folder cannot be written.
    pub(crate) fn tiles(&self, keys: &BTreeSet<String>, key: &str) -> Result<Tiles> {
        let partial = self.dir.join(PARTIAL);
        let dir = partial.join(key);
        fs::create_dir_all(&dir).map_err(explain("create the folder", &dir))?;
        for entry in fs::read_dir(&partial).map_err(explain("read", &partial))? {
            let path = entry.map_err(explain("read", &partial))?.path();
            let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
            if !keys.contains(name) {
                clear(&path)?;
            }
        }
        Ok(Tiles::new(dir))
    }

    /// Drops all tiles: nothing will come of them.
    pub(crate) fn discard_tiles(&self) -> Result<()> {
        clear(&self.dir.join(PARTIAL))
    }

    /// Adds a table whose values are in `tiles`; `preview` is a part of it, to look at.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub(crate) fn write_streamed(
        &mut self,
        table: &Table,
        tiles: &Tiles,
        preview: &Table,
        formats: &[&'static Format],
        provenance: &Provenance,
        tick: &mut dyn FnMut(f64) -> Result<()>,
    ) -> Result<Files> {
        let stem = self.free_stem(&table.name);
        let mut written = Files { files: BTreeMap::new(), sha256: BTreeMap::new() };
        for &format in formats {
            let name = format!("{stem}.{}", format.extension);
            self.refuse_foreign(&name)?;
            let path = self.dir.join(STAGING).join(&name);
            let share = 1.0 / formats.len() as f64;
            let sha256 = match format.streamed {
                Streamed::Rows(begin) => {
                    stream::write(begin, table, tiles, provenance, &path, &mut |part| tick(share * part))?
                }
                Streamed::Preview => {
                    let bytes = format.encode(preview, provenance)?;
                    save(&path, &bytes)?;
                    manifest::hash(&bytes)
                }
            };
            written.sha256.insert(format.name, sha256);
            self.staged.insert(name.clone());
            written.files.insert(format.name, name);
        }
        Ok(written)
    }

    /// Replaces the old set by the new one. `manifest` must be an object with `schema`, `gonio` and
    /// `tables`, the latter [`TableEntry`](crate::io::TableEntry)s of every table written.
    ///
    /// # Errors
    /// Before the commit point the old set stays. After it the new set is what readers get: an error then
    /// says what stands in the way of the last renames, and the next bake or reading finishes them.
    pub fn commit(mut self, manifest: &impl Serialize) -> Result<()> {
        let staging = self.dir.join(STAGING);
        let path = staging.join(MANIFEST);
        save(&path, &manifest::to_json(manifest)?)?;
        let listed = manifest::read(&path)?.as_ref().map(manifest::listed).unwrap_or_default();
        let listed: BTreeSet<_> = listed.into_iter().map(|file| file.name).collect();
        if listed != self.staged {
            let odd: Vec<_> = listed.symmetric_difference(&self.staged).collect();
            return Err(Error::Internal(format!("{MANIFEST} and the files written differ in {odd:?}")));
        }
        sync_folder(&staging)?;
        rename(&path, &self.dir.join(NEXT))?;
        self.committed = true;
        sync_folder(&self.dir)?;
        roll_forward(&self.dir)?;
        self.discard_tiles()
    }

    /// A stem that is safe on every file system and new to this set.
    fn free_stem(&mut self, name: &str) -> String {
        let stem = safe_stem(name);
        let numbered = (2u32..).map(|k| format!("{stem}-{k}"));
        let mut free = std::iter::once(stem.clone()).chain(numbered);
        let stem = free.find(|stem| !self.stems.contains(&stem.to_lowercase())).unwrap_or(stem);
        self.stems.insert(stem.to_lowercase());
        stem
    }

    /// Refuses a name that a file has which is not of the old set.
    pub(crate) fn refuse_foreign(&self, name: &str) -> Result<()> {
        let path = self.dir.join(name);
        if path.symlink_metadata().is_err() || self.old.iter().any(|old| old.name == name) {
            return Ok(());
        }
        Err(Error::input(format!(
            "{}: already there, and not a file of the set that {MANIFEST} lists; move it away or give \
             another folder",
            path.display()
        )))
    }
}

impl Drop for TableSet {
    fn drop(&mut self) {
        if self.committed {
            return; // readers and the next bake may need what is staged
        }
        // Whatever stays is cleared by the next bake.
        let _ = fs::remove_dir_all(self.dir.join(STAGING));
        if self.is_new {
            let _ = fs::remove_file(self.dir.join(LOCK));
            let _ = fs::remove_dir(&self.dir); // only if it is empty
        }
    }
}

/// Finishes a commit that was cut off, if there is one; waits if a bake is just committing.
pub(super) fn recover(dir: &Path) -> Result<()> {
    if !dir.join(NEXT).exists() {
        return Ok(()); // also where the folder cannot be written: reading needs no more
    }
    let lock = open_lock(dir)?;
    lock.lock().or_else(|error| lockless(error, dir))?;
    complete_or_discard(dir)
}

/// Completes the new set if it was committed, else keeps the old one. The caller holds the lock.
fn complete_or_discard(dir: &Path) -> Result<()> {
    if dir.join(NEXT).exists() { roll_forward(dir) } else { clear(&dir.join(STAGING)) }
}

/// Steps 2 to 5 of the commit, from wherever a kill left it.
fn roll_forward(dir: &Path) -> Result<()> {
    let (staging, next, current) = (dir.join(STAGING), dir.join(NEXT), dir.join(MANIFEST));
    let files = |path: &Path| -> Result<Vec<Listed>> {
        Ok(manifest::read(path)?.as_ref().map(manifest::listed).unwrap_or_default())
    };
    let (new, old) = (files(&next)?, files(&current)?);

    for file in &new {
        let staged = staging.join(&file.name);
        if staged.exists() {
            rename(&staged, &dir.join(&file.name))?;
        }
    }
    sync_folder(dir)?;

    // Without regard to case: on some file systems Gold.exr and gold.exr are one file.
    let kept: BTreeSet<_> = new.iter().map(|file| file.name.to_lowercase()).collect();
    for file in old.iter().filter(|file| !kept.contains(&file.name.to_lowercase())) {
        let path = dir.join(&file.name);
        let is_file = path.symlink_metadata().is_ok_and(|data| data.is_file());
        // The name alone does not make it ours: somebody may have put another file there.
        if is_file && fs::read(&path).is_ok_and(|bytes| manifest::hash(&bytes) == file.sha256) {
            let _ = fs::remove_file(&path); // a left-over harms nobody
        }
    }

    rename(&next, &current)?;
    sync_folder(dir)?;
    clear(&staging)
}

/// A file stem of ASCII letters, digits, `.`, `-` and `_`, that no system takes for something else.
fn safe_stem(name: &str) -> String {
    const LONGEST: usize = 100;
    let plain = |c: char| if c.is_ascii_alphanumeric() || ".-_".contains(c) { c } else { '_' };
    let stem: String = name.chars().map(plain).take(LONGEST).collect();
    // A leading dot hides a file, a leading dash looks like an option, Windows drops a trailing dot.
    let stem = stem.trim_start_matches(['.', '-']).trim_end_matches('.');
    let device = stem.split('.').next().unwrap_or_default().to_ascii_uppercase();
    let numbered = |port: &str| device.strip_prefix(port).is_some_and(|n| n.len() == 1);
    let reserved = ["", "CON", "PRN", "AUX", "NUL"].contains(&device.as_str());
    // Windows keeps these names for devices, with any extension.
    if reserved || numbered("COM") || numbered("LPT") { format!("_{stem}") } else { stem.to_owned() }
}

fn open_lock(dir: &Path) -> Result<File> {
    let path = dir.join(LOCK);
    File::options().create(true).truncate(false).write(true).open(&path).map_err(explain("write", &path))
}

/// Some network file systems have no locks: there the user takes care.
fn lockless(error: io::Error, dir: &Path) -> Result<()> {
    if error.kind() == ErrorKind::Unsupported { Ok(()) } else { Err(explain("lock", dir)(error)) }
}

fn save(path: &Path, bytes: &[u8]) -> Result<()> {
    let write = || {
        let mut file = File::create(path)?;
        file.write_all(bytes)?;
        file.sync_all()
    };
    write().map_err(explain("write", path))
}

fn rename(from: &Path, to: &Path) -> Result<()> {
    fs::rename(from, to).map_err(explain("write", to))
}

fn clear(staging: &Path) -> Result<()> {
    match fs::remove_dir_all(staging) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(explain("remove", staging)(error)),
        _ => Ok(()),
    }
}

/// Makes renames in a folder outlast a power cut, where a folder can be opened (not on Windows).
fn sync_folder(dir: &Path) -> Result<()> {
    if cfg!(unix) {
        File::open(dir).and_then(|dir| dir.sync_all()).map_err(explain("write", dir))?;
    }
    Ok(())
}

/// An error that names the path and, where there is one, the remedy.
pub(super) fn explain(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Error {
    let path = path.to_owned();
    move |error| {
        let remedy = match error.kind() {
            ErrorKind::StorageFull | ErrorKind::QuotaExceeded => "; free some space or give another folder",
            ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
                "; give a folder that you may write to"
            }
            ErrorKind::AlreadyExists | ErrorKind::NotADirectory => "; it is not a folder: give another",
            _ => "",
        };
        Error::io(action, path)(io::Error::new(error.kind(), format!("{error}{remedy}")))
    }
}
