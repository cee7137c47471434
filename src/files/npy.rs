//! NumPy files: shape = axes in order, channel last, little-endian float32, C order.

use crate::error::{Error, Result};
use crate::table::Table;
use npyz::{DType, NpyWriter, WriteOptions, WriterBuilder};

/// The bytes of the file.
pub(super) fn encode(table: &Table) -> Result<Vec<u8>> {
    write(table).map_err(|error| Error::Internal(format!("table {}: NPY: {error}", table.name)))
}

/// The file up to its first value.
pub(super) fn head(table: &Table) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let fault = |error| Error::Internal(format!("table {}: NPY: {error}", table.name));
    drop(begin(table, &mut bytes).map_err(fault)?);
    Ok(bytes)
}

fn write(table: &Table) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut writer = begin(table, &mut bytes)?;
    writer.extend(table.values.iter().copied())?;
    writer.finish()?;
    Ok(bytes)
}

fn begin<'a>(table: &Table, bytes: &'a mut Vec<u8>) -> std::io::Result<NpyWriter<f32, &'a mut Vec<u8>>> {
    let shape = table.axes.iter().map(|axis| axis.len()).chain([table.channels.len()]);
    let shape: Vec<u64> = shape.map(|n| n as u64).collect();
    // Little-endian on every machine, so that the same table gives the same bytes.
    let dtype = DType::Plain("<f4".parse().map_err(std::io::Error::other)?);
    WriteOptions::new().dtype(dtype).shape(&shape).writer(bytes).begin_nd()
}
