//! OpenEXR files: 32-bit float, or 16-bit where the table is stored so, named channels, uncompressed scanlines, all else as attributes.

use crate::base::error::{Error, Result};
use crate::io::format::{Format, RowWriter, Streamed};
use crate::io::{Provenance, entry};
use crate::table::Table;
use crate::table::storage::Storage;
use ::exr::image::write::layers::WritableLayers;
use ::exr::meta::header::Header;
use ::exr::meta::{MetaData, magic_number};
use ::exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Encoding, FlatSamples, Image, Layer, LayerAttributes, Text,
    WritableImage,
};
use half::f16;
use serde::Serialize;
use std::collections::BTreeMap;
use std::io::Cursor;

/// OpenEXR: 32-bit float (16-bit for tables in f16), named channels, uncompressed scanlines; width is the last axis,
/// height the product of the others, row 0 the first value; axes and provenance as attributes.
pub static EXR: Format = Format {
    name: "exr",
    extension: "exr",
    summary: "OpenEXR: named channels in float, axes and provenance as attributes",
    encode,
    streamed: Streamed::Rows(begin),
};

/// The bytes of the file.
fn encode(table: &Table, provenance: &Provenance) -> Result<Vec<u8>> {
    let fault = |why: &dyn std::fmt::Display| Error::Internal(format!("table {}: EXR: {why}", table.name));
    let (stride, values) = (table.channels.len(), table.values.to_f32());
    let channels = table.channels.iter().enumerate().map(|(c, name)| {
        let samples = values.iter().skip(c).step_by(stride).copied();
        let samples = match table.storage {
            Storage::F16 => FlatSamples::F16(samples.map(f16::from_f32).collect()),
            _ => FlatSamples::F32(samples.collect()),
        };
        AnyChannel::new(text(name), samples)
    });

    let channels = AnyChannels::sort(channels.collect());
    let attributes = attributes(table, provenance)?;
    let layer = Layer::new(table.image_size(), attributes, Encoding::UNCOMPRESSED, channels);
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer).write().to_buffered(&mut bytes).map_err(|e| fault(&e))?;
    let mut bytes = bytes.into_inner();
    sort_attributes(&mut bytes).ok_or_else(|| fault(&"the header cannot be read back"))?;
    Ok(bytes)
}

/// The file up to its first scanline: header, then the offset of each scanline, which are known as nothing is
/// compressed.
fn begin(table: &Table, provenance: &Provenance, file: &mut Vec<u8>) -> Result<Box<dyn RowWriter>> {
    let fault = |why: &dyn std::fmt::Display| Error::Internal(format!("table {}: EXR: {why}", table.name));
    let channel = |name: &String| AnyChannel::new(text(name), FlatSamples::F32(Vec::new()));
    let channels = AnyChannels::sort(table.channels.iter().map(channel).collect());
    let attributes = attributes(table, provenance)?;
    let layer = Layer::new(table.image_size(), attributes, Encoding::UNCOMPRESSED, channels);
    let image = Image::from_layer(layer);
    let headers = image.layer_data.infer_headers(&image.attributes);

    let mut bytes = Vec::new();
    let write = |bytes: &mut Vec<u8>| {
        let requirements = MetaData::validate(&headers, true)?;
        bytes.extend(magic_number::BYTES);
        requirements.write(bytes)?;
        Header::write_all(&headers, bytes, false)
    };
    write(&mut bytes).map_err(|e| fault(&e))?;
    sort_attributes(&mut bytes).ok_or_else(|| fault(&"the header cannot be read back"))?;

    let (width, height) = table.image_size();
    let first = bytes.len() + 8 * height;
    let line = 8 + 4 * width * table.channels.len();
    bytes.extend((0..height).flat_map(|y| ((first + y * line) as u64).to_le_bytes()));
    let mut order: Vec<_> = (0..table.channels.len()).collect();
    order.sort_by_key(|&c| text(&table.channels[c]));
    file.extend(bytes);
    Ok(Box::new(Scanlines { y: 0, order }))
}

/// Scanlines, one after the other.
struct Scanlines {
    y: i32,
    /// The table's channels in the file's order.
    order: Vec<usize>,
}

impl RowWriter for Scanlines {
    /// A scanline is its y, its size, and one channel after the other.
    fn append(&mut self, texels: &[f32], file: &mut Vec<u8>) {
        file.extend(self.y.to_le_bytes());
        file.extend((4 * texels.len() as i32).to_le_bytes());
        for &c in &self.order {
            file.extend(texels.iter().skip(c).step_by(self.order.len()).flat_map(|v| v.to_le_bytes()));
        }
        self.y += 1;
    }
}

fn attributes(table: &Table, provenance: &Provenance) -> Result<LayerAttributes> {
    let fault = |why: &dyn std::fmt::Display| Error::Internal(format!("table {}: EXR: {why}", table.name));
    let mut attributes = LayerAttributes::default();
    for (name, value) in describe(table).map_err(|e| fault(&e))? {
        attributes.other.insert(text(&name), AttributeValue::Text(text(&value)));
    }
    for (name, value) in provenance {
        let name = text(&format!("gonio:{name}"));
        if attributes.other.insert(name, AttributeValue::Text(text(value))).is_some() {
            return Err(fault(&"provenance has the name of an attribute of the table"));
        }
    }
    attributes.software_name = Some(text(concat!("gonio ", env!("CARGO_PKG_VERSION"))));
    attributes.comments = Some(text(&in_words(table)));
    Ok(attributes)
}

/// The table without its values and without times, as attributes.
fn describe(table: &Table) -> serde_json::Result<BTreeMap<String, String>> {
    fn json(value: &impl Serialize) -> serde_json::Result<String> {
        serde_json::to_string(value)
    }
    let attributes = [
        ("name", table.name.clone()),
        ("quantity", table.quantity.name.into()),
        ("unit", table.quantity.unit.into()),
        ("subject", table.subject.clone()),
        ("parameters", json(&table.parameters)?),
        ("axes", json(&entry::axes(table))?),
        ("channels", json(&table.channels)?),
        ("rule", table.rule.clone()),
        ("precision", table.precision.to_string()),
        // OpenEXR has neither doubles nor integers of 16 bits: those are f32 here, to the nearest.
        ("storage", table.storage.name().into()),
        ("bilinear", json(&table.bilinear)?),
        ("error", json(&table.error)?),
        ("version", env!("CARGO_PKG_VERSION").into()),
    ];
    Ok(attributes.into_iter().map(|(name, value)| (format!("gonio:{name}"), value)).collect())
}

/// How to read the image, for a person who opens it in a viewer.
fn in_words(table: &Table) -> String {
    let axis = |axis: &crate::table::axis::Axis| format!("{} ({})", axis.variable().name(), axis.len());
    let axes: Vec<_> = table.axes.iter().map(axis).collect();
    format!(
        "{} of {}, unit {}. Axes, slowest first: {}. Width is the last axis, height the product of the \
         others, row-major; row 0 holds the first value. See gonio:axes for the sample positions.",
        table.quantity.name,
        table.subject,
        table.quantity.unit,
        if axes.is_empty() { "none".into() } else { axes.join(", ") }
    )
}

/// UTF-8, as the OpenEXR library reads strings; `Text::from` would panic beyond Latin-1.
fn text(utf8: &str) -> Text {
    Text::from_slice_unchecked(utf8.as_bytes())
}

/// Puts the header's attributes in the order of their names, in place.
///
/// The crate keeps them in a hash map and writes them in a new order each time, but the same table
/// must give the same bytes. Sorting moves no other byte, so the offsets of the scanlines stay right.
/// The layout is that of openexr.com, "OpenEXR File Layout": magic and version (4 bytes each), then per
/// attribute name\0 type\0 size (i32) value, then \0.
fn sort_attributes(file: &mut [u8]) -> Option<()> {
    const START: usize = 8;
    let mut attributes = Vec::new();
    let mut rest = file.get(START..)?;
    while *rest.first()? != 0 {
        let name = rest.iter().position(|&byte| byte == 0)?;
        let kind = name + 1 + rest.get(name + 1..)?.iter().position(|&byte| byte == 0)?;
        let size = rest.get(kind + 1..)?.first_chunk().copied().map(i32::from_le_bytes)?;
        let (attribute, after) = rest.split_at_checked(kind + 5 + usize::try_from(size).ok()?)?;
        attributes.push((attribute.get(..name)?, attribute));
        rest = after;
    }
    attributes.sort_unstable();
    let sorted: Vec<u8> = attributes.into_iter().flat_map(|(_, attribute)| attribute).copied().collect();
    file.get_mut(START..)?.get_mut(..sorted.len())?.copy_from_slice(&sorted);
    Some(())
}
