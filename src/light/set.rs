//! Writes tables of light as one set of files with a manifest.

use crate::bake::Evaluator;
use crate::base::error::Result;
use crate::base::timings::Timings;
use crate::io::format::Format;
use crate::io::target::IDENTITY;
use crate::io::{Provenance, TableEntry, TableSet};
use crate::light::bake::Order;
use crate::table::Table;
use serde_json::{Map, Value, json};

/// Where a light comes from, for the manifest.
pub struct LightSource {
    /// The name of a file, or words that describe the light.
    pub name: String,
    /// What the manifest says of it.
    pub json: Value,
    /// The hash of its file, if it has one.
    pub sha256: Option<String>,
}

/// What a set of light's tables says beside them.
pub struct SetDetails<'a> {
    /// The light.
    pub source: &'a LightSource,
    /// The name of the material that is lit, if one is.
    pub material: Option<&'a str>,
    /// The formats of the files.
    pub formats: &'a [&'static Format],
    /// The share of ∫ L dω that three bands of harmonics miss, if harmonics are among the tables.
    pub truncation: Option<f64>,
    /// Where the time went.
    pub timings: &'a Timings,
    /// Further files of the set, such as a picture: names and contents.
    pub files: &'a [(&'static str, Vec<u8>)],
}

impl Order<'_> {
    /// Writes tables and further files into a set, and returns the tables as they were written, with the manifest. The set
    /// is on disk when the caller commits it with that manifest.
    ///
    /// # Errors
    /// When a table misses the order's tolerance, a format cannot hold it, or a file cannot be written.
    pub fn write(
        &self,
        set: &mut TableSet,
        tables: Vec<Table>,
        details: &SetDetails,
    ) -> Result<(Vec<Table>, Value)> {
        tables.iter().try_for_each(|table| self.within_tolerance(table))?;
        let device = device_json(self.evaluator);
        let SetDetails { source, material, formats, truncation, timings, files } = details;
        let mut provenance = Provenance::from([
            ("light".into(), source.name.clone()),
            ("device".into(), format!("{} ({})", device["name"], device["driver"])),
        ]);
        provenance.extend(source.sha256.iter().map(|hash| ("light_sha256".into(), hash.clone())));
        let tables = tables.into_iter().map(|table| IDENTITY.apply(table)).collect::<Result<Vec<_>>>()?;
        let mut entries = Vec::new();
        for table in &tables {
            let written = set.write(table, formats, &provenance)?;
            entries.push(TableEntry::new(table, written));
        }
        let mut hashes = Map::new();
        for (name, bytes) in *files {
            let (name, sha256) = set.add(name, bytes)?;
            hashes.insert(name, sha256.into());
        }
        let manifest = json!({
            "schema": 1, "kind": "light", "gonio": { "version": env!("CARGO_PKG_VERSION") },
            "light": source.json, "material": material, "device": device,
            "tolerance": self.tolerance, "truncation": truncation, "tables": entries, "files": hashes,
            "stages": timings,
        });
        Ok((tables, manifest))
    }
}

/// What a manifest says of an evaluator.
pub(crate) fn device_json(evaluator: &Evaluator) -> Value {
    match evaluator {
        Evaluator::Device(device) => {
            json!({ "kind": device.kind(), "name": device.name(), "driver": device.driver() })
        }
        Evaluator::Cpu => json!({ "kind": "CPU", "name": "cpu", "driver": "f64" }),
    }
}
