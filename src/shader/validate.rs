//! Validates a composed shader before a device sees it.

use super::compose::PUT_WIDE;
use crate::base::error::{Error, Result};
use crate::base::precision::Precision;
use naga::valid::{Capabilities, ValidationFlags, Validator};

/// Parses and validates a composed shader before any device sees it, against the features that every WebGPU device has,
/// with f64 where that is the precision, and words of 64 bits where values are stored so.
pub fn validate(source: &str, precision: Precision) -> Result<naga::Module> {
    let invalid = |why: String| Error::Internal(format!("a composed shader is not valid WGSL: {why}"));
    let module = naga::front::wgsl::parse_str(source).map_err(|e| invalid(e.emit_to_string(source)))?;
    // pack2x16float is core WGSL; naga counts it because old GLES lacks it.
    let mut capabilities = Capabilities::SHADER_FLOAT16_IN_FLOAT32;
    capabilities.set(Capabilities::FLOAT64, precision == Precision::F64);
    capabilities.set(Capabilities::SHADER_INT64, source.contains(PUT_WIDE.wgsl));
    Validator::new(ValidationFlags::all(), capabilities)
        .validate(&module)
        .map_err(|e| invalid(e.emit_to_string(source)))?;
    Ok(module)
}
