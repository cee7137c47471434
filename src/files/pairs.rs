//! Lists of pairs of directions, read piece by piece: NPY (n, 4) in float64 or float32, or CSV; columns θi,
//! φi, θe, φe, rad.

use super::list::ListFormat;
use crate::error::{Error, Result};
use crate::points::Angles;
use std::f64::consts::FRAC_PI_2;
use std::fs::File;
use std::io::{self, BufReader, ErrorKind, Read};
use std::path::{Path, PathBuf};

/// The columns, by the names that a CSV header gives them.
const COLUMNS: [&str; 4] = ["theta_i", "phi_i", "theta_e", "phi_e"];

/// An open list.
pub(crate) struct Pairs {
    path: PathBuf,
    /// How many it has, where its header says so.
    pub count: Option<u64>,
    read: u64,
    source: Source,
}

enum Source {
    Npy(BufReader<File>, Number),
    Csv(Box<csv::Reader<File>>),
}

/// How an NPY file writes a number.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Number {
    bytes: usize,
    big_endian: bool,
}

impl Pairs {
    /// Opens a list.
    ///
    /// # Errors
    /// When it cannot be read, or is no list of four columns.
    pub fn open(path: &Path) -> Result<Self> {
        let format = ListFormat::of(path)?;
        let file = File::open(path).map_err(Error::io("read", path))?;
        let (count, source) = match format {
            ListFormat::Npy => {
                let mut file = BufReader::new(file);
                let (number, rows) = npy_header(&mut file).map_err(|why| why.explain(path))?;
                (Some(rows), Source::Npy(file, number))
            }
            ListFormat::Csv => {
                let mut reader = csv::ReaderBuilder::new();
                reader.has_headers(false).flexible(true).comment(Some(b'#')).trim(csv::Trim::All);
                (None, Source::Csv(Box::new(reader.from_reader(file))))
            }
        };
        Ok(Self { path: path.to_owned(), count, read: 0, source })
    }

    /// The next pairs, so many or all that are left, in place of what `angles` held; none at the end.
    ///
    /// # Errors
    /// When a row is no pair of directions: the message names it.
    pub fn next(&mut self, most: usize, angles: &mut Vec<Angles>) -> Result<()> {
        angles.clear();
        match &mut self.source {
            Source::Npy(file, number) => {
                let left = self.count.unwrap_or(0) - self.read;
                let rows = usize::try_from(left).unwrap_or(most).min(most);
                let mut bytes = vec![0; rows * 4 * number.bytes];
                file.read_exact(&mut bytes).map_err(|error| match error.kind() {
                    ErrorKind::UnexpectedEof => Error::input(format!(
                        "{}: it ends before the last of the {} rows that its header promises",
                        self.path.display(),
                        self.count.unwrap_or(0)
                    )),
                    _ => Error::io("read", &self.path)(error),
                })?;
                for (row, bytes) in (self.read..).zip(bytes.chunks_exact(4 * number.bytes)) {
                    let mut numbers = bytes.chunks_exact(number.bytes).map(|bytes| number.read(bytes));
                    let pair = angles_of([(); 4].map(|()| numbers.next().unwrap_or(f64::NAN)));
                    pair.check().map_err(|e| e.at(format!("{}: row {row}, from 0", self.path.display())))?;
                    angles.push(pair);
                }
            }
            Source::Csv(reader) => {
                let mut record = csv::StringRecord::new();
                while angles.len() < most && read_record(reader, &mut record, &self.path)? {
                    let line = record.position().map_or(0, csv::Position::line);
                    let place = format!("{}: line {line}", self.path.display());
                    let first = self.read == 0 && angles.is_empty();
                    if first && is_header(&record).map_err(|e| e.at(&place))? {
                        continue;
                    }
                    let pair = angles_of(numbers(&record).map_err(|e| e.at(&place))?);
                    pair.check().map_err(|e| e.at(&place))?;
                    angles.push(pair);
                }
            }
        }
        self.read += angles.len() as u64;
        Ok(())
    }
}

fn angles_of([theta_i, phi_i, theta_e, phi_e]: [f64; 4]) -> Angles {
    Angles { theta_i, phi_i, theta_e, phi_e }
}

// ---- CSV -------------------------------------------------------------------------------------------

fn read_record(reader: &mut csv::Reader<File>, record: &mut csv::StringRecord, path: &Path) -> Result<bool> {
    reader.read_record(record).map_err(|error| {
        let line = error.position().map_or(0, csv::Position::line);
        match error.into_kind() {
            csv::ErrorKind::Io(error) => Error::io("read", path)(error),
            csv::ErrorKind::Utf8 { .. } => {
                Error::input(format!("{}: line {line}: it is not UTF-8", path.display()))
            }
            other => Error::input(format!("{}: line {line}: {other:?}", path.display())),
        }
    })
}

/// Whether a first record names the columns.
///
/// # Errors
/// When it names others, or in another order.
fn is_header(record: &csv::StringRecord) -> Result<bool> {
    let is_word =
        |field: &str| field.starts_with(|c: char| c.is_alphabetic()) && field.parse::<f64>().is_err();
    if !record.iter().any(is_word) {
        return Ok(false);
    }
    if record.iter().eq(COLUMNS) {
        return Ok(true);
    }
    let found: Vec<_> = record.iter().collect();
    Err(Error::input(format!("the columns are \"{}\"; give \"{}\"", found.join(","), COLUMNS.join(","))))
}

fn numbers(record: &csv::StringRecord) -> Result<[f64; 4]> {
    if record.len() != 4 {
        let wanted = COLUMNS.join(",");
        return Err(Error::input(format!("{} columns; give four: {wanted}", record.len())));
    }
    let mut numbers = [0.0; 4];
    for ((number, field), name) in numbers.iter_mut().zip(record).zip(COLUMNS) {
        *number = field.parse().map_err(|_| Error::input(format!("{name} = \"{field}\" is not a number")))?;
    }
    Ok(numbers)
}

// ---- NPY -------------------------------------------------------------------------------------------

impl Number {
    /// Its value in f64. The f32 nearest to π/2 lies above it, and means it.
    fn read(self, bytes: &[u8]) -> f64 {
        let little =
            |bytes: &[u8]| bytes.iter().rev().fold(0, |word: u64, &byte| word << 8 | u64::from(byte));
        let big = |bytes: &[u8]| bytes.iter().fold(0, |word: u64, &byte| word << 8 | u64::from(byte));
        let word = if self.big_endian { big(bytes) } else { little(bytes) };
        if self.bytes == 8 {
            return f64::from_bits(word);
        }
        let value = f32::from_bits(word as u32);
        if value == FRAC_PI_2 as f32 { FRAC_PI_2 } else { f64::from(value) }
    }
}

/// What is wrong with a header.
enum Fault {
    Io(io::Error),
    Format(String),
}

impl Fault {
    fn explain(self, path: &Path) -> Error {
        match self {
            Self::Io(error) if error.kind() != ErrorKind::UnexpectedEof => Error::io("read", path)(error),
            Self::Io(_) => Error::input(format!("{}: it ends within its NPY header", path.display())),
            Self::Format(why) => Error::input(format!("{}: {why}", path.display())),
        }
    }
}

/// Numbers and rows of an (n, 4) array in C order: numpy.org, "numpy.lib.format".
fn npy_header(file: &mut impl Read) -> Result<(Number, u64), Fault> {
    /// Longer headers are of records, or hostile.
    const LONGEST: usize = 1 << 16;
    let mut array = |n: usize| -> Result<Vec<u8>, Fault> {
        let mut bytes = vec![0; n];
        file.read_exact(&mut bytes).map_err(Fault::Io)?;
        Ok(bytes)
    };
    let fault = |why: &str| Fault::Format(why.into());
    if array(6)? != b"\x93NUMPY" {
        return Err(fault("it is not an NPY file; write it with numpy.save"));
    }
    let length_bytes = match array(2)?[0] {
        1 => 2,
        2 | 3 => 4,
        version => {
            return Err(Fault::Format(format!("NPY version {version} is unknown; write version 1, 2 or 3")));
        }
    };
    let length = array(length_bytes)?.iter().rev().fold(0, |n: usize, &byte| n << 8 | usize::from(byte));
    if length > LONGEST {
        return Err(fault("its NPY header is too long for a plain array"));
    }
    let header = array(length)?;
    let header = str::from_utf8(&header).map_err(|_| fault("its NPY header is not UTF-8"))?;
    let value = |key: &str| {
        let rest = ["'", "\""].iter().find_map(|quote| header.split_once(&format!("{quote}{key}{quote}")));
        let rest = rest.and_then(|(_, rest)| rest.trim_start().strip_prefix(':'));
        rest.map(str::trim_start).ok_or_else(|| Fault::Format(format!("its NPY header has no {key}")))
    };

    let kind = value("descr")?;
    let kind = kind.get(1..).and_then(|rest| rest.split_once(['\'', '"'])).map_or(kind, |(kind, _)| kind);
    let number = match kind {
        "<f8" => Number { bytes: 8, big_endian: false },
        ">f8" => Number { bytes: 8, big_endian: true },
        "<f4" => Number { bytes: 4, big_endian: false },
        ">f4" => Number { bytes: 4, big_endian: true },
        _ => {
            let kind: String = kind.chars().take(40).collect();
            return Err(Fault::Format(format!("its numbers are of type {kind}; give float64 or float32")));
        }
    };
    let tuple = value("shape")?.strip_prefix('(').and_then(|rest| rest.split_once(')'));
    let (tuple, _) = tuple.ok_or_else(|| fault("its NPY header has no shape"))?;
    let shape: Vec<_> = tuple.split(',').map(str::trim).filter(|word| !word.is_empty()).collect();
    let rows = match shape[..] {
        [rows, "4"] => rows.parse().ok(),
        _ => None,
    };
    let rows = rows.ok_or_else(|| Fault::Format(format!("its shape is ({tuple}); give (n, 4)")))?;
    if !value("fortran_order")?.starts_with("False") {
        return Err(fault("it is in Fortran order; write it with numpy.ascontiguousarray"));
    }
    Ok((number, rows))
}
