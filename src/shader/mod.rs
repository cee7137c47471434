//! WGSL sources: composed of parts, validated, and those of an embedder's own models registered.

mod compose;
mod register;
mod validate;

pub(crate) use compose::{COARSE_NODES, QUAD_FACTORS, VALUE_WINDOW};
pub use compose::{Kernel, compose};
pub use register::register;
pub use validate::validate;
