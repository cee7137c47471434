//! NumPy files: shape = axes in order, channel last, little-endian float32, C order.

use crate::error::{Error, Result};
use crate::table::Table;
use npyz::{DType, WriteOptions, WriterBuilder};

/// The bytes of the file.
pub(super) fn encode(table: &Table) -> Result<Vec<u8>> {
    write(table).map_err(|error| Error::Internal(format!("table {}: NPY: {error}", table.name)))
}

fn write(table: &Table) -> std::io::Result<Vec<u8>> {
    let shape = table.axes.iter().map(|axis| axis.len()).chain([table.channels.len()]);
    let shape: Vec<u64> = shape.map(|n| n as u64).collect();
    // Little-endian on every machine, so that the same table gives the same bytes.
    let dtype = DType::Plain("<f4".parse().map_err(std::io::Error::other)?);
    let mut bytes = Vec::new();
    let mut writer = WriteOptions::new().dtype(dtype).shape(&shape).writer(&mut bytes).begin_nd()?;
    writer.extend(table.values.iter().copied())?;
    writer.finish()?;
    Ok(bytes)
}
