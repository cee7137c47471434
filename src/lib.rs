//! **gonio**: a gonioreflectometer in compute shaders.

pub mod axis;
pub mod bake;
pub mod check;
mod cpu;
pub mod gpu;
pub mod error;
//CFG
//FILES pub mod files;
pub mod models;
pub mod pair;
pub mod plan;
pub mod quadrature;
pub mod quantity;
pub mod reference;
pub mod scene;
pub mod table;
mod work;
