//! WGSL sources: composes them of parts, validates them, and registers the models of an embedder.

mod compose;
mod register;
mod validate;

pub(crate) use compose::{COARSE_NODES, QUAD_FACTORS, VALUE_WINDOW};
pub use compose::{Kernel, compose};
pub use register::register;
pub use validate::validate;
