//! Evaluates a table without an embedder: the same recording, in short submissions, read back while the device computes
//! the next tile.

use crate::backend::gpu::baker::{Baker, EVALUATIONS_PER_DISPATCH, ResultLayout};
use crate::backend::gpu::device::Device;
use crate::backend::gpu::dispatch::Dispatches;
use crate::base::error::{Error, Result};
use crate::base::precision::Precision;
use crate::base::timings::Stopwatch;
use crate::base::timings::Timings;
use crate::plan::TablePlan;
use crate::table::Values;
use std::ops::Range;
use std::sync::mpsc::{self, Receiver};

/// The number of evaluations of one submission, after which a bake can be stopped: as many as one dispatch may make.
const EVALUATIONS_PER_SUBMISSION: u64 = EVALUATIONS_PER_DISPATCH as u64;

/// The buffers in which a tile is computed and from which the host reads it. Two of them take turns: the first touch of a
/// buffer costs more than to compute what it holds.
struct TileBuffers {
    output: wgpu::Buffer,
    staging: wgpu::Buffer,
    /// The tile on its way, if there is one, and the share of the table's work that nobody waited for yet.
    flight: Option<(Flight, f64)>,
}

/// A result on its way to the host.
pub(crate) struct Flight {
    last: wgpu::SubmissionIndex,
    mapped: Receiver<Result<(), wgpu::BufferAsyncError>>,
    bytes: u64,
}

impl Device {
    /// Evaluates the values of a table, row-major, channels last. It calls `tick` as it goes on, with a share of the table;
    /// an error from `tick` stops it.
    pub(crate) fn evaluate(
        &self,
        table: &TablePlan,
        precision: Precision,
        timings: &mut Timings,
        tick: &(impl Fn(f64) -> Result<()> + Sync),
    ) -> Result<Values> {
        let layout = ResultLayout::new(table, precision);
        let mut values = layout.values(layout.units);
        self.guarded(|| self.tiles(table, &layout, None, timings, tick, &mut values, &mut |_, _| Ok(())))?;
        Ok(values)
    }

    /// Evaluates a table of values tile by tile, in f32, and hands each of `tiles` to `sink` in order, while the device
    /// computes the next. A tile is a range of rows: all azimuths of an α and a pair.
    #[cfg(feature = "batch")]
    pub(crate) fn stream(
        &self,
        table: &TablePlan,
        tiles: &[Range<usize>],
        timings: &mut Timings,
        sink: &mut dyn FnMut(usize, &[f32]) -> Result<()>,
    ) -> Result<()> {
        let layout = ResultLayout::new(table, Precision::F32);
        let mut values = layout.values(0);
        let mut hand_over = |k: usize, values: &mut Values| {
            sink(k, &values.to_f32())?;
            values.clear();
            Ok(())
        };
        self.guarded(|| {
            self.tiles(table, &layout, Some(tiles), timings, &|_| Ok(()), &mut values, &mut hand_over)
        })
    }

    /// Appends the values of tile after tile to `values`, and calls `sink` after each, which may take them.
    #[allow(clippy::too_many_arguments)]
    fn tiles(
        &self,
        table: &TablePlan,
        layout: &ResultLayout,
        tiles: Option<&[Range<usize>]>,
        timings: &mut Timings,
        tick: &impl Fn(f64) -> Result<()>,
        values: &mut Values,
        sink: &mut dyn FnMut(usize, &mut Values) -> Result<()>,
    ) -> Result<()> {
        let start = Stopwatch::start();
        let composed = self.baker.compose_seconds();
        let dispatches = self.baker.dispatches(table, layout.precision, || self.known_turns())?;
        let tiles =
            tiles.map_or_else(|| layout.tiles(&dispatches, &self.baker.device.limits()), <[_]>::to_vec);
        let largest = layout.bytes(tiles.iter().map(Range::len).max().unwrap_or(0));
        let mut slots: Vec<_> = tiles.iter().take(2).map(|_| self.slot(largest)).collect();
        timings.compile += start.seconds();

        for k in 0..=tiles.len() {
            if let Some(units) = tiles.get(k) {
                let share = units.len() as f64 / layout.units as f64;
                self.launch(&mut slots[k % 2], layout, &dispatches, units, share, timings, tick)?;
            }
            let landing = k.checked_sub(1).and_then(|last| Some((last, slots.get_mut(last % 2)?)));
            if let Some((last, TileBuffers { staging, flight, .. })) = landing
                && let Some((flight, share)) = flight.take()
            {
                let start = Stopwatch::start();
                self.arrive(&flight)?;
                timings.dispatch += start.seconds();
                let start = Stopwatch::start();
                self.land(staging, flight, &mut |bytes| layout.append(bytes, values))?;
                timings.readback += start.seconds();
                sink(last, values)?;
                tick(share)?;
            }
        }
        let composing = self.baker.compose_seconds() - composed;
        timings.compose += composing;
        timings.compile -= composing;
        Ok(())
    }

    /// Starts a tile; waits for all its submissions but the last.
    #[allow(clippy::too_many_arguments)]
    fn launch(
        &self,
        slot: &mut TileBuffers,
        layout: &ResultLayout,
        dispatches: &[Dispatches],
        units: &Range<usize>,
        share: f64,
        timings: &mut Timings,
        tick: &impl Fn(f64) -> Result<()>,
    ) -> Result<()> {
        let Baker { device, queue, .. } = &self.baker;
        let start = Stopwatch::start();
        let steps = self.baker.fill(&slot.output, dispatches, units.clone())?;
        timings.compile += start.seconds();
        let start = Stopwatch::start();
        let all: u64 = steps.iter().map(|step| step.evaluations).sum();
        let part = |evaluations: u64| share * evaluations as f64 / all.max(1) as f64;
        let mut encoder = device.create_command_encoder(&Default::default());
        let (mut recorded, mut left) = (0, share);
        for step in &steps {
            if recorded > 0 && recorded + step.evaluations > EVALUATIONS_PER_SUBMISSION {
                queue.submit([encoder.finish()]);
                self.wait()?;
                tick(part(recorded))?;
                left -= part(recorded);
                recorded = 0;
                encoder = device.create_command_encoder(&Default::default());
            }
            step.encode(&mut encoder);
            recorded += step.evaluations;
        }
        let bytes = layout.bytes(units.len()) as u64;
        slot.flight = Some((self.send(encoder, &slot.output, &slot.staging, bytes), left));
        timings.dispatch += start.seconds();
        Ok(())
    }

    /// Submits the recorded steps, and after them the copy of the result to the buffer that the host reads.
    pub(crate) fn send(
        &self,
        mut encoder: wgpu::CommandEncoder,
        output: &wgpu::Buffer,
        staging: &wgpu::Buffer,
        bytes: u64,
    ) -> Flight {
        encoder.copy_buffer_to_buffer(output, 0, staging, 0, bytes);
        let last = self.baker.queue.submit([encoder.finish()]);
        let (sender, mapped) = mpsc::channel();
        staging.map_async(wgpu::MapMode::Read, ..bytes, move |result| {
            // Without a receiver nobody wants the tile any more.
            let _ = sender.send(result);
        });
        Flight { last, mapped, bytes }
    }

    /// Waits until a result has arrived.
    pub(crate) fn arrive(&self, flight: &Flight) -> Result<()> {
        self.poll(wgpu::PollType::Wait { submission_index: Some(flight.last.clone()), timeout: None })
    }

    /// Hands the bytes of a result that has arrived to `take`.
    pub(crate) fn land(
        &self,
        staging: &wgpu::Buffer,
        flight: Flight,
        take: &mut dyn FnMut(&[u8]),
    ) -> Result<()> {
        let Flight { mapped, bytes, .. } = flight;
        let lost = |why: String| Error::Device(format!("{}: cannot read results back: {why}", self.name()));
        mapped.recv().map_err(|e| lost(e.to_string()))?.map_err(|e| lost(e.to_string()))?;
        let view = staging.get_mapped_range(..bytes).map_err(|e| lost(e.to_string()))?;
        take(&view);
        drop(view);
        staging.unmap();
        Ok(())
    }

    /// Waits for all submissions.
    pub(crate) fn wait(&self) -> Result<()> {
        self.poll(wgpu::PollType::wait_indefinitely())
    }

    fn poll(&self, condition: wgpu::PollType) -> Result<()> {
        let polled = self.baker.device.poll(condition);
        self.fault()?;
        polled.map_err(|e| Error::Device(format!("{}: {e}", self.name())))?;
        Ok(())
    }

    fn slot(&self, bytes: usize) -> TileBuffers {
        TileBuffers { output: self.baker.output(bytes), staging: self.staging(bytes as u64), flight: None }
    }

    pub(crate) fn staging(&self, bytes: u64) -> wgpu::Buffer {
        self.baker.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: bytes,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        })
    }
}
