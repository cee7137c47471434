//! Lists of pairs of directions, read piece by piece: NPY (n, 4) in float64 or float32, or CSV; columns θi,
//! φi, θe, φe, rad.

use crate::base::angles::Angles;
use crate::base::error::{Error, Result};
use crate::io::list::ListFormat;
use std::f64::consts::FRAC_PI_2;
use std::fs::File;
use std::io::{self, BufRead, BufReader, ErrorKind, Read};
use std::path::{Path, PathBuf};

/// The columns, by the names that a CSV header gives them.
const COLUMNS: [&str; 4] = ["theta_i", "phi_i", "theta_e", "phi_e"];

/// An open list.
pub(crate) struct Pairs {
    path: PathBuf,
    /// How many it has, where its header says so.
    pub count: Option<u64>,
    read: u64,
    source: PairReader,
}

enum PairReader {
    Npy(BufReader<File>, Number),
    Csv(CsvLines),
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
                (Some(rows), PairReader::Npy(file, number))
            }
            ListFormat::Csv => (
                None,
                PairReader::Csv(CsvLines {
                    file: BufReader::new(file),
                    line: 0,
                    bytes: Vec::new(),
                    began: false,
                }),
            ),
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
            PairReader::Npy(file, number) => {
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
                    let pair = angles_of(number.read(bytes));
                    pair.check().map_err(|e| e.at(format!("{}: row {row}, from 0", self.path.display())))?;
                    angles.push(pair);
                }
            }
            PairReader::Csv(lines) => {
                while angles.len() < most
                    && let Some(pair) = lines.next(&self.path)?
                {
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

/// A CSV file, line by line. Blank lines and comments are passed over.
struct CsvLines {
    file: BufReader<File>,
    line: u64,
    bytes: Vec<u8>,
    began: bool,
}

impl CsvLines {
    /// The next four numbers; `None` at the end.
    fn next(&mut self, path: &Path) -> Result<Option<Angles>> {
        /// No line of four numbers is so long, and no comment need be.
        const LONGEST: u64 = 1 << 16;
        loop {
            self.bytes.clear();
            let mut file = self.file.by_ref().take(LONGEST);
            if file.read_until(b'\n', &mut self.bytes).map_err(Error::io("read", path))? == 0 {
                return Ok(None);
            }
            self.line += 1;
            let place = |error: Error| error.at(format!("{}: line {}", path.display(), self.line));
            if self.bytes.len() as u64 == LONGEST {
                let why =
                    format!("it has {LONGEST} bytes or more, and four numbers have fewer; break the line");
                return Err(place(Error::input(why)));
            }
            let text = str::from_utf8(&self.bytes).map_err(|_| place(Error::input("it is not UTF-8")))?;
            // Spreadsheets begin a file with a byte order mark.
            let text = text.trim_start_matches('\u{feff}').trim();
            if text.is_empty() || text.starts_with('#') {
                continue;
            }
            let first = !std::mem::replace(&mut self.began, true);
            if first && is_header(text).map_err(place)? {
                continue;
            }
            return numbers(text)
                .map(angles_of)
                .and_then(|pair| pair.check().map(|()| Some(pair)))
                .map_err(place);
        }
    }
}

fn fields(line: &str) -> impl Iterator<Item = &str> {
    line.split(',').map(|field| field.trim().trim_matches('"'))
}

/// Whether a first line names the columns.
///
/// # Errors
/// When it names others, or in another order.
fn is_header(line: &str) -> Result<bool> {
    if fields(line).eq(COLUMNS) {
        return Ok(true);
    }
    let is_word = |field: &str| field.starts_with(char::is_alphabetic) && field.parse::<f64>().is_err();
    match fields(line).any(is_word) {
        true => Err(Error::input(format!("the columns are \"{line}\"; give \"{}\"", COLUMNS.join(",")))),
        false => Ok(false),
    }
}

fn numbers(line: &str) -> Result<[f64; 4]> {
    let found = fields(line).count();
    if found != COLUMNS.len() {
        return Err(Error::input(format!("{found} columns; give four: {}", COLUMNS.join(","))));
    }
    let mut numbers = [0.0; 4];
    for ((number, field), name) in numbers.iter_mut().zip(fields(line)).zip(COLUMNS) {
        *number = field.parse().map_err(|_| Error::input(format!("{name} = \"{field}\" is not a number")))?;
    }
    Ok(numbers)
}

// ---- NPY -------------------------------------------------------------------------------------------

impl Number {
    /// Four of them, in f64. The f32 nearest to π/2 lies above it, and means it.
    fn read(self, bytes: &[u8]) -> [f64; 4] {
        let widen = |x: f32| if x == FRAC_PI_2 as f32 { FRAC_PI_2 } else { f64::from(x) };
        let mut numbers = [f64::NAN; 4];
        for (k, number) in numbers.iter_mut().enumerate() {
            let four = |at: usize| bytes[at..at + 4].try_into().unwrap_or_default();
            let eight = |at: usize| bytes[at..at + 8].try_into().unwrap_or_default();
            *number = match self {
                Self { bytes: 8, big_endian: false } => f64::from_le_bytes(eight(8 * k)),
                Self { bytes: 8, big_endian: true } => f64::from_be_bytes(eight(8 * k)),
                Self { big_endian: false, .. } => widen(f32::from_le_bytes(four(4 * k))),
                Self { big_endian: true, .. } => widen(f32::from_be_bytes(four(4 * k))),
            };
        }
        numbers
    }
}

/// What is wrong with a header.
enum PairFault {
    Io(io::Error),
    Format(String),
}

impl PairFault {
    fn explain(self, path: &Path) -> Error {
        match self {
            Self::Io(error) if error.kind() != ErrorKind::UnexpectedEof => Error::io("read", path)(error),
            Self::Io(_) => Error::input(format!("{}: it ends within its NPY header", path.display())),
            Self::Format(why) => Error::input(format!("{}: {why}", path.display())),
        }
    }
}

/// Numbers and rows of an (n, 4) array in C order: numpy.org, "numpy.lib.format".
fn npy_header(file: &mut impl Read) -> Result<(Number, u64), PairFault> {
    /// Longer headers are of records, or hostile.
    const LONGEST: usize = 1 << 16;
    let mut array = |n: usize| -> Result<Vec<u8>, PairFault> {
        let mut bytes = vec![0; n];
        file.read_exact(&mut bytes).map_err(PairFault::Io)?;
        Ok(bytes)
    };
    let fault = |why: &str| PairFault::Format(why.into());
    if array(6)? != b"\x93NUMPY" {
        return Err(fault("it is not an NPY file; write it with numpy.save"));
    }
    let length_bytes = match array(2)?[0] {
        1 => 2,
        2 | 3 => 4,
        version => {
            return Err(PairFault::Format(format!(
                "NPY version {version} is unknown; write version 1, 2 or 3"
            )));
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
        rest.map(str::trim_start).ok_or_else(|| PairFault::Format(format!("its NPY header has no {key}")))
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
            return Err(PairFault::Format(format!(
                "its numbers are of type {kind}; give float64 or float32"
            )));
        }
    };
    let tuple = value("shape")?.strip_prefix('(').and_then(|rest| rest.split_once(')'));
    let (tuple, _) = tuple.ok_or_else(|| fault("its NPY header has no shape"))?;
    let shape: Vec<_> = tuple.split(',').map(str::trim).filter(|word| !word.is_empty()).collect();
    let rows = match shape[..] {
        [rows, "4"] => rows.parse().ok(),
        _ => None,
    };
    let rows = rows.ok_or_else(|| PairFault::Format(format!("its shape is ({tuple}); give (n, 4)")))?;
    if !value("fortran_order")?.starts_with("False") {
        return Err(fault("it is in Fortran order; write it with numpy.ascontiguousarray"));
    }
    Ok((number, rows))
}
