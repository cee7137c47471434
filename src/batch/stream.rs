//! Bakes a table larger than memory, tile by tile, and keeps each on disk as soon as it is done.

use crate::backend::cpu;
use crate::bake::{Evaluator, Observer};
use crate::base::error::{Error, Result};
use crate::base::precision::Precision;
use crate::base::timings::Timings;
use crate::batch::SetOptions;
use crate::check::Comparison;
use crate::io;
use crate::io::Tiles;
use crate::plan::TablePlan;
use crate::shader::{Kernel, compose};
use crate::table::axis::Axis;
use crate::table::{Table, Values, indices};
use std::ops::Range;

/// The tables that are baked and written piece by piece, in bounded memory. Their files are the same as of other tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Streaming {
    /// The number of values above which a table of values in f32 is streamed.
    pub above: usize,
    /// The bytes of a tile, which has at least one row of the last axis.
    pub tile: usize,
}

impl Default for Streaming {
    fn default() -> Self {
        Self { above: 1 << 25, tile: 1 << 25 }
    }
}

/// The tiles of a streamed bake, and those that it found when it began.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Progress {
    /// The number of tiles of all streamed tables.
    pub all: usize,
    /// The number of tiles that an earlier bake, cut off, had finished.
    pub found: usize,
}

impl Streaming {
    /// Whether this table is streamed.
    pub(super) fn takes(&self, table: &TablePlan) -> bool {
        table.can_stream() && table.texels() * table.channels().len() > self.above
    }

    /// The rows of each tile: a row is the last axis.
    fn tiles(&self, table: &TablePlan) -> Vec<Range<usize>> {
        let width = table.axes().last().map_or(1, Axis::len);
        let rows = table.texels() / width;
        let per_tile = (self.tile / (4 * width * table.channels().len())).max(1);
        (0..rows).step_by(per_tile).map(|first| first..(first + per_tile).min(rows)).collect()
    }
}

/// The key of everything that decides a tile's bytes. With any difference a bake starts over.
pub(super) fn key(table: &TablePlan, scene: &str, device: &str, streaming: &Streaming) -> String {
    let shaders: String = table
        .lobes()
        .iter()
        .map(|lobe| compose(Kernel::Values, Some(lobe.model()), table.channels().len(), Precision::F32))
        .collect();
    let version = env!("CARGO_PKG_VERSION");
    let all = format!("{version}\n{scene}\n{device}\n{streaming:?}\n{table:?}\n{shaders}");
    io::hash(all.as_bytes())[..32].to_string()
}

/// Bakes a table into `tiles` and measures its error. Returns the table without its values, and a preview of it. Tiles
/// that an earlier bake finished are checked like new ones, but not computed.
///
/// `spare` takes the place of a device that is lost; it is opened once.
#[allow(clippy::too_many_arguments)]
pub(super) fn bake(
    evaluator: &Evaluator,
    spare: &mut Option<Evaluator>,
    plan: &TablePlan,
    tiles: &Tiles,
    options: &SetOptions,
    progress: &mut Progress,
    timings: &mut Timings,
    observer: &dyn Observer,
) -> Result<(Table, Table)> {
    observer.begin(&format!("baking {}", plan.name()));
    let before = timings.dispatch + timings.readback;
    let ranges = options.streaming.tiles(plan);
    let width = plan.axes().last().map_or(1, Axis::len);
    let row = width * plan.channels().len();
    let estimate = evaluator.path(plan).estimate(plan);
    let unknown = Comparison::new(plan, options.check, None).finish();
    let mut pass = Pass {
        table: evaluator.origin(plan, 0.0).table(plan, Values::F32(Vec::new()), unknown),
        comparison: Comparison::new(plan, options.check, estimate),
        preview: Preview::new(plan),
        done: 0,
    };
    progress.all += ranges.len();
    while pass.done < ranges.len() {
        let first = pass.done;
        let share = |k: usize| ranges[k].len() as f64 / ranges[ranges.len() - 1].end as f64;
        let texels = |k: usize| ranges[k].start * width..ranges[k].end * width;
        if let Some(values) = tiles.load(first, ranges[first].len() * row) {
            progress.found += 1;
            pass.add(texels(first), &values)?;
            observer.advance(share(first))?;
            continue;
        }
        let end = (first + 1..ranges.len()).find(|&k| tiles.has(k)).unwrap_or(ranges.len());
        let mut store = |k: usize, values: &[f32]| {
            tiles.store(first + k, values)?;
            pass.add(texels(first + k), values)?;
            observer.advance(share(first + k))
        };
        match spare.as_ref().unwrap_or(evaluator).stream(plan, &ranges[first..end], timings, &mut store) {
            Err(Error::Device(_)) if spare.is_none() => *spare = Some(evaluator.reopen()?),
            result => result?,
        }
    }
    let seconds = timings.dispatch + timings.readback - before;
    let error = pass.comparison.finish();
    let table = Table { error: error.clone(), seconds, ..pass.table };
    let axes = pass.preview.axes(plan);
    let preview = Table { axes, values: Values::F32(pass.preview.values), ..table.clone() };
    Ok((table, preview))
}

impl Evaluator {
    /// Opens another evaluator like this, after its device was lost.
    pub(super) fn reopen(&self) -> Result<Self> {
        Ok(match self {
            Self::Device(device) => Self::Device(Box::new(device.reopen()?)),
            Self::Cpu => Self::Cpu,
        })
    }

    fn stream(
        &self,
        plan: &TablePlan,
        tiles: &[Range<usize>],
        timings: &mut Timings,
        sink: &mut dyn FnMut(usize, &[f32]) -> Result<()>,
    ) -> Result<()> {
        match self {
            Self::Device(device) => device.stream(plan, tiles, timings, sink),
            Self::Cpu => cpu::stream(plan, tiles, sink),
        }
    }
}

/// The pass over a table's tiles: it checks, compares and previews each.
struct Pass<'a> {
    /// The table without its values.
    table: Table,
    comparison: Comparison<'a>,
    preview: Preview,
    /// The number of tiles that have passed.
    done: usize,
}

impl Pass<'_> {
    fn add(&mut self, texels: Range<usize>, values: &[f32]) -> Result<()> {
        self.table.check_sane_from(texels.start, values)?;
        self.comparison.add(texels.clone(), &|k| f64::from(values[k]), &|_| Ok(()))?;
        self.preview.add(texels, values);
        self.done += 1;
        Ok(())
    }
}

/// A part of a table that is small enough to draw: some samples of each axis, in even steps.
struct Preview {
    shape: Vec<usize>,
    chosen: Vec<Vec<usize>>,
    values: Vec<f32>,
}

impl Preview {
    /// The largest number of samples of the two axes that span a picture.
    const ACROSS: usize = 256;
    /// The largest number of samples of the other axes: seven have the first, the middle, and the thirds.
    const APART: usize = 7;

    fn new(plan: &TablePlan) -> Self {
        let shape = plan.shape();
        let chosen = shape.iter().enumerate().map(|(k, &n)| {
            let count = if k + 2 >= shape.len() { Self::ACROSS } else { Self::APART };
            let step = |i: usize| (i * (n - 1) + (count - 1) / 2) / (count - 1);
            if n <= count { (0..n).collect() } else { (0..count).map(step).collect() }
        });
        Self { chosen: chosen.collect(), shape, values: Vec::new() }
    }

    fn axes(&self, plan: &TablePlan) -> Vec<Axis> {
        plan.axes().iter().zip(&self.chosen).map(|(axis, chosen)| axis.thinned(chosen)).collect()
    }

    /// Adds the chosen samples of whole rows.
    fn add(&mut self, texels: Range<usize>, values: &[f32]) {
        let Some((&width, slow)) = self.shape.split_last() else { return };
        let Some((across, chosen)) = self.chosen.split_last() else { return };
        let channels = values.len() / texels.len().max(1);
        for (row, values) in (texels.start / width..).zip(values.chunks_exact(width * channels)) {
            let index = indices(slow, row);
            if index.iter().zip(chosen).all(|(k, chosen)| chosen.binary_search(k).is_ok()) {
                for &k in across {
                    self.values.extend_from_slice(&values[k * channels..][..channels]);
                }
            }
        }
    }
}
