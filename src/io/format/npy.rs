//! NumPy files: shape = axes in order, channel last, little-endian float32 or
//! float64, C order.

use crate::base::error::{Error, Result};
use crate::io::Provenance;
use crate::io::format::{Format, RowWriter, Streamed};
use crate::table::storage::{Storage, UNORM};
use crate::table::{Table, Values};
use half::f16;
use npyz::{DType, NpyWriter, Serialize, WriteOptions, WriterBuilder};

/// NumPy: little-endian float32, float64, float16 or uint16 as the table is stored, shape = axes in order, channel last.
pub static NPY: Format = Format {
    name: "npy",
    extension: "npy",
    summary: "NumPy: an array of the table's axes, its channels last",
    encode,
    streamed: Streamed::Rows(begin_rows),
};

/// The bytes of the file.
fn encode(table: &Table, _: &Provenance) -> Result<Vec<u8>> {
    write(table).map_err(|error| Error::Internal(format!("table {}: NPY: {error}", table.name)))
}

/// The file up to its first value.
fn begin_rows(table: &Table, _: &Provenance, file: &mut Vec<u8>) -> Result<Box<dyn RowWriter>> {
    let head = head(&shape(table));
    file.extend(head.map_err(|error| Error::Internal(format!("table {}: NPY: {error}", table.name)))?);
    Ok(Box::new(NpyRows))
}

/// The values of an array in f32, one after the other.
struct NpyRows;

impl RowWriter for NpyRows {
    fn append(&mut self, texels: &[f32], file: &mut Vec<u8>) {
        file.extend(texels.iter().flat_map(|value| value.to_le_bytes()));
    }
}

/// The file of an array of f32 up to its first value.
pub(in crate::io) fn head(shape: &[u64]) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    drop(begin::<f32>("<f4", shape, &mut bytes)?);
    Ok(bytes)
}

fn write(table: &Table) -> std::io::Result<Vec<u8>> {
    let shape = shape(table);
    // Little-endian on every machine, so that the same table gives the same bytes.
    match (&table.values, table.storage) {
        (values, Storage::F16) => array("<f2", &shape, values.iter().map(f16::from_f64)),
        // Stored values are k/65535 to within f32: rounding gives k back.
        (values, Storage::Unorm16) => array("<u2", &shape, values.iter().map(|v| (v * UNORM).round() as u16)),
        (Values::F32(values), _) => array("<f4", &shape, values.iter().copied()),
        (Values::F64(values), _) => array("<f8", &shape, values.iter().copied()),
    }
}

fn array<T: Serialize>(
    dtype: &str,
    shape: &[u64],
    values: impl Iterator<Item = T>,
) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut writer = begin(dtype, shape, &mut bytes)?;
    writer.extend(values)?;
    writer.finish()?;
    Ok(bytes)
}

fn begin<'a, T: Serialize>(
    dtype: &str,
    shape: &[u64],
    bytes: &'a mut Vec<u8>,
) -> std::io::Result<NpyWriter<T, &'a mut Vec<u8>>> {
    let dtype = DType::Plain(dtype.parse().map_err(std::io::Error::other)?);
    WriteOptions::new().dtype(dtype).shape(shape).writer(bytes).begin_nd()
}

fn shape(table: &Table) -> Vec<u64> {
    let shape = table.axes.iter().map(|axis| axis.len()).chain([table.channels.len()]);
    shape.map(|n| n as u64).collect()
}
