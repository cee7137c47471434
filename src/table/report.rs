//! Reports about a table: its bilinear error, and the layout that was chosen for it.

use super::storage::Storage;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;

/// The absolute error of bilinear look-ups in a table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InterpolationError {
    /// The kind of look-up: `bilinear`.
    pub kind: &'static str,
    /// The largest error found in `domain`, against the reference; `None` where the table has no part of it.
    pub max: Option<f64>,
    /// The root mean square over all of the axes' range, even in each variable.
    pub rms: f64,
    /// The domain in which `max` was searched: [min, max] of each axis.
    pub domain: BTreeMap<String, [f64; 2]>,
    /// The coordinates of `max`, axis by axis, with its channel and both values.
    pub worst: BTreeMap<String, f64>,
    /// The number of look-ups compared with the fast f64 path, which finds the worst and the rms.
    pub points: usize,
    /// The number of look-ups compared with the reference.
    pub points_checked: usize,
    /// The largest difference between the fast path and the reference among those.
    pub certified: f64,
}

/// The layout that the layout search chose for a table, with the next best.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Choice {
    /// The layout of the table.
    pub chosen: Layout,
    /// The best one that differs in more than size.
    pub runner_up: Option<Layout>,
    /// Bytes of 128 texel centres along each chosen axis in half floats, as engines have it.
    pub usual_bytes: usize,
}

/// A table's axes and storage format, with their bytes and bilinear error.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Layout {
    /// The axes in words, such as "sqrt nodes [0.05, 1] × 48".
    pub axes: Vec<String>,
    /// The storage format.
    pub storage: Storage,
    /// The bytes of the table.
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
