//! Bakes a table larger than memory: tile by tile, each kept on disk as soon as it is done.

use crate::backend::cpu;
use crate::bake::{Evaluator, Observer};
use crate::base::error::{Error, Result};
use crate::base::precision::Precision;
use crate::base::timings::Timings;
use crate::batch::Options;
use crate::check::Comparison;
use crate::io;
use crate::io::Tiles;
use crate::plan::TablePlan;
use crate::shader::{Kernel, compose};
use crate::table::axis::Axis;
use crate::table::{Table, Values, indices};
use std::ops::Range;

/// Which tables are baked and written piece by piece, in bounded memory. The files are the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Streaming {
    /// Tables of values in f32 with more values than this are streamed.
    pub above: usize,
    /// Bytes of a tile; at least one row of the last axis.
    pub tile: usize,
}

impl Default for Streaming {
    fn default() -> Self {
        Self { above: 1 << 25, tile: 1 << 25 }
    }
}

/// How far a streamed bake was when it began.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Progress {
    /// Tiles of all streamed tables.
    pub all: usize,
    /// Those that an earlier bake, cut off, had finished.
    pub found: usize,
}

impl Streaming {
    /// Whether it takes this table.
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

/// A name for everything that decides a tile's bytes. With any difference a bake starts over.
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

/// Bakes a table into `tiles` and measures its error. Returns it without its values, and a part of it to
/// look at. Tiles that are there already are checked like new ones, but not computed.
///
/// `spare` takes the place of a device that is lost; nothing takes the place of the spare one.
#[allow(clippy::too_many_arguments)]
pub(super) fn bake(
    evaluator: &Evaluator,
    spare: &mut Option<Evaluator>,
    plan: &TablePlan,
    tiles: &Tiles,
    options: &Options,
    progress: &mut Progress,
    stages: &mut Timings,
    observer: &dyn Observer,
) -> Result<(Table, Table)> {
    observer.begin(&format!("baking {}", plan.name()));
    let before = stages.dispatch + stages.readback;
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
            pass.take(texels(first), &values)?;
            observer.advance(share(first))?;
            continue;
        }
        let end = (first + 1..ranges.len()).find(|&k| tiles.has(k)).unwrap_or(ranges.len());
        let mut keep = |k: usize, values: &[f32]| {
            tiles.store(first + k, values)?;
            pass.take(texels(first + k), values)?;
            observer.advance(share(first + k))
        };
        match spare.as_ref().unwrap_or(evaluator).stream(plan, &ranges[first..end], stages, &mut keep) {
            Err(Error::Device(_)) if spare.is_none() => *spare = Some(evaluator.reopen()?),
            result => result?,
        }
    }
    let seconds = stages.dispatch + stages.readback - before;
    let error = pass.comparison.finish();
    let table = Table { error: error.clone(), seconds, ..pass.table };
    let axes = pass.preview.axes(plan);
    let preview = Table { axes, values: Values::F32(pass.preview.values), ..table.clone() };
    Ok((table, preview))
}

impl Evaluator {
    /// Another one like this, after its device was lost.
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
        stages: &mut Timings,
        sink: &mut dyn FnMut(usize, &[f32]) -> Result<()>,
    ) -> Result<()> {
        match self {
            Self::Device(device) => device.stream(plan, tiles, stages, sink),
            Self::Cpu => cpu::stream(plan, tiles, sink),
        }
    }
}

/// What looks at every tile as it passes.
struct Pass<'a> {
    /// Without values.
    table: Table,
    comparison: Comparison<'a>,
    preview: Preview,
    /// Tiles that have passed.
    done: usize,
}

impl Pass<'_> {
    fn take(&mut self, texels: Range<usize>, values: &[f32]) -> Result<()> {
        self.table.check_sane_from(texels.start, values)?;
        self.comparison.add(texels.clone(), &|k| f64::from(values[k]), &|_| Ok(()))?;
        self.preview.take(texels, values);
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
    /// Samples of the axes that span a picture, and of those that tell pictures apart: seven have the
    /// first, the middle, and the thirds.
    const ACROSS: usize = 256;
    const APART: usize = 7;

    fn new(plan: &TablePlan) -> Self {
        let shape = plan.shape();
        let chosen = shape.iter().enumerate().map(|(k, &n)| {
            let most = if k + 2 >= shape.len() { Self::ACROSS } else { Self::APART };
            let step = |i: usize| (i * (n - 1) + (most - 1) / 2) / (most - 1);
            if n <= most { (0..n).collect() } else { (0..most).map(step).collect() }
        });
        Self { chosen: chosen.collect(), shape, values: Vec::new() }
    }

    fn axes(&self, plan: &TablePlan) -> Vec<Axis> {
        plan.axes().iter().zip(&self.chosen).map(|(axis, chosen)| axis.thinned(chosen)).collect()
    }

    /// Takes what it has chosen of whole rows.
    fn take(&mut self, texels: Range<usize>, values: &[f32]) {
        let Some((&width, slow)) = self.shape.split_last() else { return };
        let Some((across, chosen)) = self.chosen.split_last() else { return };
        let channels = values.len() / texels.len().max(1);
        for (row, values) in (texels.start / width..).zip(values.chunks_exact(width * channels)) {
            let at = indices(slow, row);
            if at.iter().zip(chosen).all(|(k, chosen)| chosen.binary_search(k).is_ok()) {
                for &k in across {
                    self.values.extend_from_slice(&values[k * channels..][..channels]);
                }
            }
        }
    }
}
