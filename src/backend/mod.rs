//! The evaluators of tables: the CPU path in f64, and a device through wgpu.

pub(crate) mod cpu;
pub mod gpu;
pub(crate) mod scaled_lobe;
