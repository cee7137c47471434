//! The number of a table's texels that are compared with the reference.

/// The texels of a table that are compared with the reference. Without the feature `check` nothing is compared (a table's
/// error then says so), but integrals are still certified by a second rule unless this is `Sample(0)`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Check {
    /// The corners and a low-discrepancy set of texels: at least this many, or all if there are fewer; 0: none.
    Sample(usize),
    /// All texels.
    All,
}

impl Default for Check {
    fn default() -> Self {
        Self::Sample(256)
    }
}

impl std::str::FromStr for Check {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, Self::Err> {
        match s {
            "all" => Ok(Self::All),
            _ => s.parse().map(Self::Sample).map_err(|_| format!("\"{s}\" is neither a count nor all")),
        }
    }
}
