//! The measured number tables of the models, computed from the models: `examples/tabulate.rs` writes them into the source, and
//! tests hold the source to them.

mod ggx_counts;

/// A file of measured numbers.
pub struct Tabulated {
    /// The name that the command takes.
    pub name: &'static str,
    /// The file, below the root of the repository.
    pub file: &'static str,
    /// What the numbers are.
    pub summary: &'static str,
    /// The file's text as it was compiled in.
    pub source: &'static str,
    /// Computes the text; `tick` is called as work is done, with a share of 1.
    pub compute: fn(tick: &(dyn Fn(f64) + Sync)) -> String,
}

/// The files that the command writes.
pub static TABLES: [Tabulated; 1] = [ggx_counts::TABLE];
