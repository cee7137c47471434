//! Records the baking of a table on a device that the caller owns.

use crate::backend::gpu::dispatch::{Dispatches, KernelJob, Stage, TILE_SUMS, Upload, ValueRows};
use crate::backend::gpu::loop_limit;
use crate::backend::gpu::loop_limit::SAFE_TURNS;
use crate::base::error::{Error, Result};
use crate::base::precision::Precision;
use crate::base::timings::Stopwatch;
use crate::integrate::listed_rule::ListedRule;
use crate::integrate::rule_set::RuleSet;
use crate::integrate::slope_rule::TILE_ALPHAS;
use crate::model::Model;
use crate::plan::TablePlan;
use crate::shader::{Kernel, QUAD_FACTORS, VALUE_WINDOW, compose, validate};
use crate::table::Values;
use crate::table::axis::Variable;
use std::borrow::Cow;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// Bakes tables on a device.
///
/// Pipelines are compiled when first needed and kept.
pub struct Baker {
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    pipelines: Mutex<HashMap<PipelineKey, wgpu::ComputePipeline>>,
    composing: Mutex<f64>,
}

type PipelineKey = (Kernel, Option<&'static str>, usize, Precision);

/// A table on the device: `height` rows of `width` texels of `channels` floats.
#[derive(Debug, Clone)]
pub struct Recorded {
    /// The buffer, with usages `STORAGE | COPY_SRC`.
    pub buffer: wgpu::Buffer,
    /// The number of texels along the table's last axis.
    pub width: usize,
    /// The number of texels from one row to the next: rows of values are padded to whole quads.
    pub row: usize,
    /// The product of the other axes.
    pub height: usize,
    /// The number of channels of a texel.
    pub channels: usize,
}

/// A table whose buffers and pipelines exist, ready to record.
pub struct Prepared {
    /// The buffer that will hold it.
    pub recorded: Recorded,
    steps: Vec<DispatchStep>,
}

/// One dispatch, ready to encode.
pub(crate) struct DispatchStep {
    pub pipeline: wgpu::ComputePipeline,
    pub bind_group: wgpu::BindGroup,
    pub workgroups: [u32; 2],
    /// The number of evaluations, by which progress is weighted.
    pub evaluations: u64,
}

/// A part of a table that is computed in one buffer.
pub(crate) struct Tile {
    pub buffer: wgpu::Buffer,
    pub steps: Vec<DispatchStep>,
}

/// The shape of a table's result in units; a tile is a range of units.
#[derive(Clone, Copy)]
pub(crate) struct ResultLayout {
    /// The number of units: rows of azimuths in a table of values, rows of α in a table of integrals.
    pub units: usize,
    /// The number of texels of a unit.
    pub texels: usize,
    /// The number of texels of a unit with its padding.
    pub padded: usize,
    pub channels: usize,
    /// The precision of the result: values are f32 however they are computed.
    pub precision: Precision,
}

/// The largest number of evaluations of a dispatch: 8 million stay below 100 ms on two cores of software
/// Vulkan, at 100 million a second.
pub(crate) const EVALUATIONS_PER_DISPATCH: usize = 1 << 23;
/// The largest number of invocations of a dispatch: 64 a workgroup, and at most 65,535 workgroups.
const INVOCATIONS_PER_DISPATCH: usize = 1 << 21;
/// The bytes of a tile's result, and of its inner integrals.
const TILE_BYTES: usize = 1 << 25;
const WORKGROUP: usize = 64;
/// The number of points of integrals that are uploaded together: 16 MiB in f32.
const POINTS_PER_DISPATCH: usize = 1 << 18;
/// The largest number of rows of a dispatch of values: 32 a workgroup, and at most 65,535 workgroups.
const ROWS_PER_DISPATCH: usize = 1 << 20;
const ROWS_PER_WORKGROUP: usize = 4 * 8;

impl ResultLayout {
    pub fn new(table: &TablePlan, precision: Precision) -> Self {
        let channels = table.channels().len();
        if !is_value(table) {
            let units = table.axis(Variable::Roughness).map_or(1, |axis| axis.len());
            let texels = table.texels() / units;
            return Self { units, texels, padded: texels, channels, precision };
        }
        let texels = table.axes().last().map_or(1, |axis| axis.len());
        Self {
            units: table.texels() / texels,
            texels,
            padded: texels.next_multiple_of(4),
            channels,
            precision: Precision::F32,
        }
    }

    /// The bytes of a number of units.
    pub fn bytes(&self, units: usize) -> usize {
        units * self.padded * self.channels * self.precision.bytes()
    }

    /// An empty list of values in the result's precision, with room for a number of units.
    pub fn values(&self, units: usize) -> Values {
        let room = units * self.texels * self.channels;
        match self.precision {
            Precision::F32 => Values::F32(Vec::with_capacity(room)),
            Precision::F64 => Values::F64(Vec::with_capacity(room)),
        }
    }

    /// Appends the values in a device's bytes, without their padding.
    pub fn append(&self, bytes: &[u8], values: &mut Values) {
        let number = self.channels * self.precision.bytes();
        for row in bytes.chunks_exact(self.padded * number) {
            let row = &row[..self.texels * number];
            // Number by number: bytes need not be aligned.
            match values {
                Values::F32(values) => {
                    values.extend(row.as_chunks().0.iter().map(|&bytes| f32::from_le_bytes(bytes)));
                }
                Values::F64(values) => {
                    values.extend(row.as_chunks().0.iter().map(|&bytes| f64::from_le_bytes(bytes)));
                }
            }
        }
    }

    /// The tiles of a table, as ranges of units, by size alone: results must not depend on speed.
    pub fn tiles(&self, dispatches: &[Dispatches], limits: &wgpu::Limits) -> Vec<Range<usize>> {
        let raw_bytes = |lobe: &Dispatches| lobe.raw_bytes_per_unit().max(lobe.uploaded_bytes_per_unit());
        let raw = dispatches.iter().map(raw_bytes).max().unwrap_or(0);
        // A tile has whole groups of the α that an invocation takes together.
        let most = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        let bytes = TILE_BYTES.min(usize::try_from(most).unwrap_or(TILE_BYTES));
        let per_tile = (bytes / raw.max(self.bytes(1)) / TILE_ALPHAS * TILE_ALPHAS).max(TILE_ALPHAS);
        (0..self.units).step_by(per_tile).map(|first| first..(first + per_tile).min(self.units)).collect()
    }
}

impl Baker {
    /// Makes a baker on the caller's device. wgpu's handles are shared, so it keeps cheap clones.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        Self {
            device: device.clone(),
            queue: queue.clone(),
            pipelines: Mutex::default(),
            composing: Mutex::default(),
        }
    }

    /// Records the baking of `table` into `encoder` and returns the buffer that will hold it. It does
    /// not submit, read back or block; the error is then the rule's alone, as nobody measures it.
    ///
    /// # Errors
    /// The errors of [`prepare`](Self::prepare).
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, table: &TablePlan) -> Result<Recorded> {
        let prepared = self.prepare(table)?;
        prepared.encode(encoder);
        Ok(prepared.recorded)
    }

    /// The most workgroups that the device dispatches along a dimension.
    pub(crate) fn max_workgroups(&self) -> usize {
        self.device.limits().max_compute_workgroups_per_dimension.max(1) as usize
    }

    /// Makes the buffers and pipelines of [`record`](Self::record) once, for callers that bake the same table again and
    /// again into the same buffer.
    ///
    /// # Errors
    /// When f32 cannot meet the table's tolerance, it does not fit one binding of the device, or it takes loops that not every
    /// driver runs.
    pub fn prepare(&self, table: &TablePlan) -> Result<Prepared> {
        self.scoped(|| self.prepare_unguarded(table))
    }

    fn prepare_unguarded(&self, table: &TablePlan) -> Result<Prepared> {
        if table.precision() == Precision::F64 {
            return Err(Error::input(format!(
                "table \"{}\": f32, in which a device records tables, cannot meet {:e}; allow more, or bake it by an Evaluator",
                table.name(),
                table.tolerance()
            )));
        }
        let layout = ResultLayout::new(table, Precision::F32);
        let dispatches = self.dispatches(table, Precision::F32, || Ok(SAFE_TURNS))?;
        let raw = dispatches.iter().map(Dispatches::raw_bytes_per_unit).max().unwrap_or(0) * layout.units;
        let bytes = layout.bytes(layout.units).max(raw);
        let limits = self.device.limits();
        let limit = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        if bytes as u64 > limit {
            return Err(Error::Device(format!(
                "table \"{}\" takes {bytes} bytes in one piece, but the device binds at most {limit}; take fewer samples",
                table.name()
            )));
        }
        let tile = self.tile(&layout, &dispatches, 0..layout.units)?;
        let width = table.axes().last().map_or(1, |axis| axis.len());
        let row = if is_value(table) { layout.padded } else { width };
        let recorded = Recorded {
            buffer: tile.buffer,
            width,
            row,
            height: table.texels() / width,
            channels: layout.channels,
        };
        Ok(Prepared { recorded, steps: tile.steps })
    }

    /// Uploads the rule set of every lobe of a table. `known_turns` returns the turns of loops that are known to run.
    pub(crate) fn dispatches(
        &self,
        table: &TablePlan,
        precision: Precision,
        known_turns: impl Fn() -> Result<u32>,
    ) -> Result<Vec<Dispatches>> {
        let dispatches = |(k, lobe)| {
            let rules = RuleSet::new(table, lobe);
            loop_limit::check(table, &rules, &known_turns)?;
            Dispatches::new(self, lobe, &rules, k > 0, precision)
        };
        table.lobes().iter().enumerate().map(dispatches).collect()
    }

    /// The steps of one tile, and the buffer that they fill.
    pub(crate) fn tile(
        &self,
        layout: &ResultLayout,
        dispatches: &[Dispatches],
        units: Range<usize>,
    ) -> Result<Tile> {
        let buffer = self.output(layout.bytes(units.len()));
        let steps = self.fill(&buffer, dispatches, units)?;
        Ok(Tile { buffer, steps })
    }

    /// The steps that fill a buffer with some units.
    pub(crate) fn fill(
        &self,
        buffer: &wgpu::Buffer,
        dispatches: &[Dispatches],
        units: Range<usize>,
    ) -> Result<Vec<DispatchStep>> {
        let mut steps = Vec::new();
        for lobe in dispatches {
            let Dispatches { inner, outer, .. } = lobe;
            if let (Some(rows), [quads]) = (&inner.rows, &inner.inputs[..]) {
                self.value_steps(inner, (rows, quads), &units, buffer, &mut steps)?;
                continue;
            }
            let rows = lobe.inner_units(&units);
            let order = lobe.order(&rows);
            let order =
                order.map(|order| self.init(bytemuck::cast_slice(&order), wgpu::BufferUsages::STORAGE));
            let order: Vec<_> = order.into_iter().collect();
            let range =
                rows.start / inner.units * inner.per_unit..rows.end.div_ceil(inner.units) * inner.per_unit;
            let job = KernelJob { base: count(rows.start * inner.per_unit)?, ..inner.job };
            let mut results = rows.len() * inner.per_unit;
            let raw = |results: usize| self.output(results * 2 * inner.precision.bytes());
            let mut output = if outer.is_empty() { buffer.clone() } else { raw(results) };
            let more_inputs = |range| match &inner.directions {
                Some(rule) => self.points_of(inner, rule, range),
                None => order.clone(),
            };
            self.steps(inner, job, range, &more_inputs, &output, &mut steps)?;
            for (k, sum) in outer.iter().enumerate() {
                let is_last = k + 1 == outer.len();
                let columns = results / sum.job.nodes as usize;
                // The last matrix of an interpolated table makes the rows of this tile alone.
                let rows = if is_last && lobe.sources.is_some() {
                    units.clone()
                } else {
                    0..sum.job.azimuths as usize
                };
                results = rows.len() * columns;
                let next = if is_last { buffer.clone() } else { raw(results) };
                let tiles = columns.div_ceil(TILE_SUMS);
                let range = rows.start / TILE_SUMS * tiles..rows.end.div_ceil(TILE_SUMS) * tiles;
                let job = KernelJob {
                    base: count(rows.start * columns)?,
                    columns: count(columns)?,
                    tiles: count(tiles)?,
                    ..sum.job
                };
                self.steps(sum, job, range, &|_| vec![output.clone()], &next, &mut steps)?;
                output = next;
            }
        }
        Ok(steps)
    }

    /// Adds the dispatches of a stage for some invocations, as many as the cost asks for, or as fit a buffer of points. Each
    /// dispatch reads its own `more_inputs`.
    fn steps(
        &self,
        stage: &Stage,
        job: KernelJob,
        range: Range<usize>,
        more_inputs: &dyn Fn(Range<usize>) -> Vec<wgpu::Buffer>,
        output: &wgpu::Buffer,
        steps: &mut Vec<DispatchStep>,
    ) -> Result<()> {
        let pipeline = self.pipeline(stage.kernel, stage.model, stage.channels, stage.precision)?;
        let per_step = match stage.directions {
            Some(_) => (POINTS_PER_DISPATCH / stage.cost).max(1),
            None => (EVALUATIONS_PER_DISPATCH / stage.cost).clamp(WORKGROUP, INVOCATIONS_PER_DISPATCH),
        };
        let per_step = per_step.min(self.max_workgroups() * WORKGROUP);
        for first in range.clone().step_by(per_step) {
            let end = (first + per_step).min(range.end);
            let job = KernelJob { first: count(first)?, end: count(end)?, ..job };
            let job = self.init(bytemuck::bytes_of(&job), wgpu::BufferUsages::UNIFORM);
            let inputs = more_inputs(first..end);
            let buffers = [&job, output].into_iter().chain(&stage.inputs).chain(&inputs);
            steps.push(DispatchStep {
                pipeline: pipeline.clone(),
                bind_group: self.bind(&pipeline, buffers.map(wgpu::Buffer::as_entire_binding)),
                workgroups: [count((end - first).div_ceil(WORKGROUP))?, 1],
                evaluations: ((end - first) * stage.cost) as u64,
            });
        }
        Ok(())
    }

    /// Uploads the points of some inner integrals whose directions the host finds.
    fn points_of(&self, stage: &Stage, rule: &ListedRule, range: Range<usize>) -> Vec<wgpu::Buffer> {
        let upload = Upload { baker: self, precision: stage.precision };
        upload.direction_sums(&rule.integrals(range)).into()
    }

    /// Adds the dispatches of a stage of values, by windows of rows and of quads.
    fn value_steps(
        &self,
        stage: &Stage,
        (rows, quads): (&ValueRows, &wgpu::Buffer),
        units: &Range<usize>,
        output: &wgpu::Buffer,
        steps: &mut Vec<DispatchStep>,
    ) -> Result<()> {
        const BYTES: u64 = (VALUE_WINDOW * QUAD_FACTORS * 16) as u64;
        let pipeline = &self.pipeline(stage.kernel, stage.model, stage.channels, stage.precision)?;
        let groups = rows.groups(units);
        let row_data = groups.concat();
        let rows = self.init(bytemuck::cast_slice(&row_data), wgpu::BufferUsages::STORAGE);
        let windows = stage.per_unit.div_ceil(VALUE_WINDOW);
        let most_rows = ROWS_PER_DISPATCH.min(self.max_workgroups() * ROWS_PER_WORKGROUP);
        let mut end = 0;
        for (phi_i, group) in groups.iter().enumerate() {
            let first = end;
            end += group.len();
            for window in 0..windows {
                let quad = window * VALUE_WINDOW;
                let columns = VALUE_WINDOW.min(stage.per_unit - quad);
                let offset = (phi_i * windows + window) as u64 * BYTES;
                let size = std::num::NonZeroU64::new(BYTES);
                let binding = wgpu::BufferBinding { buffer: quads, offset, size };
                let rows_per_step = (EVALUATIONS_PER_DISPATCH / (columns * stage.cost)).clamp(1, most_rows);
                for row in (first..end).step_by(rows_per_step) {
                    let rows_here = rows_per_step.min(end - row);
                    let job = KernelJob {
                        first: count(row)?,
                        end: count(row + rows_here)?,
                        columns: count(columns)?,
                        azimuths: count(stage.per_unit)?,
                        nodes: count(quad)?,
                        ..stage.job
                    };
                    let job = self.init(bytemuck::bytes_of(&job), wgpu::BufferUsages::UNIFORM);
                    let resources = [
                        job.as_entire_binding(),
                        output.as_entire_binding(),
                        rows.as_entire_binding(),
                        wgpu::BindingResource::Buffer(binding.clone()),
                    ];
                    steps.push(DispatchStep {
                        pipeline: pipeline.clone(),
                        bind_group: self.bind(pipeline, resources),
                        workgroups: [1, count(rows_here.div_ceil(ROWS_PER_WORKGROUP))?],
                        evaluations: (columns * rows_here * stage.cost) as u64,
                    });
                }
            }
        }
        Ok(())
    }

    /// The pipeline of a kernel, composed, validated and compiled once.
    pub(crate) fn pipeline(
        &self,
        kernel: Kernel,
        model: Option<&'static Model>,
        channels: usize,
        precision: Precision,
    ) -> Result<wgpu::ComputePipeline> {
        let key = (kernel, model.map(|m| m.name), channels, precision);
        let mut pipelines = self.pipelines.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(pipeline) = pipelines.get(&key) {
            return Ok(pipeline.clone());
        }
        let label = format!("gonio {kernel:?} {}", key.1.unwrap_or_default());
        let start = Stopwatch::start();
        let composed = validate(&compose(kernel, model, channels, precision), precision)?;
        *self.composing.lock().unwrap_or_else(PoisonError::into_inner) += start.seconds();
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(&label),
            source: wgpu::ShaderSource::Naga(Cow::Owned(composed)),
        });
        let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(&label),
            layout: None,
            module: &module,
            entry_point: None,
            compilation_options: Default::default(),
            cache: None,
        });
        pipelines.insert(key, pipeline.clone());
        Ok(pipeline)
    }

    /// Makes the only bind group of a kernel, its resources in the order of their bindings.
    pub(crate) fn bind<'a>(
        &self,
        pipeline: &wgpu::ComputePipeline,
        resources: impl IntoIterator<Item = wgpu::BindingResource<'a>>,
    ) -> wgpu::BindGroup {
        let entry = |(binding, resource)| wgpu::BindGroupEntry { binding, resource };
        let entries: Vec<_> = (0..).zip(resources).map(entry).collect();
        let layout = &pipeline.get_bind_group_layout(0);
        self.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
    }

    /// The seconds spent so far on composing and validating shaders.
    pub(crate) fn compose_seconds(&self) -> f64 {
        *self.composing.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Makes a buffer with the given bytes. It is not mapped, as wgpu panics when it maps on a device that is lost.
    pub(crate) fn init(&self, contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: contents.len() as u64,
            usage: usage | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        self.queue.write_buffer(&buffer, 0, contents);
        buffer
    }

    /// Makes an input buffer of kernels, to be written later.
    pub(crate) fn input(&self, bytes: usize) -> wgpu::Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: bytes as u64,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    }

    /// Makes a buffer for results. wgpu clears it when it is first used; kernels write all of it.
    pub(crate) fn output(&self, bytes: usize) -> wgpu::Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: bytes as u64,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        })
    }
}

fn is_value(table: &TablePlan) -> bool {
    table.quantity().is_value()
}

/// Converts a count to u32, as the device takes it.
pub(crate) fn count(n: usize) -> Result<u32> {
    u32::try_from(n)
        .map_err(|_| Error::Device(format!("{n} is more than a device counts to; take fewer samples")))
}

impl Prepared {
    /// Records the baking. It does not submit or block.
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder) {
        self.steps.iter().for_each(|step| step.encode(encoder));
    }
}

impl DispatchStep {
    pub(crate) fn encode(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bind_group, &[]);
        pass.dispatch_workgroups(self.workgroups[0], self.workgroups[1], 1);
    }
}
