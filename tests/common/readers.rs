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

/// Reads a single-part, uncompressed scanline file of 32-bit float channels: openexr.com, "OpenEXR File
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
    let mut names = Vec::new();
    loop {
        let name = list.word()?;
        if name.is_empty() {
            break;
        }
        let kind = list.i32()?;
        list.take(4)?; // perceptually linear or not, and padding
        let sampling = [list.i32()?, list.i32()?];
        if kind != 2 || sampling != [1, 1] {
            return Err(format!("channel {name}: type {kind}, sampling {sampling:?}"));
        }
        names.push(name);
    }
    if !names.is_sorted() {
        return Err("channels are not in the order of their names".into());
    }

    let offsets: Vec<u64> = (0..height).map(|_| at.u64()).collect::<Result<_, _>>()?;
    let mut channels: BTreeMap<String, Vec<f32>> = names.iter().map(|n| (n.clone(), Vec::new())).collect();
    for (row, offset) in offsets.into_iter().enumerate() {
        let mut block = Cursor(file.get(offset as usize..).ok_or("offset beyond the end")?);
        let (y, size) = (block.i32()?, block.i32()?);
        if y != y0 + row as i32 || size as usize != names.len() * width * 4 {
            return Err(format!("row {row}: y = {y}, {size} bytes"));
        }
        for name in &names {
            let samples = channels.get_mut(name).ok_or("channel")?;
            for _ in 0..width {
                samples.push(f32::from_le_bytes(block.array()?));
            }
        }
    }
    Ok(Exr { width, height, channels, attributes })
}

/// Reads a little-endian float32 array in C order: numpy.org, "numpy.lib.format". Shape and values.
pub fn npy(file: &[u8]) -> Result<(Vec<usize>, Vec<f32>), String> {
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
    if !value("descr")?.starts_with("'<f4'") || !value("fortran_order")?.starts_with("False") {
        return Err(format!("not little-endian float32 in C order: {header}"));
    }
    let (shape, _) = value("shape")?.strip_prefix('(').and_then(|s| s.split_once(')')).ok_or("no tuple")?;
    let words = shape.split(',').map(str::trim).filter(|word| !word.is_empty());
    let shape: Vec<usize> =
        words.map(|word| word.parse().map_err(|_| format!("{word} in shape"))).collect::<Result<_, _>>()?;
    let count: usize = shape.iter().product();
    if at.0.len() != count * 4 {
        return Err(format!("{} bytes for {count} values", at.0.len()));
    }
    let values = (0..count).map(|_| at.array().map(f32::from_le_bytes)).collect::<Result<_, _>>()?;
    Ok((shape, values))
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
