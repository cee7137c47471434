//! Files: one writer a format, and whole sets of tables written all or nothing; lists of directions, and
//! values at them.

mod disk;
pub(crate) mod draw;
mod entry;
pub mod format;
#[cfg(feature = "cli")]
mod list;
mod manifest;
mod outputs;
#[cfg(feature = "cli")]
mod pairs;
mod set;
mod stream;
pub mod target;
mod temporary;
mod verify;

pub use entry::TableEntry;
pub use format::Format;
#[cfg(feature = "cli")]
pub(crate) use list::List;
pub(crate) use manifest::hash;
#[cfg(feature = "cli")]
pub(crate) use manifest::listed_files;
pub use manifest::{read_manifest, sha256};
pub(crate) use outputs::{Outputs, write_together};
#[cfg(feature = "cli")]
pub(crate) use pairs::Pairs;
pub use set::{Files, TableSet};
pub(crate) use stream::Tiles;
#[cfg(feature = "cli")]
pub(crate) use temporary::abandon;
#[cfg(feature = "cli")]
pub(crate) use verify::leftovers;
pub use verify::verify;

use std::collections::BTreeMap;

/// What a table came from, by name: the scene, its hash, the device. No times: the same input gives
/// the same bytes.
pub type Provenance = BTreeMap<String, String>;
