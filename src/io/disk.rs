//! The operations on the disk that writing a set is made of. A test can let each of them fail, or the process die at it.

use crate::base::error::{Error, Result};
use std::fs::{self, File};
use std::io::{self, ErrorKind, Write};
use std::path::Path;

/// Stands before every operation.
#[cfg(not(test))]
fn step() -> io::Result<()> {
    Ok(())
}
#[cfg(test)]
use faults::step;

/// Whether something has this name, be it a link that leads nowhere. Unlike `Path::exists`, what cannot be found out is an
/// error.
pub(super) fn is_there(path: &Path) -> Result<bool> {
    match step().and_then(|()| path.symlink_metadata()) {
        Ok(_) => Ok(true),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(false),
        Err(error) => Err(explain("look at", path)(error)),
    }
}

/// Whether a folder has this name.
///
/// # Errors
/// When something else has it, such as a link to a folder: we did not make it.
pub(super) fn is_folder(path: &Path) -> Result<bool> {
    match step().and_then(|()| path.symlink_metadata()) {
        Ok(data) if data.is_dir() => Ok(true),
        Ok(_) => Err(Error::input(format!(
            "{}: gonio keeps files in a folder of this name, and this is none; move it away",
            path.display()
        ))),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(false),
        Err(error) => Err(explain("look at", path)(error)),
    }
}

/// Makes a folder that may be there already, and tells whether it was not.
pub(super) fn make_folder(path: &Path) -> Result<bool> {
    if is_folder(path)? {
        return Ok(false);
    }
    step().and_then(|()| fs::create_dir(path)).map_err(explain("create the folder", path))?;
    Ok(true)
}

/// Makes a folder and those above it.
pub(super) fn make_folders(path: &Path) -> Result<()> {
    step().and_then(|()| fs::create_dir_all(path)).map_err(explain("create the folder", path))
}

/// The names in a folder; none if it is not there.
pub(super) fn names(folder: &Path) -> Result<Vec<String>> {
    let read = || -> io::Result<Vec<String>> {
        step()?;
        let entries = fs::read_dir(folder)?.map(|entry| Ok(entry?.file_name().into_string().ok()));
        Ok(entries.collect::<io::Result<Vec<_>>>()?.into_iter().flatten().collect())
    };
    match read() {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(Vec::new()),
        names => names.map_err(explain("read", folder)),
    }
}

/// Writes a file to the disk itself, not only to the system's memory.
pub(super) fn save(path: &Path, bytes: &[u8]) -> Result<()> {
    let write = || {
        step()?;
        let mut file = File::create(path)?;
        step()?;
        file.write_all(bytes)?;
        step()?;
        flush(&file)
    };
    write().map_err(explain("write", path))
}

pub(super) fn read(path: &Path) -> io::Result<Vec<u8>> {
    step()?;
    fs::read(path)
}

/// Gives a file another name, in one step, whatever had that name before.
pub(super) fn rename(from: &Path, to: &Path) -> Result<()> {
    step().and_then(|()| fs::rename(from, to)).map_err(explain("write", to))
}

/// Gives a file a second name, or makes a copy where a file has only one.
pub(super) fn link(from: &Path, to: &Path) -> Result<()> {
    let link = step().and_then(|()| fs::hard_link(from, to));
    link.or_else(|_| step().and_then(|()| fs::copy(from, to)).map(drop)).map_err(explain("write", to))
}

/// Removes a file, or a link and not what it leads to; nothing if it is not there.
pub(super) fn remove(path: &Path) -> Result<()> {
    match step().and_then(|()| fs::remove_file(path)) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(explain("remove", path)(error)),
        _ => Ok(()),
    }
}

/// Removes a folder and the files in it that are `ours` by name. Whatever else is in it stays, and the folder with it.
///
/// # Errors
/// When a file cannot be removed, or something that is no folder has the name.
pub(super) fn clear(folder: &Path, ours: impl Fn(&str) -> bool) -> Result<()> {
    if !is_folder(folder)? {
        return Ok(());
    }
    for name in names(folder)?.iter().filter(|name| ours(name)) {
        let path = folder.join(name);
        if path.symlink_metadata().is_ok_and(|data| !data.is_dir()) {
            remove(&path)?;
        }
    }
    match step().and_then(|()| fs::remove_dir(folder)) {
        Err(error) if error.kind() == ErrorKind::DirectoryNotEmpty => Ok(()),
        removed => removed.map_err(explain("remove", folder)),
    }
}

/// Makes renames in a folder outlast a power cut, where a folder can be opened (not on Windows).
pub(super) fn sync(folder: &Path) -> Result<()> {
    if cfg!(unix) {
        let synced = step().and_then(|()| flush(&File::open(folder)?));
        synced.map_err(explain("write", folder))?;
    }
    Ok(())
}

fn flush(file: &File) -> io::Result<()> {
    if cfg!(test) { Ok(()) } else { file.sync_all() } // tests lose no power, and write thousands of files
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

#[cfg(test)]
pub(super) mod faults {
    //! Lets the n-th operation of a thread fail, or the process die there as far as the disk can tell.

    use std::cell::Cell;
    use std::io;

    /// What happens at an operation.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub enum DiskFault {
        /// It fails, and the process goes on.
        Error,
        /// Nothing is done any more, as if the process had been killed.
        Kill,
    }

    thread_local! {
        static STEPS: Cell<usize> = const { Cell::new(0) };
        static PLAN: Cell<Option<(usize, DiskFault)>> = const { Cell::new(None) };
    }

    /// Runs `work` with a fault at its `n`-th operation. Returns also whether it got so far.
    pub fn run<T>(n: usize, fault: DiskFault, work: impl FnOnce() -> T) -> (T, bool) {
        STEPS.set(0);
        PLAN.set(Some((n, fault)));
        let result = work();
        PLAN.set(None);
        (result, STEPS.get() > n)
    }

    pub fn step() -> io::Result<()> {
        let step = STEPS.replace(STEPS.get() + 1);
        match PLAN.get() {
            Some((n, DiskFault::Error)) if step == n => Err(io::Error::other("a fault of the test")),
            Some((n, DiskFault::Kill)) if step >= n => Err(io::Error::other("the test killed the process")),
            _ => Ok(()),
        }
    }
}
