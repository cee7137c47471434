//! What is known of a table beside its values: its bilinear error, and the layout that was chosen for it.

use super::storage::Storage;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;

/// The error of bilinear look-ups, absolute.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InterpolationError {
    /// How the table is sampled: `bilinear`.
    pub kind: &'static str,
    /// The largest error found in `domain`, against the reference; `None` where the table has no part of it.
    pub max: Option<f64>,
    /// The root mean square over all of the axes' range, even in each variable.
    pub rms: f64,
    /// Where `max` was looked for: [min, max] of each axis.
    pub domain: BTreeMap<String, [f64; 2]>,
    /// Where it was found, axis by axis, with the channel and both values.
    pub worst: BTreeMap<String, f64>,
    /// Look-ups compared with the fast f64 path, which finds the worst and the rms.
    pub points: usize,
    /// Look-ups compared with the reference.
    pub points_checked: usize,
    /// The largest difference between the fast path and the reference in those.
    pub certified: f64,
}

/// What the optimiser chose for a table, and instead of what.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Choice {
    /// The table as it is.
    pub chosen: Layout,
    /// The best one that differs in more than size.
    pub runner_up: Option<Layout>,
    /// Bytes of 128 texel centres along each chosen axis in half floats, as engines have it.
    pub usual_bytes: usize,
}

/// Axes, format and what they cost.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Layout {
    /// In words, axis by axis: "sqrt nodes [0.05, 1] × 48".
    pub axes: Vec<String>,
    /// The format.
    pub storage: Storage,
    /// Of the table.
    pub bytes: usize,
    /// The largest error of bilinear look-ups where the promise holds, by the plan's own arithmetic.
    pub error: f64,
}

impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "chosen {}", self.chosen)?;
        if let Some(next) = &self.runner_up {
            write!(f, "; next best {next}")?;
        }
        let share = self.chosen.bytes as f64 / self.usual_bytes as f64;
        write!(f, "; {:.0} % of the {} bytes of 128 centres in f16", 100.0 * share, self.usual_bytes)
    }
}

impl fmt::Display for Layout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { storage, bytes, error, .. } = self;
        write!(f, "{} in {}, {bytes} bytes, {error:.2e} bilinear", self.axes.join(" × "), storage.name())
    }
}
