//! Composes the WGSL that one lobe of a table needs, and nothing else.
//!
//! Parts of a kind define the same names (`ndf`, `visibility`, `fresnel`, `lobe`), so a model is a
//! list of files and a kernel calls `lobe` whatever it is. A module holds one kernel and one model:
//! no switch over models is left for the device to run.

use crate::error::{Error, Result};
use crate::models::{Integral, Model, Part};
use crate::plan::Precision;
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
    /// The same where azimuths or nodes do not fit a uniform binding.
    SlopesOfMany,
    /// Integrals over (θe, δφ).
    Product,
    /// Integrals by sampling the distribution of normals.
    Ndf,
    /// Integrals by sampling the visible normals.
    Vndf,
    /// The same, at random.
    Random,
    /// Integrals in closed form.
    Analytic,
    /// The outer sums, into channels.
    Sum,
    /// Texels of a texture.
    Pack,
    /// Nothing but stores.
    Fill,
    /// Nothing but arithmetic.
    MultiplyAdd,
}

/// Vectors of four that fit a uniform binding of 64 KiB, which every device has.
pub(super) fn vectors(precision: Precision) -> usize {
    (1 << 16) / (4 * precision.bytes())
}

macro_rules! shader {
    ($name:literal) => {
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/", $name, ".wgsl"))
    };
}

/// Rows and quads of azimuths that one dispatch of values takes: 32 bytes each in a uniform buffer, of which
/// every device binds 64 KiB.
pub(super) const VALUE_WINDOW: usize = 1024;

/// The WGSL of `kernel` for `model` (none: kernels that evaluate no model) and so many channels.
pub fn compose(kernel: Kernel, model: Option<&Model>, channels: usize, precision: Precision) -> String {
    match kernel {
        Kernel::Pack => return shader!("kernel/pack").into(),
        Kernel::Fill => return shader!("probe/fill").into(),
        Kernel::MultiplyAdd => return shader!("probe/multiply_add").into(),
        _ => {}
    }
    // One source for both: no kernel calls a transcendental built-in, which f64 lacks.
    let real = precision.name();
    let mut source = format!("alias real = {real};\nalias real2 = vec2<real>;\nalias real4 = vec4<real>;\n");
    if matches!(kernel, Kernel::Slopes | Kernel::SlopesOfMany) {
        source += &format!("const VECTORS = {}u;\n", vectors(precision));
    }
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
    if let (
        Kernel::Ndf | Kernel::Vndf | Kernel::Random,
        Some(Model { integral: Integral::Slopes(slopes), .. }),
    ) = (kernel, model)
    {
        let Part { name, wgsl } = slopes.sampling.part;
        add(name, wgsl);
        add("kernel/sampling", shader!("kernel/sampling"));
    }
    match kernel {
        Kernel::Ndf => {
            add("sampling/ndf", shader!("sampling/ndf"));
            add("sampling/tabulated", shader!("sampling/tabulated"));
        }
        Kernel::Vndf => {
            add("sampling/vndf", shader!("sampling/vndf"));
            add("sampling/tabulated", shader!("sampling/tabulated"));
        }
        Kernel::Random => {
            add("sampling/vndf", shader!("sampling/vndf"));
            add("sampling/random", shader!("sampling/random"));
        }
        Kernel::Values | Kernel::AddValues => add("kernel/values", shader!("kernel/values")),
        Kernel::Slopes => {
            add("kernel/slopes_uniform", shader!("kernel/slopes_uniform"));
            add("kernel/slopes", shader!("kernel/slopes"));
        }
        Kernel::SlopesOfMany => {
            add("kernel/slopes_storage", shader!("kernel/slopes_storage"));
            add("kernel/slopes", shader!("kernel/slopes"));
        }
        Kernel::Product => add("kernel/product", shader!("kernel/product")),
        Kernel::Analytic => add("kernel/analytic", shader!("kernel/analytic")),
        Kernel::Sum => add("kernel/sum", shader!("kernel/sum")),
        Kernel::Pack | Kernel::Fill | Kernel::MultiplyAdd => {}
    }
    source
}

/// Parses and validates a composed shader before any device sees it: for what every WebGPU device has,
/// and f64 where that is the precision.
pub fn validate(source: &str, precision: Precision) -> Result<naga::Module> {
    let fault = |what: String| Error::Internal(format!("a composed shader is not valid WGSL: {what}"));
    let module = naga::front::wgsl::parse_str(source).map_err(|e| fault(e.emit_to_string(source)))?;
    // pack2x16float is core WGSL; naga counts it because old GLES lacks it.
    let mut capabilities = Capabilities::SHADER_FLOAT16_IN_FLOAT32;
    capabilities.set(Capabilities::FLOAT64, precision == Precision::F64);
    Validator::new(ValidationFlags::all(), capabilities)
        .validate(&module)
        .map_err(|e| fault(e.emit_to_string(source)))?;
    Ok(module)
}
