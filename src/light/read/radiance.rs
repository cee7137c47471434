//! Reads Radiance HDR: Ward 1991, "Real pixels"; Radiance's "File Formats" and its `header.c`, `resolu.c` and `color.c`.
//!
//! A pixel is three mantissas and an exponent, m 2^(e − 136). The radiance is that over the product of all EXPOSUREs, and
//! in each channel over that of all COLORCORRs.
//!
//! The crate `image` ignores both, reads one orientation only, and does not compare the width of a run-length encoded line
//! with the header's.

use crate::base::error::{Error, Result};
use crate::light::environment::check_size;
use crate::light::read::MapPicture;
use std::io::{BufRead, ErrorKind, Read};

/// Headers are at most so long.
const LONGEST: u64 = 1 << 16;
/// Lines that may be run-length encoded have so many pixels: MINELEN and MAXELEN of `color.c`.
const ENCODED: std::ops::RangeInclusive<usize> = 8..=0x7fff;

type Rgbe = [u8; 4];

pub(super) fn read(mut file: impl BufRead) -> Result<MapPicture> {
    let Header { scale, order, notes } = Header::read(&mut file)?;
    let (width, height) = (order.width, order.height);
    check_size(width, height)?;
    let mut texels = vec![[0.0f32; 3]; width * height];
    let [lines, length] = order.lines();
    let mut pixels = vec![[0; 4]; length];
    for line in 0..lines {
        read_line(&mut file, &mut pixels)
            .map_err(|fault| fault.explain(format!("line {line} of {lines}, from 0"), length))?;
        for (k, pixel) in pixels.iter().enumerate() {
            let [row, column] = order.place(line, k);
            texels[row * width + column] = radiance(*pixel, scale);
        }
    }
    Ok(MapPicture { width, height, texels, notes })
}

fn radiance([r, g, b, e]: Rgbe, scale: [f64; 3]) -> [f32; 3] {
    if e == 0 {
        return [0.0; 3];
    }
    let unit = 2f64.powi(i32::from(e) - 136);
    let mantissas = [r, g, b].map(f64::from);
    std::array::from_fn(|c| (mantissas[c] * unit / scale[c]) as f32)
}

// ---- The header ------------------------------------------------------------------------------------

struct Header {
    /// By what each channel is divided.
    scale: [f64; 3],
    order: Orientation,
    notes: Vec<String>,
}

impl Header {
    /// Reads all lines up to the pixels. They end in LF or CR LF. Indented ones are of pictures that this one was made from.
    fn read(file: &mut impl BufRead) -> Result<Self> {
        let mut head = file.take(LONGEST);
        let mut next = || -> Result<String> {
            let mut line = Vec::new();
            head.read_until(b'\n', &mut line).map_err(|why| Error::input(why.to_string()))?;
            if line.pop() != Some(b'\n') {
                return Err(Error::input(
                    "not a whole Radiance HDR file: its header does not end; write the map again",
                ));
            }
            Ok(String::from_utf8_lossy(&line).trim_end().to_owned())
        };
        next()?;
        let (mut scale, mut notes) = ([1.0; 3], Vec::new());
        loop {
            let line = next()?;
            if line.is_empty() {
                break;
            }
            let Some((key, value)) = line.split_once('=') else { continue };
            match key {
                "FORMAT" => check_format(value.trim())?,
                "EXPOSURE" => divide(&mut scale, &line, numbers::<1>(value).map(|[x]| [x; 3]), &mut notes)?,
                "COLORCORR" => divide(&mut scale, &line, numbers::<3>(value), &mut notes)?,
                _ => {}
            }
        }
        if scale != [1.0; 3] {
            let [r, g, b] = scale;
            notes.push(format!("its exposures are undone: R, G and B are divided by {r}, {g} and {b}"));
        }
        Ok(Self { scale, order: Orientation::parse(&next()?)?, notes })
    }
}

fn check_format(format: &str) -> Result<()> {
    match format {
        "32-bit_rle_rgbe" => Ok(()),
        "32-bit_rle_xyze" => Err(Error::input(
            "its colours are CIE XYZ (FORMAT=32-bit_rle_xyze); convert it to RGB, as by Radiance's ra_xyze -r",
        )),
        _ => Err(Error::input(format!(
            "its format is \"{}\"; give one of FORMAT=32-bit_rle_rgbe",
            format.escape_debug()
        ))),
    }
}

/// So many positive numbers; 0, which says nothing, counts as 1.
fn numbers<const N: usize>(value: &str) -> Option<[f64; N]> {
    let numbers: Vec<f64> = value.split_whitespace().map(str::parse).collect::<Result<_, _>>().ok()?;
    let is_scale = |x: &f64| x.is_finite() && *x >= 0.0;
    numbers.try_into().ok().filter(|numbers: &[f64; N]| numbers.iter().all(is_scale))
}

fn divide(scale: &mut [f64; 3], line: &str, by: Option<[f64; 3]>, notes: &mut Vec<String>) -> Result<()> {
    let line = line.escape_debug();
    let by =
        by.ok_or_else(|| Error::input(format!("its header says \"{line}\"; give finite numbers from 0 up")))?;
    if by.contains(&0.0) {
        notes.push(format!("its header says \"{line}\", where 0 counts as 1"));
    }
    for (scale, by) in scale.iter_mut().zip(by) {
        *scale *= if by == 0.0 { 1.0 } else { by };
    }
    match scale.iter().all(|x| x.is_normal()) {
        true => Ok(()),
        false => Err(Error::input(format!("its exposures multiply to {scale:?}; write the map again"))),
    }
}

/// The order of pixels: `resolu.c`.
struct Orientation {
    width: usize,
    height: usize,
    /// Whether lines are columns.
    is_transposed: bool,
    /// Whether rows come from the bottom, and columns from the right.
    is_flipped: [bool; 2],
}

impl Orientation {
    /// Parses "-Y 512 +X 1024": the slower axis first, Y from the bottom up and X from the left to the right.
    fn parse(line: &str) -> Result<Self> {
        let fault = || {
            let line = line.escape_debug();
            Error::input(format!("its size is \"{line}\"; give rows and columns, as in -Y 512 +X 1024"))
        };
        let words: Vec<_> = line.split_whitespace().collect();
        let &[slow, lines, fast, length] = &words[..] else { return Err(fault()) };
        let count = |text: &str| text.parse::<u32>().map(|n| n as usize).map_err(|_| fault());
        let (lines, length) = (count(lines)?, count(length)?);
        let (is_transposed, [y, x], [height, width]) = match (slow.get(1..), fast.get(1..)) {
            (Some("Y"), Some("X")) => (false, [slow, fast], [lines, length]),
            (Some("X"), Some("Y")) => (true, [fast, slow], [length, lines]),
            _ => return Err(fault()),
        };
        let is = |axis: &str, sign: char| match axis.chars().next() {
            Some('+') => Ok(sign == '+'),
            Some('-') => Ok(sign == '-'),
            _ => Err(fault()),
        };
        Ok(Self { width, height, is_transposed, is_flipped: [is(y, '+')?, is(x, '-')?] })
    }

    /// The number of lines, and their length.
    fn lines(&self) -> [usize; 2] {
        if self.is_transposed { [self.width, self.height] } else { [self.height, self.width] }
    }

    /// Row and column of a pixel of a line.
    fn place(&self, line: usize, pixel: usize) -> [usize; 2] {
        let [row, column] = if self.is_transposed { [pixel, line] } else { [line, pixel] };
        let from = |k: usize, count: usize, is_flipped: bool| if is_flipped { count - 1 - k } else { k };
        [from(row, self.height, self.is_flipped[0]), from(column, self.width, self.is_flipped[1])]
    }
}

// ---- Lines of pixels -------------------------------------------------------------------------------

enum HeaderFault {
    Io(std::io::Error),
    /// It is encoded for another length.
    Length(usize),
    Damaged,
}

impl From<std::io::Error> for HeaderFault {
    fn from(error: std::io::Error) -> Self {
        Self::Io(error)
    }
}

impl HeaderFault {
    fn explain(self, line: String, length: usize) -> Error {
        Error::input(match self {
            Self::Io(why) if why.kind() != ErrorKind::UnexpectedEof => format!("{line}: {why}"),
            Self::Io(_) => format!("not a whole Radiance HDR file: it ends in {line}; write the map again"),
            Self::Length(other) => format!(
                "{line}, is run-length encoded for {other} pixels, and the header says {length}; write the map again"
            ),
            Self::Damaged => format!(
                "not a whole Radiance HDR file: the run lengths of {line}, do not fit; write the map again"
            ),
        })
    }
}

/// Reads a line: `freadcolrs` of `color.c`.
fn read_line(file: &mut impl Read, pixels: &mut [Rgbe]) -> Result<(), HeaderFault> {
    let length = pixels.len();
    let first = read_bytes(file)?;
    let [2, 2, high @ ..=0x7f, low] = first else { return read_old_line(file, first, pixels) };
    if !ENCODED.contains(&length) {
        return read_old_line(file, first, pixels);
    }
    let encoded = usize::from(high) << 8 | usize::from(low);
    if encoded != length {
        return Err(HeaderFault::Length(encoded));
    }
    for channel in 0..4 {
        let mut rest = &mut pixels[..];
        while !rest.is_empty() {
            let [code] = read_bytes(file)?;
            let (is_run, count) = if code > 128 { (true, code - 128) } else { (false, code) };
            let (now, later) =
                rest.split_at_mut_checked(count.into()).filter(|_| count > 0).ok_or(HeaderFault::Damaged)?;
            let [mut value] = if is_run { read_bytes(file)? } else { [0] };
            for pixel in now {
                if !is_run {
                    [value] = read_bytes(file)?;
                }
                pixel[channel] = value;
            }
            rest = later;
        }
    }
    Ok(())
}

/// Reads a line of plain pixels, in which (1, 1, 1, n) repeats the last one n times, and 256 n times after another such.
fn read_old_line(file: &mut impl Read, first: Rgbe, pixels: &mut [Rgbe]) -> Result<(), HeaderFault> {
    let (mut filled, mut shift, mut next) = (0, 0, Some(first));
    while filled < pixels.len() {
        let pixel = match next.take() {
            Some(pixel) => pixel,
            None => read_bytes(file)?,
        };
        let [1, 1, 1, n] = pixel else {
            pixels[filled] = pixel;
            (filled, shift) = (filled + 1, 0);
            continue;
        };
        let last = filled.checked_sub(1).map(|k| pixels[k]).ok_or(HeaderFault::Damaged)?;
        let count = usize::from(n).checked_shl(shift).filter(|_| shift < 32).ok_or(HeaderFault::Damaged)?;
        pixels[filled..].get_mut(..count).ok_or(HeaderFault::Damaged)?.fill(last);
        (filled, shift) = (filled + count, shift + 8);
    }
    Ok(())
}

fn read_bytes<const N: usize>(file: &mut impl Read) -> std::io::Result<[u8; N]> {
    let mut bytes = [0; N];
    file.read_exact(&mut bytes)?;
    Ok(bytes)
}
