//! Composes the WGSL that one lobe of a table needs, and nothing else.
//!
//! Parts of a kind define the same names (`ndf`, `visibility`, `fresnel`, `lobe`), so a model is a
//! list of files and a kernel calls `lobe` whatever it is. A module holds one kernel and one model:
//! no switch over models is left for the device to run.

use crate::error::{Error, Result};
use crate::models::{Model, Part};
use naga::valid::{Capabilities, ValidationFlags, Validator};

/// A kernel: one entry point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kernel {
    /// Values over (α, θi, θe, δφ).
    Values,
    /// The same, added to those of earlier lobes.
    AddValues,
    /// Integrals in slopes.
    Slopes,
    /// Integrals over (θe, δφ).
    Product,
    /// Integrals in closed form.
    Analytic,
    /// The outer sums, into channels.
    Sum,
    /// Texels of a texture.
    Pack,
}

macro_rules! shader {
    ($name:literal) => {
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/", $name, ".wgsl"))
    };
}

/// The arithmetic of every kernel.
const PRECISION: &str = "alias real = f32;\nalias real2 = vec2<real>;\nalias real4 = vec4<real>;\n";

/// Rows and quads of azimuths that one dispatch of values takes: 32 bytes each, 64 in f64, in a uniform
/// buffer, of which every device binds 64 KiB.
pub(super) const VALUE_WINDOW: usize = 1024;

/// The WGSL of `kernel` for `model` (none: kernels that evaluate no model) and so many channels.
pub fn compose(kernel: Kernel, model: Option<&Model>, channels: usize) -> String {
    if kernel == Kernel::Pack {
        return shader!("kernel/pack").into();
    }
    let mut source = String::from(PRECISION);
    let mut add = |name: &str, wgsl: &str| source.push_str(&format!("\n// ---- {name}\n{wgsl}"));
    add("kernel/job", shader!("kernel/job"));
    if let Some(model) = model {
        add("pair", shader!("pair"));
        for Part { name, wgsl } in model.parts {
            add(name, wgsl);
        }
    }
    if let Kernel::Values | Kernel::AddValues = kernel {
        let constants =
            format!("const ADD = {};\nconst WINDOW = {VALUE_WINDOW}u;\n", kernel == Kernel::AddValues);
        add("constants", &constants);
        match channels {
            1 => add("kernel/store_1", shader!("kernel/store_1")),
            2 => add("kernel/store_2", shader!("kernel/store_2")),
            _ => add("kernel/store_3", shader!("kernel/store_3")),
        }
    }
    match kernel {
        Kernel::Values | Kernel::AddValues => add("kernel/values", shader!("kernel/values")),
        Kernel::Slopes => add("kernel/slopes", shader!("kernel/slopes")),
        Kernel::Product => add("kernel/product", shader!("kernel/product")),
        Kernel::Analytic => add("kernel/analytic", shader!("kernel/analytic")),
        Kernel::Sum => add("kernel/sum", shader!("kernel/sum")),
        Kernel::Pack => {}
    }
    source
}

/// Parses and validates a composed shader for what every WebGPU device has, before any device sees
/// it.
pub fn validate(source: &str) -> Result<naga::Module> {
    let fault = |what: String| Error::Internal(format!("a composed shader is not valid WGSL: {what}"));
    let module = naga::front::wgsl::parse_str(source).map_err(|e| fault(e.emit_to_string(source)))?;
    // pack2x16float is core WGSL; naga counts it because old GLES lacks it.
    Validator::new(ValidationFlags::all(), Capabilities::SHADER_FLOAT16_IN_FLOAT32)
        .validate(&module)
        .map_err(|e| fault(e.emit_to_string(source)))?;
    Ok(module)
}
