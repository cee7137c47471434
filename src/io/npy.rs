//! NumPy files: shape = axes in order, channel last, little-endian float32 or
//! float64, C order.

use crate::base::error::{Error, Result};
use crate::table::storage::{Storage, UNORM};
use crate::table::{Table, Values};
use half::f16;
use npyz::{DType, NpyWriter, Serialize, WriteOptions, WriterBuilder};

/// The bytes of the file.
pub(super) fn encode(table: &Table) -> Result<Vec<u8>> {
    write(table).map_err(|error| Error::Internal(format!("table {}: NPY: {error}", table.name)))
}

/// The file up to its first value, for a table in f32 whose values come later.
pub(super) fn head(table: &Table) -> Result<Vec<u8>> {
    head_of(&shape(table)).map_err(|error| Error::Internal(format!("table {}: NPY: {error}", table.name)))
}

/// The file up to its first value, for an array of f32.
pub(super) fn head_of(shape: &[u64]) -> std::io::Result<Vec<u8>> {
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
