//! Bakes all tables of a plan and writes them as one set of files.

mod set;
mod stream;

pub use set::{Baked, SetOptions, bake_set};
pub use stream::{Progress, Streaming};
