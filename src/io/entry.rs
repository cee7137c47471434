//! A table's entry in the manifest.

use crate::io::set::Files;
use crate::table::axis::{Axis, Mapping, Positions};
use crate::table::report::Choice;
use crate::table::storage::{Storage, UNORM};
use crate::table::{Table, TableError};
use serde::Serialize;
use std::collections::BTreeMap;

/// What the manifest says of one table, in the manifest's own order.
#[derive(Debug, Clone, Serialize)]
pub struct TableEntry<'a> {
    name: &'a str,
    quantity: &'a str,
    unit: &'a str,
    subject: &'a str,
    parameters: &'a BTreeMap<String, f64>,
    axes: Vec<AxisEntry<'a>>,
    channels: &'a [String],
    #[serde(flatten)]
    files: Files,
    rule: &'a str,
    precision: &'a str,
    storage: Storage,
    /// What an integer of an unorm16 NPY file is multiplied with.
    #[serde(skip_serializing_if = "Option::is_none")]
    scale: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    bilinear: Option<&'a Choice>,
    error: &'a TableError,
    seconds: f64,
}

impl<'a> TableEntry<'a> {
    /// The entry of a table that [`TableSet::write`](crate::io::TableSet::write) put into `files`.
    pub fn new(table: &'a Table, files: Files) -> Self {
        Self {
            name: &table.name,
            quantity: table.quantity.name,
            unit: table.quantity.unit,
            subject: &table.subject,
            parameters: &table.parameters,
            axes: axes(table),
            channels: &table.channels,
            files,
            rule: &table.rule,
            precision: table.precision.name(),
            storage: table.storage,
            scale: (table.storage == Storage::Unorm16).then_some(1.0 / UNORM),
            bilinear: table.bilinear.as_ref(),
            error: &table.error,
            seconds: table.seconds,
        }
    }
}

/// What the manifest and the EXR's `gonio:axes` say of one axis.
#[derive(Debug, Clone, Serialize)]
pub(super) struct AxisEntry<'a> {
    name: &'static str,
    unit: &'static str,
    mapping: Mapping,
    positions: Positions,
    range: [f64; 2],
    values: &'a [f64],
}

/// The entries of a table's axes, slowest first.
pub(super) fn axes(table: &Table) -> Vec<AxisEntry<'_>> {
    table.axes.iter().map(AxisEntry::new).collect()
}

impl<'a> AxisEntry<'a> {
    fn new(axis: &'a Axis) -> Self {
        let (variable, mapping, positions, range, values) =
            (axis.variable(), axis.mapping(), axis.positions(), axis.range(), axis.values());
        Self { name: variable.name(), unit: variable.unit(), mapping, positions, range, values }
    }
}
