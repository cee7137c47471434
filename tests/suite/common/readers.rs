//! Readers written from the specifications of the formats, which share no code with the writers.
#![allow(dead_code)] // each test reads what it needs

use std::collections::BTreeMap;

/// What an EXR file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Exr {
    pub width: usize,
    pub height: usize,
    /// Samples by channel, row by row from the top.
    pub channels: BTreeMap<String, Vec<f32>>,
    /// Whether the samples are 16-bit floats in the file.
    pub half: bool,
    /// Type and bytes of each attribute.
    pub attributes: BTreeMap<String, (String, Vec<u8>)>,
}

impl Exr {
    /// An attribute of type `string`.
    pub fn text(&self, name: &str) -> &str {
        let (kind, bytes) = self.attributes.get(name).unwrap_or_else(|| panic!("no attribute {name}"));
        assert_eq!(kind, "string", "{name}");
        std::str::from_utf8(bytes).unwrap_or_else(|error| panic!("{name}: {error}"))
    }
}

/// Reads a single-part, uncompressed scanline file of 32-bit float channels, or all of 16 bits: openexr.com, "OpenEXR File
/// Layout" and "Technical Introduction".
pub fn exr(file: &[u8]) -> Result<Exr, String> {
    let mut at = Cursor(file);
    if at.take(4)? != [0x76, 0x2f, 0x31, 0x01] {
        return Err("not an EXR file".into());
    }
    // Version 2; bit 10 allows long names, the bits for tiles, deep data and parts must be off.
    let version = at.i32()?;
    if version & !0x400 != 2 {
        return Err(format!("version field {version:#x}"));
    }
    let mut attributes = BTreeMap::new();
    loop {
        let name = at.word()?;
        if name.is_empty() {
            break;
        }
        let kind = at.word()?;
        let size = at.i32()?;
        let value = at.take(size as usize)?.to_vec();
        if attributes.insert(name.clone(), (kind, value)).is_some() {
            return Err(format!("two attributes {name}"));
        }
    }
    let raw = |name: &str| -> Result<&[u8], String> {
        attributes.get(name).map(|(_, value)| value.as_slice()).ok_or(format!("no attribute {name}"))
    };
    if raw("compression")? != [0] || raw("lineOrder")? != [0] {
        return Err("compressed, or lines not from the top".into());
    }
    let window = raw("dataWindow")?;
    if window != raw("displayWindow")? {
        return Err("data and display windows differ".into());
    }
    let mut window = Cursor(window);
    let [x0, y0, x1, y1] = [window.i32()?, window.i32()?, window.i32()?, window.i32()?];
    let (width, height) = ((x1 - x0 + 1) as usize, (y1 - y0 + 1) as usize);

    let mut list = Cursor(raw("channels")?);
    let (mut names, mut halves) = (Vec::new(), Vec::new());
    loop {
        let name = list.word()?;
        if name.is_empty() {
            break;
        }
        let kind = list.i32()?;
        list.take(4)?; // perceptually linear or not, and padding
        let sampling = [list.i32()?, list.i32()?];
        if !(kind == 1 || kind == 2) || sampling != [1, 1] {
            return Err(format!("channel {name}: type {kind}, sampling {sampling:?}"));
        }
        names.push(name);
        halves.push(kind == 1);
    }
    let half = halves.first() == Some(&true);
    if halves.iter().any(|&other| other != half) {
        return Err("channels of both kinds".into());
    }
    if !names.is_sorted() {
        return Err("channels are not in the order of their names".into());
    }

    let offsets: Vec<u64> = (0..height).map(|_| at.u64()).collect::<Result<_, _>>()?;
    let mut channels: BTreeMap<String, Vec<f32>> = names.iter().map(|n| (n.clone(), Vec::new())).collect();
    for (row, offset) in offsets.into_iter().enumerate() {
        let mut block = Cursor(file.get(offset as usize..).ok_or("offset beyond the end")?);
        let (y, size) = (block.i32()?, block.i32()?);
        if y != y0 + row as i32 || size as usize != names.len() * width * if half { 2 } else { 4 } {
            return Err(format!("row {row}: y = {y}, {size} bytes"));
        }
        for name in &names {
            let samples = channels.get_mut(name).ok_or("channel")?;
            for _ in 0..width {
                samples.push(match half {
                    true => self::half(u16::from_le_bytes(block.array()?)) as f32,
                    false => f32::from_le_bytes(block.array()?),
                });
            }
        }
    }
    Ok(Exr { width, height, channels, half, attributes })
}

/// A 16-bit float: IEEE 754-2008, 3.6.
pub fn half(bits: u16) -> f64 {
    let (exponent, fraction) = (i32::from(bits >> 10 & 31), f64::from(bits & 1023));
    let size = match exponent {
        0 => fraction * 2f64.powi(-24),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => (1024.0 + fraction) * 2f64.powi(exponent - 25),
    };
    if bits >> 15 == 1 { -size } else { size }
}

/// Reads a little-endian float32 array. Shape and values.
pub fn npy(file: &[u8]) -> Result<(Vec<usize>, Vec<f32>), String> {
    let (descr, shape, bytes) = npy_raw(file)?;
    if descr != "<f4" {
        return Err(format!("not little-endian float32: {descr}"));
    }
    let words = bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    Ok((shape, words.collect()))
}

/// Reads an array in C order: numpy.org, "numpy.lib.format". Type, shape and bytes.
pub fn npy_raw(file: &[u8]) -> Result<(String, Vec<usize>, Vec<u8>), String> {
    let mut at = Cursor(file);
    if at.take(6)? != b"\x93NUMPY" {
        return Err("not an NPY file".into());
    }
    let size = match at.array()? {
        [1, 0] => u16::from_le_bytes(at.array()?) as usize,
        [2 | 3, 0] => u32::from_le_bytes(at.array()?) as usize,
        version => return Err(format!("version {version:?}")),
    };
    let header = std::str::from_utf8(at.take(size)?).map_err(|error| error.to_string())?;
    let value = |key: &str| -> Result<&str, String> {
        let (_, rest) = header.split_once(&format!("'{key}':")).ok_or(format!("no {key}"))?;
        Ok(rest.trim_start())
    };
    if !value("fortran_order")?.starts_with("False") {
        return Err(format!("not in C order: {header}"));
    }
    let descr = value("descr")?.strip_prefix('\'').and_then(|d| d.split_once('\'')).ok_or("no descr")?.0;
    let size: usize = descr.get(2..).and_then(|n| n.parse().ok()).ok_or("no size")?;
    let (shape, _) = value("shape")?.strip_prefix('(').and_then(|s| s.split_once(')')).ok_or("no tuple")?;
    let words = shape.split(',').map(str::trim).filter(|word| !word.is_empty());
    let shape: Vec<usize> =
        words.map(|word| word.parse().map_err(|_| format!("{word} in shape"))).collect::<Result<_, _>>()?;
    let count: usize = shape.iter().product();
    if at.0.len() != count * size {
        return Err(format!("{} bytes for {count} values", at.0.len()));
    }
    Ok((descr.into(), shape, at.0.to_vec()))
}

/// The bytes that are still to be read.
struct Cursor<'a>(&'a [u8]);

impl<'a> Cursor<'a> {
    fn take(&mut self, n: usize) -> Result<&'a [u8], String> {
        let (taken, rest) = self.0.split_at_checked(n).ok_or("file is too short")?;
        self.0 = rest;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], String> {
        self.take(N)?.try_into().map_err(|_| "array".into())
    }

    fn i32(&mut self) -> Result<i32, String> {
        self.array().map(i32::from_le_bytes)
    }

    fn u64(&mut self) -> Result<u64, String> {
        self.array().map(u64::from_le_bytes)
    }

    /// Up to a zero byte.
    fn word(&mut self) -> Result<String, String> {
        let end = self.0.iter().position(|&byte| byte == 0).ok_or("text without an end")?;
        let word = String::from_utf8(self.take(end)?.to_vec()).map_err(|error| error.to_string())?;
        self.take(1)?;
        Ok(word)
    }
}
