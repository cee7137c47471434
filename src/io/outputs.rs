//! The files that a command writes where the user says: all of them, or none.
//!
//! Each is written under a name that nothing else has, in the folder of its own; all get their names at the end, in one go.

use crate::base::error::{Error, Result};
use crate::io::disk::explain;
use crate::io::temporary::{Commit, Temporary};
use std::fs::{self, File};
use std::io::{self, ErrorKind, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use tempfile::{NamedTempFile, TempPath};

/// The files of one command.
///
/// A path that is a link stays one: the file that it leads to is replaced. What is no file, such as `/dev/stdout`, is written
/// to at the end. Two commands that write the same files do not mix them: the files are the one's or the other's.
#[derive(Debug, Default)]
pub(crate) struct Outputs {
    staged: Vec<Staged>,
    /// Folders that were made for them.
    folders: Vec<PathBuf>,
    temporaries: Vec<Temporary>,
}

/// A file that waits for its name.
#[derive(Debug)]
struct Staged {
    to: PathBuf,
    from: TempPath,
    /// Whether the name is that of a device or a pipe, which no file may replace.
    is_stream: bool,
}

/// A file under way.
#[derive(Debug)]
pub(crate) struct Output {
    to: PathBuf,
    file: NamedTempFile<File>,
    temporary: Temporary,
    is_stream: bool,
}

impl Outputs {
    /// Makes a folder for files of the command, if it is not there.
    pub fn folder(&mut self, dir: &Path) -> Result<()> {
        if dir.is_dir() {
            return Ok(());
        }
        let (temporary, ()) =
            Temporary::made(dir, || fs::create_dir_all(dir).map_err(explain("create the folder", dir)))?;
        self.temporaries.push(temporary);
        self.folders.push(dir.to_owned());
        Ok(())
    }

    /// Stages a file of these bytes.
    pub fn add(&mut self, path: &Path, bytes: impl AsRef<[u8]>) -> Result<()> {
        let mut output = Output::create(path)?;
        output.write_all(bytes.as_ref()).map_err(explain("write", path))?;
        self.take(output)
    }

    /// Stages a finished file.
    pub fn take(&mut self, output: Output) -> Result<()> {
        let Output { to, mut file, temporary, is_stream } = output;
        let flushed = file.flush().and_then(|()| file.as_file().sync_all());
        flushed.map_err(explain("write", &to))?;
        self.temporaries.push(temporary);
        self.staged.push(Staged { to, from: file.into_temp_path(), is_stream });
        Ok(())
    }

    /// Gives the files their names. If one cannot have its name, those that have theirs already give them back.
    pub fn commit(mut self) -> Result<()> {
        let commit = Commit::begin();
        let mut folders: Vec<_> = self.staged.iter().filter_map(|staged| staged.to.parent()).collect();
        folders.sort();
        folders.dedup();
        // Where folders can be locked, commands take turns; elsewhere files may mix, each of them whole.
        let locks: Vec<_> = folders.iter().filter_map(|folder| File::open(folder_of(folder)).ok()).collect();
        locks.iter().for_each(|folder| drop(folder.lock()));
        let mut replaced = Vec::new();
        for Staged { to, from, is_stream } in std::mem::take(&mut self.staged) {
            let put = if is_stream {
                pour(&from, &to)
            } else {
                replace(from, &to).map(|old| replaced.push((to.clone(), old)))
            };
            if let Err(error) = put {
                replaced.into_iter().rev().for_each(|(to, old)| old.restore(&to));
                return Err(explain("write", &to)(error));
            }
        }
        self.folders.clear();
        locks.iter().for_each(|folder| drop(folder.sync_all())); // the files themselves are on the disk
        commit.done();
        Ok(())
    }
}

impl Drop for Outputs {
    fn drop(&mut self) {
        self.staged.clear();
        for folder in self.folders.drain(..) {
            let _ = fs::remove_dir(folder); // only if it is empty
        }
    }
}

impl Output {
    /// Begins a file that will be `path`.
    ///
    /// # Errors
    /// When there can be no such file.
    pub fn create(path: &Path) -> Result<Self> {
        let old = match fs::metadata(path) {
            Ok(old) => Some(old),
            Err(error) if error.kind() == ErrorKind::NotFound && !path.is_symlink() => None,
            Err(error) if error.kind() == ErrorKind::NotFound => {
                let path = path.display();
                return Err(Error::input(format!("{path}: a link that leads to no file; give the file")));
            }
            Err(error) => return Err(explain("write", path)(error)),
        };
        if old.as_ref().is_some_and(fs::Metadata::is_dir) {
            return Err(Error::input(format!("{}: it is a folder; give a file", path.display())));
        }
        let is_stream = old.as_ref().is_some_and(|old| !old.is_file());
        let to = match path.is_symlink() && !is_stream {
            true => fs::canonicalize(path).map_err(explain("write", path))?,
            false => path.to_owned(),
        };
        let above = folder_of(to.parent().unwrap_or(Path::new("")));
        fs::metadata(above).map_err(explain("write", path))?;
        let name = to.file_name().unwrap_or_default().to_string_lossy();
        let folder = if is_stream { std::env::temp_dir() } else { above.to_owned() };
        let prefix = format!(".{}.", name.chars().take(60).collect::<String>());
        let mut builder = tempfile::Builder::new();
        builder.prefix(&prefix).suffix(".partial");
        // Made as any file is, with the permissions that the user wants of new files; never through a link.
        let file = builder
            .make_in(&folder, |path| File::options().read(true).write(true).create_new(true).open(path))
            .map_err(explain("write", path))?;
        let temporary = Temporary::new(file.path());
        if let Some(old) = old.filter(|_| !is_stream) {
            let _ = file.as_file().set_permissions(old.permissions()); // a file system may know none
        }
        Ok(Self { to, file, temporary, is_stream })
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Seek for Output {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

/// Writes files into a folder, which is made if it is not there: all, or none.
pub(crate) fn write_together(dir: &Path, files: &[(String, Vec<u8>)]) -> Result<()> {
    let mut outputs = Outputs::default();
    outputs.folder(dir)?;
    files.iter().try_for_each(|(name, bytes)| outputs.add(&dir.join(name), bytes))?;
    outputs.commit()
}

/// What had a name before.
enum Old {
    Nothing,
    File(TempPath),
    /// A file whose system gives no second names: it is gone.
    Lost,
}

/// Gives a file its name. Returns what had it before.
fn replace(from: TempPath, to: &Path) -> io::Result<Old> {
    let folder = folder_of(to.parent().unwrap_or(Path::new("")));
    let second_name = tempfile::Builder::new()
        .prefix(".old.")
        .suffix(".partial")
        .make_in(folder, |name| fs::hard_link(to, name));
    let old = match second_name {
        Ok(old) => Old::File(old.into_temp_path()),
        Err(error) if error.kind() == ErrorKind::NotFound => Old::Nothing,
        Err(_) => Old::Lost,
    };
    from.persist(to).map_err(|error| error.error)?;
    Ok(old)
}

impl Old {
    /// Takes a name back from a new file.
    fn restore(self, to: &Path) {
        let _ = match self {
            Self::Nothing => fs::remove_file(to),
            Self::File(old) => old.persist(to).map_err(|error| error.error),
            Self::Lost => Ok(()),
        };
    }
}

fn pour(from: &Path, to: &Path) -> io::Result<()> {
    io::copy(&mut File::open(from)?, &mut File::options().write(true).open(to)?).map(drop)
}

/// The folder that a path's parent names: none is the current one.
fn folder_of(parent: &Path) -> &Path {
    if parent.as_os_str().is_empty() { Path::new(".") } else { parent }
}
