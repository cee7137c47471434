//! `gonio licenses`

use crate::base::error::Result;
use crate::cli::print::print;

/// Prints the licences of the crates and fonts that the program is made of.
pub fn run() -> Result<()> {
    print(include_str!("../../THIRD-PARTY.md").trim_end())
}
