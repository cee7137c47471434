//! The temporary files of this process, so that a command that is asked to stop can end at once: it waits until no commit is
//! in the middle, removes them and exits.

use crate::base::error::Result;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What exists only until a commit, in the order in which it was made.
static TEMPORARIES: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());
/// Held while outputs are put into their places; whether any were.
static COMMIT: Mutex<bool> = Mutex::new(false);

/// A file or folder that is removed if the command ends before it does.
#[derive(Debug)]
pub(super) struct Temporary(PathBuf);

impl Temporary {
    pub fn new(path: &Path) -> Self {
        temporaries().push(path.to_owned());
        Self(path.to_owned())
    }

    /// Makes a file or folder, and only then calls it temporary: what was there before is not ours.
    pub fn made<T>(path: &Path, make: impl FnOnce() -> Result<T>) -> Result<(Self, T)> {
        // A command that ends in between must find it in the list.
        let mut list = temporaries();
        let made = make()?;
        list.push(path.to_owned());
        Ok((Self(path.to_owned()), made))
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        temporaries().retain(|path| *path != self.0);
    }
}

/// The time in which a command does not end: its outputs are being put into their places.
pub(super) struct Commit(MutexGuard<'static, bool>);

impl Commit {
    pub fn begin() -> Self {
        Self(COMMIT.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Notes that outputs are in place.
    pub fn done(mut self) {
        *self.0 = true;
    }
}

/// Waits for a commit, allows no other, and removes all temporaries. Returns whether this process has put outputs into their
/// places.
#[cfg(feature = "cli")]
pub(crate) fn abandon() -> bool {
    let commit = Commit::begin();
    let mut list = temporaries();
    while let Some(path) = list.pop() {
        // A folder goes if it holds only what was made beside it: the last made goes first.
        let _ = if path.is_dir() { remove_folder(&path) } else { fs::remove_file(&path) };
    }
    let done = *commit.0;
    // Threads that are still at work must neither commit nor begin a file.
    std::mem::forget((commit, list));
    done
}

/// Removes a folder of ours and the files in it.
#[cfg(feature = "cli")]
fn remove_folder(path: &Path) -> std::io::Result<()> {
    if path.file_name().is_some_and(|name| name == super::set::STAGING) {
        for entry in fs::read_dir(path)? {
            fs::remove_file(entry?.path())?;
        }
    }
    fs::remove_dir(path)
}

fn temporaries() -> MutexGuard<'static, Vec<PathBuf>> {
    TEMPORARIES.lock().unwrap_or_else(PoisonError::into_inner)
}
