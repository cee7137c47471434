//! Composes the WGSL that one lobe of a table needs, from the files of its parts and of one kernel.
//!
//! Parts of a kind define the same names (`ndf`, `visibility`, `fresnel`, `lobe`), so a model is a
//! list of files and a kernel calls `lobe` whatever it is. A module holds one kernel and one model:
//! no switch over models is left for the device to run.

use crate::base::precision::Precision;
use crate::model::{Integral, Model, Part, part};

/// A compute kernel, with one entry point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kernel {
    /// Values over (α, θi, θe, δφ).
    Values,
    /// Values of a lobe without factors, stored in words of 64 bits.
    WideValues,
    /// Values, added to those of earlier lobes.
    AddValues,
    /// Values at a list of pairs of directions.
    Points,
    /// Values at a list of pairs, added to those of earlier lobes.
    AddPoints,
    /// Integrals in slopes, for tolerances that f32 can meet.
    Slopes,
    /// Integrals in slopes, for finer tolerances.
    FineSlopes,
    /// Integrals over (θe, δφ).
    Product,
    /// Integrals over directions that the host finds.
    Listed,
    /// Integrals by sampling the distribution of normals.
    Ndf,
    /// Integrals by sampling the visible normals.
    Vndf,
    /// Integrals by sampling the visible normals at random.
    Random,
    /// Integrals in closed form.
    Analytic,
    /// The outer sums, into channels.
    Sum,
    /// The outer sums, added to the channels of earlier lobes.
    AddSum,
    /// Texels of a texture.
    Pack,
    /// Irradiance of an environment map.
    #[cfg(feature = "light")]
    Irradiance,
    /// Nine spherical-harmonic coefficients of an environment map.
    #[cfg(feature = "light")]
    Harmonics,
    /// Stores alone, to measure the device's bandwidth.
    #[cfg(feature = "lab")]
    Fill,
    /// Arithmetic alone, to measure the device's operations a second.
    #[cfg(feature = "lab")]
    MultiplyAdd,
    /// The driver probe: how the driver rounds and how many turns its loops take.
    Canary,
}

/// The number of Gauss–Legendre nodes that tables of coarse tolerances take at most, as a test of the models holds: 64 KiB
/// in f64, which every device binds.
pub(crate) const COARSE_NODES: usize = 2048;

/// The number of quads of azimuths that one dispatch of values takes, in a uniform buffer, of which every device binds
/// 64 KiB.
pub(crate) const VALUE_WINDOW: usize = 512;
/// The number of terms of each azimuth in a quad.
pub(crate) const QUAD_FACTORS: usize = 7;

/// Composes the WGSL of `kernel` for `model` (`None` for kernels that evaluate no model) and a number of channels; 0
/// channels are the raw inner integrals, which an outer sum reads.
pub fn compose(kernel: Kernel, model: Option<&Model>, channels: usize, precision: Precision) -> String {
    let files = kernel.files(channels);
    if kernel.is_plain() {
        return files.iter().map(|part| part.wgsl).collect();
    }
    // One source for both: no kernel calls a transcendental built-in, which f64 lacks.
    let real = precision.name();
    let mut source = format!("alias real = {real};\nalias real2 = vec2<real>;\nalias real4 = vec4<real>;\n");
    if kernel == Kernel::Slopes {
        source += &format!("const NODES = {COARSE_NODES}u;\n");
    }
    let add = matches!(kernel, Kernel::AddValues | Kernel::AddPoints | Kernel::AddSum);
    source += &format!("const CHANNELS = {channels}u;\nconst ADD = {add};\n");
    if kernel.is_of_values() {
        let scaled = kernel != Kernel::WideValues;
        source += &format!("const WINDOW = {VALUE_WINDOW}u;\nconst SCALED = {scaled};\n");
    }
    let mut add = |part: &Part| {
        source += &format!("\n// ---- {}\n{}", part.name, part.wgsl);
        for (name, wgsl) in part.shared {
            let heading = format!("\n// ---- with {name}\n");
            if !source.contains(&heading) {
                source += &(heading + wgsl);
            }
        }
    };
    add(&part!("kernel/job"));
    if let Some(model) = model {
        add(&part!("pair"));
        model.parts.iter().for_each(&mut add);
        if let Integral::Slopes(slopes) = model.integral {
            match kernel {
                Kernel::Slopes => add(&slopes.coarse.part),
                Kernel::FineSlopes => add(&slopes.fine.part),
                Kernel::Ndf | Kernel::Vndf | Kernel::Random => {
                    slopes.sampling.iter().for_each(|sampling| add(&sampling.part));
                }
                _ => {}
            }
        }
    }
    files.iter().for_each(&mut add);
    match channels {
        _ if kernel.is_of_values() => {}
        0 => add(&part!("kernel/write_raw")),
        _ => add(&part!("kernel/write_channels")),
    }
    source
}

const VALUES: Part = part!("kernel/values");
const PUT: Part = part!("kernel/put");
pub(super) const PUT_WIDE: Part = part!("kernel/put_wide");

impl Kernel {
    /// The files of the kernel itself, in order.
    fn files(self, channels: usize) -> &'static [Part] {
        match (self, channels) {
            (Self::Values | Self::AddValues, 1) => &[PUT, part!("kernel/store_1"), VALUES],
            (Self::Values | Self::AddValues, 2) => &[PUT, part!("kernel/store_2"), VALUES],
            (Self::Values | Self::AddValues, _) => &[PUT, part!("kernel/store_3"), VALUES],
            (Self::WideValues, 1) => &[PUT_WIDE, part!("kernel/store_1"), VALUES],
            (Self::WideValues, 2) => &[PUT_WIDE, part!("kernel/store_2"), VALUES],
            (Self::WideValues, _) => &[PUT_WIDE, part!("kernel/store_3"), VALUES],
            (Self::Points | Self::AddPoints, _) => &[part!("kernel/point"), part!("kernel/points")],
            (Self::Listed, _) => &[part!("kernel/point"), part!("kernel/listed")],
            (Self::Slopes, _) => {
                &[part!("lobe/slopes"), part!("kernel/nodes_uniform"), part!("kernel/slopes")]
            }
            (Self::FineSlopes, _) => {
                &[part!("lobe/slopes"), part!("kernel/nodes_storage"), part!("kernel/slopes")]
            }
            (Self::Product, _) => &[part!("kernel/product")],
            (Self::Ndf, _) => &[part!("kernel/sampling"), part!("sampling/ndf"), part!("sampling/tabulated")],
            (Self::Vndf, _) => {
                &[part!("kernel/sampling"), part!("sampling/vndf"), part!("sampling/tabulated")]
            }
            (Self::Random, _) => {
                &[part!("kernel/sampling"), part!("sampling/vndf"), part!("sampling/random")]
            }
            (Self::Analytic, _) => &[part!("kernel/analytic")],
            (Self::Sum | Self::AddSum, _) => &[part!("kernel/sum")],
            (Self::Pack, _) => &[part!("kernel/pack")],
            #[cfg(feature = "lab")]
            (Self::Fill, _) => &[part!("probe/fill")],
            #[cfg(feature = "lab")]
            (Self::MultiplyAdd, _) => &[part!("probe/multiply_add")],
            #[cfg(feature = "light")]
            (Self::Irradiance, _) => &[part!("light/irradiance")],
            #[cfg(feature = "light")]
            (Self::Harmonics, _) => &[part!("light/harmonics")],
            (Self::Canary, _) => &[part!("probe/canary")],
        }
    }

    /// Whether the kernel evaluates a table of values.
    fn is_of_values(self) -> bool {
        matches!(self, Self::Values | Self::WideValues | Self::AddValues)
    }

    /// Whether the kernel takes no job, model or precision, so that its file is the whole shader.
    fn is_plain(self) -> bool {
        match self {
            Self::Pack | Self::Canary => true,
            #[cfg(feature = "light")]
            Self::Irradiance | Self::Harmonics => true,
            #[cfg(feature = "lab")]
            Self::Fill | Self::MultiplyAdd => true,
            _ => false,
        }
    }
}
