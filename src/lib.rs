//! **gonio**: a gonioreflectometer in compute shaders.

pub mod axis;
pub mod bake;
pub mod check;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;
mod cpu;
pub mod error;
#[cfg(feature = "files")]
pub mod files;
pub mod gpu;
pub mod models;
pub mod pair;
pub mod plan;
pub mod quadrature;
pub mod quantity;
pub mod reference;
pub mod scene;
pub mod table;
mod work;

pub use wgpu;
