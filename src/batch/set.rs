//! Bakes all tables of a plan into a folder, with its manifest, all or nothing.

use crate::bake::{Evaluator, Observer, within_tolerance};
use crate::base::error::{Error, Result};
use crate::base::timings::Stopwatch;
use crate::base::timings::Timings;
use crate::batch::stream;
use crate::batch::stream::{Progress, Streaming};
use crate::check::Check;
use crate::io;
use crate::io::target::Target;
use crate::io::{Files, Format, Provenance, TableEntry, TableSet, Tiles};
use crate::plan::TablePlan;
use crate::scene::LeftOut;
use crate::scene::planner::{Basis, MaterialPlan, Plan};
use crate::table::Table;
use crate::table::quantity::RHO_DH;
use serde::Serialize;
use std::collections::{BTreeSet, HashMap};
use std::panic::resume_unwind;
use std::path::Path;
use std::thread::{self, ScopedJoinHandle};

/// The options of a set: its formats, target, checks and streaming.
#[derive(Debug, Clone, PartialEq)]
pub struct SetOptions {
    /// The formats of each table's files.
    pub formats: Vec<&'static Format>,
    /// The target that the files are for.
    pub target: &'static Target,
    /// The texels of each table that are compared with the reference.
    pub check: Check,
    /// The tables that are written piece by piece.
    pub streaming: Streaming,
}

/// The contents of `manifest.json`.
#[derive(Debug, Serialize)]
struct Manifest<'a> {
    schema: u32,
    gonio: Version,
    scene: SceneFile,
    device: DeviceEntry,
    tolerance: f64,
    requirements: Requirements<'a>,
    tables: Vec<TableEntry<'a>>,
    stages: Timings,
}

#[derive(Debug, Serialize)]
struct Version {
    version: &'static str,
}

#[derive(Debug, Clone, Serialize)]
struct SceneFile {
    file: String,
    sha256: String,
}

#[derive(Debug, Serialize)]
struct DeviceEntry {
    kind: &'static str,
    name: String,
    driver: String,
}

#[derive(Debug, Serialize)]
struct Requirements<'a> {
    bases: &'a [Basis],
    left_out: &'a [LeftOut],
    warnings: Vec<String>,
    materials: &'a [MaterialPlan],
}

/// The result of baking a plan.
#[derive(Debug)]
pub struct Baked {
    /// The tables, in the plan's order, without their values: those are in the files, so that memory does not grow with
    /// the number of tables.
    pub tables: Vec<Table>,
    /// The files of each table.
    pub files: Vec<Files>,
    /// The plan's warnings, and those that the tables give reason for.
    pub warnings: Vec<String>,
    /// The tiles of streamed tables, and how many of them an earlier bake that was cut off had finished.
    pub tiles: Progress,
    /// The seconds of each stage.
    pub stages: Timings,
    /// The written manifest.
    pub manifest: serde_json::Value,
}

/// Bakes `plan`, which came from the file `scene`, into `dir`.
///
/// # Errors
/// When a table misses its tolerance, the device fails or a file cannot be written: what was in the
/// folder before is then still there, whole.
pub fn bake_set(
    plan: &Plan,
    scene: &Path,
    evaluator: &Evaluator,
    dir: &Path,
    options: &SetOptions,
    mut timings: Timings,
    observer: &dyn Observer,
) -> Result<Baked> {
    let scene = SceneFile { file: scene.display().to_string(), sha256: io::sha256(scene)? };
    let device = DeviceEntry::new(evaluator);
    let provenance = Provenance::from([
        ("scene".into(), scene.file.clone()),
        ("scene_sha256".into(), scene.sha256.clone()),
        ("device".into(), format!("{} ({})", device.name, device.driver)),
    ]);
    let set = TableSet::create(dir)?;
    let mut finished = Finished {
        set,
        options,
        provenance: &provenance,
        tables: Vec::new(),
        largest: Vec::new(),
        written: Vec::new(),
        misses: Vec::new(),
    };
    // Rows come in the order of the table: a target of another order takes it in one piece.
    let streams = |table: &&TablePlan| options.target.is_identity() && options.streaming.takes(table);
    let key =
        |table: &TablePlan| stream::key(table, &scene.sha256, &provenance["device"], &options.streaming);
    let keys: BTreeSet<_> = plan.tables.iter().filter(streams).map(key).collect();
    let mut progress = Progress::default();
    // A device that is lost is opened once more.
    let mut spare = None;
    // While the device computes a table, the cores check the one before and write the one before that.
    thread::scope(|scope| -> Result<()> {
        let mut checking = None;
        for table in &plan.tables {
            if streams(&table) {
                finished.take_checked(&mut checking, &mut timings)?;
                let tiles = finished.set.tiles(&keys, &key(table))?;
                let streamed = stream::bake(
                    evaluator,
                    &mut spare,
                    table,
                    &tiles,
                    options,
                    &mut progress,
                    &mut timings,
                    observer,
                );
                let (streamed, preview) = streamed.inspect_err(|error| {
                    if matches!(error, Error::Promise(_)) {
                        let _ = finished.set.discard_tiles(); // the same tiles would break the promise again
                    }
                })?;
                finished.take_streamed(table, streamed, &tiles, &preview, &mut timings, observer)?;
                continue;
            }
            let compute = |evaluator: &Evaluator, timings: &mut Timings| {
                evaluator.compute(table, options.check, timings, observer)
            };
            let computed = match compute(spare.as_ref().unwrap_or(evaluator), &mut timings) {
                Err(Error::Device(_)) if spare.is_none() => {
                    compute(spare.insert(evaluator.reopen()?), &mut timings)
                }
                result => result,
            };
            // An error of the table before comes before an error of this one.
            let before = checking.take().map(|check: Checking| check.end(&mut timings)).transpose()?;
            let computed = computed?;
            observer.begin(&format!("checking {}", table.name()));
            let check = move || {
                let start = Stopwatch::start();
                let checked = computed.check(table, options.check, &|share| observer.advance(share));
                (checked, start.seconds())
            };
            let thread = thread::Builder::new().spawn_scoped(scope, check);
            let no_thread = Error::io("start a thread to check", table.name());
            checking = Some(Checking { table, thread: thread.map_err(no_thread)? });
            if let Some((table, checked)) = before {
                finished.take(table, checked, &mut timings)?;
            }
        }
        finished.take_checked(&mut checking, &mut timings)
    })?;
    let Finished { set, tables, largest, written, mut misses, .. } = finished;
    if !misses.is_empty() {
        set.discard_tiles()?;
        misses.push(format!("{}: left as it was", dir.display()));
        return Err(Error::Promise(misses.join("\n")));
    }
    let warnings = plan.warnings.iter().cloned().chain(energy_warnings(plan, &tables, &largest));
    let warnings: Vec<_> = warnings.collect();
    let manifest = serde_json::to_value(Manifest {
        schema: 1,
        gonio: Version { version: env!("CARGO_PKG_VERSION") },
        scene,
        device,
        tolerance: plan.tolerance,
        requirements: Requirements {
            bases: &plan.bases,
            left_out: &plan.left_out,
            warnings: warnings.clone(),
            materials: &plan.materials,
        },
        tables: tables.iter().zip(&written).map(|(t, files)| TableEntry::new(t, files.clone())).collect(),
        stages: timings,
    })
    .map_err(|e| Error::Internal(format!("manifest: {e}")))?;
    set.commit(&manifest)?;
    Ok(Baked { tables, files: written, warnings, tiles: progress, stages: timings, manifest })
}

/// A table whose values a thread compares with the reference.
struct Checking<'scope, 'plan> {
    table: &'plan TablePlan,
    thread: ScopedJoinHandle<'scope, (Result<Table>, f64)>,
}

impl<'plan> Checking<'_, 'plan> {
    /// Waits for the thread.
    fn end(self, timings: &mut Timings) -> Result<(&'plan TablePlan, Table)> {
        let (checked, seconds) = self.thread.join().unwrap_or_else(|panic| resume_unwind(panic));
        timings.check += seconds;
        Ok((self.table, checked?))
    }
}

/// The finished tables, in the plan's order.
struct Finished<'a> {
    set: TableSet,
    options: &'a SetOptions,
    provenance: &'a Provenance,
    tables: Vec<Table>,
    /// The largest value of each table; of a streamed one it is not known.
    largest: Vec<Option<f64>>,
    written: Vec<Files>,
    /// The tolerances that tables missed; once there is one, nothing more is written.
    misses: Vec<String>,
}

impl Finished<'_> {
    /// Waits for the table that is being checked, if there is one, and takes it.
    fn take_checked(&mut self, checking: &mut Option<Checking>, timings: &mut Timings) -> Result<()> {
        let Some(check) = checking.take() else { return Ok(()) };
        let (plan, table) = check.end(timings)?;
        self.take(plan, table, timings)
    }

    fn take(&mut self, plan: &TablePlan, table: Table, timings: &mut Timings) -> Result<()> {
        let is_met = self.is_met(plan, &table);
        self.largest.push(Some(table.values.iter().fold(0.0, f64::max)));
        let mut table = self.options.target.apply(table)?;
        if is_met {
            let start = Stopwatch::start();
            let formats = self.options.target.formats(&self.options.formats);
            self.written.push(self.set.write(&table, &formats, self.provenance)?);
            timings.write += start.seconds();
        }
        table.values = Vec::<f32>::new().into();
        self.tables.push(table);
        Ok(())
    }

    fn take_streamed(
        &mut self,
        plan: &TablePlan,
        table: Table,
        tiles: &Tiles,
        preview: &Table,
        timings: &mut Timings,
        observer: &dyn Observer,
    ) -> Result<()> {
        if self.is_met(plan, &table) {
            observer.begin(&format!("writing {}", table.name));
            let start = Stopwatch::start();
            let formats = self.options.target.formats(&self.options.formats);
            let tick = &mut |share| observer.advance(share);
            let written = self.set.write_streamed(&table, tiles, preview, &formats, self.provenance, tick)?;
            self.written.push(written);
            timings.write += start.seconds();
        }
        self.largest.push(None);
        self.tables.push(table);
        Ok(())
    }

    /// Whether this table and all before it meet their tolerances.
    fn is_met(&mut self, plan: &TablePlan, table: &Table) -> bool {
        self.misses.extend(within_tolerance(plan, table).err().map(|miss| miss.to_string()));
        self.misses.is_empty()
    }
}

/// Warns of materials that reflect more light than they receive.
fn energy_warnings(plan: &Plan, tables: &[Table], largest: &[Option<f64>]) -> Vec<String> {
    let materials: HashMap<_, _> = plan.materials.iter().map(|m| (m.name.as_str(), m)).collect();
    let warning = |(table, largest): (&Table, &Option<f64>)| {
        let material = materials.get(table.subject.as_str()).filter(|_| table.quantity == &RHO_DH)?;
        let largest = largest.filter(|&largest| largest > 1.0 + plan.tolerance)?;
        Some(format!(
            "{}: reflects up to {largest:.4} of what it receives; its lobes are added without conserving energy{}",
            table.subject,
            if material.metallic.is_some() { ", as glTF 2.0 defines them" } else { "" }
        ))
    };
    tables.iter().zip(largest).filter_map(warning).collect()
}

impl DeviceEntry {
    fn new(evaluator: &Evaluator) -> Self {
        match evaluator {
            Evaluator::Device(device) => {
                Self { kind: device.kind(), name: device.name().into(), driver: device.driver() }
            }
            Evaluator::Cpu => Self { kind: "CPU", name: "CPU path".into(), driver: "f64".into() },
        }
    }
}
