//! A set of tables and its manifest, written all or nothing.

#[cfg(test)]
mod faults;

use crate::base::error::{Error, Result};
use crate::io::disk;
use crate::io::disk::explain;
use crate::io::format::Streamed;
use crate::io::manifest;
use crate::io::manifest::{Listed, MANIFEST};
use crate::io::stream;
use crate::io::stream::Tiles;
use crate::io::temporary::{Commit, Temporary};
use crate::io::{Format, Provenance};
use crate::table::Table;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{File, TryLockError};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// The folder of the files that the manifest lists, named by their content.
const FILES: &str = "files";
/// Where files wait for the commit.
pub(super) const STAGING: &str = ".gonio-staging";
/// Finished tiles of tables that are too large for memory. A bake that was killed finds them again.
const PARTIAL: &str = ".gonio-partial";
/// Held while a bake runs. It stays behind: removing a lock file is a race.
const LOCK: &str = ".gonio.lock";
/// The digits of a file's SHA-256 that are in its name.
const DIGITS: usize = 12;

/// What is in the folder of a set that is not finished.
#[cfg(feature = "cli")]
pub(super) const UNFINISHED: [(&str, &str); 2] = [
    (STAGING, "a bake was killed, or is under way; the next one removes it"),
    (PARTIAL, "tiles of a large table that was not finished; the same bake goes on with them"),
];

/// Writes a set of tables and its manifest into a folder, all or nothing.
///
/// Files go to `.gonio-staging` first. [`commit`](Self::commit) then
/// 1. renames each file to `files/NAME.HASH.EXTENSION`, a name that no other content has: no reader knows it yet;
/// 2. renames the manifest, which lists these names, to `manifest.json`: **the commit point**;
/// 3. gives each file its plain name too, `NAME.EXTENSION` beside the manifest: a hard link, or a copy where a file has one
///    name only;
/// 4. removes the files of the old set;
/// 5. removes the staging folder.
///
/// So whoever opens `manifest.json` and then the files that it lists has the old set or the new one, after a kill or a
/// failure at any point. Plain names are for people and for programs that know no manifest: they change one by one, after the
/// commit point. The next bake finishes steps 3 to 5 of one that was killed. Files that are not of the set are never touched.
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
    /// The files staged so far, by their plain names.
    staged: BTreeMap<String, Listed>,
    /// The names that this set has put into `files`, and that nothing had before.
    placed: Vec<PathBuf>,
    /// Whether it has made `files`.
    made_files: bool,
    committed: bool,
    temporaries: Vec<Temporary>,
    /// Whether the folder was made here: then it goes again if nothing comes of it.
    is_new: bool,
    _lock: File,
}

/// The files of one table and their hashes, by format.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Files {
    /// File names, from the set's folder.
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
        let is_new = !disk::is_there(dir)?;
        manifest::read(&dir.join(MANIFEST))?; // nothing is made where it is somebody else's
        disk::make_folders(dir)?;
        let mut temporaries = Vec::new();
        if is_new {
            temporaries.extend([dir.to_owned(), dir.join(LOCK)].map(|path| Temporary::new(&path)));
        }
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
        let (stems, staged, placed) = Default::default();
        let old = Vec::new();
        let (made_files, committed) = (false, false);
        let dir = dir.to_owned();
        let mut set =
            Self { dir, old, stems, staged, placed, made_files, committed, temporaries, is_new, _lock: lock };
        let dir = &set.dir;
        let staging = dir.join(STAGING);
        if disk::is_folder(&staging)? {
            // A bake was killed. What it left unfinished is not this one's failure.
            let _ = finish(dir);
            disk::clear(&staging, |_| true)?;
        }
        set.old = manifest::read(&dir.join(MANIFEST))?.as_ref().map(manifest::listed).unwrap_or_default();
        let (temporary, _) = Temporary::made(&staging, || disk::make_folder(&staging))?;
        set.temporaries.push(temporary);
        Ok(set)
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
            disk::save(&self.dir.join(STAGING).join(&name), &bytes)?;
            let staged = self.stage(name, manifest::hash(&bytes));
            written.sha256.insert(format.name, staged.sha256);
            written.files.insert(format.name, staged.name);
        }
        Ok(written)
    }

    /// Adds a file of another kind, a picture or a page. Returns its name in the manifest's `files`, and its SHA-256, which
    /// belongs beside the name.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub(crate) fn add(&mut self, name: &str, bytes: &[u8]) -> Result<(String, String)> {
        self.refuse_foreign(name)?;
        disk::save(&self.dir.join(STAGING).join(name), bytes)?;
        let staged = self.stage(name.to_owned(), manifest::hash(bytes));
        Ok((staged.name, staged.sha256))
    }

    /// Notes a staged file. Returns what the manifest says of it.
    fn stage(&mut self, plain: String, sha256: String) -> Listed {
        let listed = Listed { name: listed_name(&plain, &sha256), sha256 };
        self.staged.insert(plain, listed.clone());
        listed
    }

    /// Where the tiles of a streamed table are kept; `keys` name all that this bake streams, and tiles of
    /// anything else go.
    ///
    /// # Errors
    /// When the folder cannot be written.
    pub(crate) fn tiles(&self, keys: &BTreeSet<String>, key: &str) -> Result<Tiles> {
        let partial = self.dir.join(PARTIAL);
        let dir = partial.join(key);
        disk::make_folder(&partial)?;
        disk::make_folder(&dir)?;
        for name in disk::names(&partial)? {
            if is_key(&name) && !keys.contains(&name) {
                disk::clear(&partial.join(name), stream::is_tile)?;
            }
        }
        Ok(Tiles::new(dir))
    }

    /// Drops all tiles: nothing will come of them.
    pub(crate) fn discard_tiles(&self) -> Result<()> {
        let partial = self.dir.join(PARTIAL);
        if !disk::is_folder(&partial).unwrap_or(false) {
            return Ok(()); // what is no folder is not ours
        }
        for name in disk::names(&partial)?.iter().filter(|name| is_key(name)) {
            disk::clear(&partial.join(name), stream::is_tile)?;
        }
        disk::clear(&partial, |_| false)
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
                    disk::save(&path, &bytes)?;
                    manifest::hash(&bytes)
                }
            };
            let staged = self.stage(name, sha256);
            written.sha256.insert(format.name, staged.sha256);
            written.files.insert(format.name, staged.name);
        }
        Ok(written)
    }

    /// Replaces the old set by the new one. `manifest` must be an object with `schema`, `gonio` and
    /// `tables`, the latter [`TableEntry`](crate::io::TableEntry)s of every table written.
    ///
    /// # Errors
    /// Before the commit point the old set stays. After it the new set is what the manifest lists: an error then says what
    /// stands in the way of the plain names, and the next bake finishes them.
    pub fn commit(mut self, manifest: &impl Serialize) -> Result<()> {
        let path = self.dir.join(STAGING).join(MANIFEST);
        disk::save(&path, &manifest::to_json(manifest)?)?;
        let listed = manifest::read(&path)?.as_ref().map(manifest::listed).unwrap_or_default();
        let listed: BTreeSet<_> = listed.into_iter().map(|file| file.name).collect();
        let staged: BTreeSet<_> = self.staged.values().map(|file| file.name.clone()).collect();
        if listed != staged {
            let odd: Vec<_> = listed.symmetric_difference(&staged).collect();
            return Err(Error::Internal(format!("{MANIFEST} and the files written differ in {odd:?}")));
        }
        let commit = Commit::begin();
        self.place()?;
        disk::rename(&path, &self.dir.join(MANIFEST))?;
        self.committed = true;
        let finished = disk::sync(&self.dir).and_then(|()| finish(&self.dir));
        commit.done();
        finished.map_err(|error| match error {
            Error::Io { path, action, source } => Error::Io {
                path,
                action,
                source: io::Error::new(
                    source.kind(),
                    format!("{source}; {MANIFEST} lists the new set already"),
                ),
            },
            other => other,
        })?;
        disk::clear(&self.dir.join(STAGING), |_| true)?;
        self.discard_tiles()
    }

    /// Step 1 of the commit.
    fn place(&mut self) -> Result<()> {
        let files = self.dir.join(FILES);
        self.made_files = disk::make_folder(&files)?;
        for (plain, listed) in &self.staged {
            let place = self.dir.join(&listed.name);
            if !disk::is_there(&place)? {
                self.placed.push(place.clone());
            }
            disk::rename(&self.dir.join(STAGING).join(plain), &place)?;
        }
        disk::sync(&files)
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
        if self.old.iter().any(|old| plain_name(&old.name) == name) || !disk::is_there(&path)? {
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
            return; // what is staged says to the next bake that something is unfinished
        }
        // Whatever stays is cleared by the next bake.
        for path in &self.placed {
            let _ = disk::remove(path);
        }
        let _ = disk::clear(&self.dir.join(STAGING), |_| true);
        if self.made_files {
            let _ = disk::clear(&self.dir.join(FILES), |_| false);
        }
        if self.is_new {
            let _ = disk::remove(&self.dir.join(LOCK));
            let _ = disk::clear(&self.dir, |_| false);
        }
    }
}

/// Steps 3 and 4 of the commit, from wherever a kill left them: plain names lead to the files that the manifest lists, and
/// `files` has no others. The caller holds the lock.
///
/// # Errors
/// The first; what can be done is done nevertheless.
fn finish(dir: &Path) -> Result<()> {
    let listed = manifest::read(&dir.join(MANIFEST))?.as_ref().map(manifest::listed).unwrap_or_default();
    let mut done = Ok(());
    for file in &listed {
        let plain = plain_name(&file.name);
        let temporary = dir.join(STAGING).join(&plain);
        let renew = || {
            disk::remove(&temporary)?;
            disk::link(&dir.join(&file.name), &temporary)?;
            disk::rename(&temporary, &dir.join(&plain))
        };
        done = done.and(renew());
    }
    done = done.and(disk::sync(dir));

    // Without regard to case: on some file systems Gold.exr and gold.exr are one file.
    let kept: BTreeSet<_> = listed
        .iter()
        .flat_map(|file| [file.name.to_lowercase(), plain_name(&file.name).to_lowercase()])
        .collect();
    for name in leftovers(dir, &listed)? {
        let plain = plain_name(&name);
        // A name alone does not make a file ours. The plain name goes first: nobody could tell it later.
        let is_ours = !kept.contains(&plain.to_lowercase()) && has_content(&dir.join(&plain), &name);
        let removed = if is_ours { disk::remove(&dir.join(&plain)) } else { Ok(()) };
        let removed = removed.and_then(|()| match kept.contains(&name.to_lowercase()) {
            true => Ok(()),
            false => disk::remove(&dir.join(&name)),
        });
        done = done.and(removed);
    }
    done
}

/// The files in `files` that a manifest does not list and that gonio made: their names tell their content.
pub(super) fn leftovers(dir: &Path, listed: &[Listed]) -> Result<Vec<String>> {
    let names = disk::names(&dir.join(FILES))?.into_iter().map(|name| format!("{FILES}/{name}"));
    let unlisted = names.filter(|name| listed.iter().all(|file| file.name != *name));
    Ok(unlisted.filter(|name| manifest::is_plain(name) && has_content(&dir.join(name), name)).collect())
}

/// Whether a file, which is no link, has the content that a listed name tells.
fn has_content(path: &Path, listed: &str) -> bool {
    let is_file = path.symlink_metadata().is_ok_and(|data| data.is_file());
    is_file
        && parts(listed)
            .is_some_and(|[_, digits, _]| manifest::sha256(path).is_ok_and(|hash| hash.starts_with(digits)))
}

/// `files/NAME.HASH.EXTENSION` of a plain name and a hash.
fn listed_name(plain: &str, sha256: &str) -> String {
    let (stem, extension) = plain.rsplit_once('.').unwrap_or((plain, ""));
    format!("{FILES}/{stem}.{}.{extension}", &sha256[..DIGITS])
}

/// The plain name of a file that a manifest lists.
pub(super) fn plain_name(listed: &str) -> String {
    match parts(listed) {
        Some([stem, _, extension]) => format!("{stem}.{extension}"),
        None => listed.to_owned(),
    }
}

/// The stem, the digits of the hash and the extension of a listed name.
fn parts(listed: &str) -> Option<[&str; 3]> {
    let name = listed.strip_prefix(FILES)?.strip_prefix('/')?;
    let (name, extension) = name.rsplit_once('.')?;
    let (stem, digits) = name.rsplit_once('.')?;
    let is_hex = digits.len() == DIGITS && digits.bytes().all(|b| b.is_ascii_hexdigit());
    is_hex.then_some([stem, digits, extension])
}

/// Whether a folder of tiles has this name, see [`TableSet::tiles`].
fn is_key(name: &str) -> bool {
    name.len() == 32 && name.bytes().all(|b| b.is_ascii_hexdigit())
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
    if path.is_symlink() {
        return Err(Error::input(format!("{}: it is a link; remove it", path.display())));
    }
    File::options().create(true).truncate(false).write(true).open(&path).map_err(explain("write", &path))
}

/// Some network file systems have no locks: there the user takes care.
fn lockless(error: io::Error, dir: &Path) -> Result<()> {
    if error.kind() == ErrorKind::Unsupported { Ok(()) } else { Err(explain("lock", dir)(error)) }
}
