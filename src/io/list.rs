//! Values at a list of points, written as they come: NPY (n, channels) in float32, or CSV with a header.
//! What was there stays until all of it is there.

use crate::base::error::{Error, Result};
use crate::io::format::npy;
use crate::io::outputs::{Output, Outputs};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// The format of a list.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ListFormat {
    Npy,
    Csv,
}

impl ListFormat {
    /// By a file's extension.
    pub fn of(path: &Path) -> Result<Self> {
        match path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase().as_str() {
            "npy" => Ok(Self::Npy),
            "csv" => Ok(Self::Csv),
            _ => Err(Error::input(format!("{}: its name must end in .npy or .csv", path.display()))),
        }
    }
}

/// A file under way.
pub(crate) struct List {
    path: PathBuf,
    file: BufWriter<Output>,
    format: ListFormat,
    channels: usize,
    values: u64,
}

impl List {
    /// Begins a file, see [`Output`].
    ///
    /// # Errors
    /// When it cannot be written, or its name says no format.
    pub fn create(path: &Path, channels: &[String]) -> Result<Self> {
        let format = ListFormat::of(path)?;
        let mut list = Self {
            path: path.to_owned(),
            file: BufWriter::new(Output::create(path)?),
            format,
            channels: channels.len(),
            values: 0,
        };
        let head = match format {
            // As long as that of the array that it becomes.
            ListFormat::Npy => list.npy_head()?,
            ListFormat::Csv => (channels.join(",") + "\n").into_bytes(),
        };
        list.file.write_all(&head).map_err(Error::io("write", path))?;
        Ok(list)
    }

    /// Appends values, point by point.
    ///
    /// # Errors
    /// When they cannot be written.
    pub fn write(&mut self, values: &[f32]) -> Result<()> {
        self.values += values.len() as u64;
        let mut bytes = Vec::with_capacity(values.len() * 16);
        for row in values.chunks_exact(self.channels) {
            match self.format {
                ListFormat::Npy => row.iter().for_each(|value| bytes.extend_from_slice(&value.to_le_bytes())),
                ListFormat::Csv => {
                    // Nine digits tell every f32.
                    let words: Vec<_> = row.iter().map(|value| format!("{value:.8e}")).collect();
                    bytes.extend_from_slice(words.join(",").as_bytes());
                    bytes.push(b'\n');
                }
            }
        }
        self.file.write_all(&bytes).map_err(Error::io("write", &self.path))
    }

    /// Puts the file in its place.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn finish(mut self) -> Result<()> {
        let head = if self.format == ListFormat::Npy { self.npy_head()? } else { Vec::new() };
        let mut finish = || -> io::Result<()> {
            self.file.seek(SeekFrom::Start(0))?;
            self.file.write_all(&head)
        };
        finish().map_err(Error::io("write", &self.path))?;
        let output =
            self.file.into_inner().map_err(|error| Error::io("write", &self.path)(error.into_error()))?;
        let mut outputs = Outputs::default();
        outputs.take(output)?;
        outputs.commit()
    }

    /// An NPY file up to its first value: 128 bytes, whatever the count.
    fn npy_head(&self) -> Result<Vec<u8>> {
        let shape = [self.values / self.channels as u64, self.channels as u64];
        let head = npy::head(&shape).map_err(Error::io("write", &self.path))?;
        match head.len() {
            128 => Ok(head),
            n => Err(Error::Internal(format!("an NPY header of {n} bytes"))),
        }
    }
}
