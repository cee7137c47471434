//! The headless bake: the same recording, in short submissions, read back while the next tile is
//! computed.

use super::baker::{Baker, Layout};
use super::device::Device;
use super::stage::Stages as Work;
use crate::bake::Stages;
use crate::error::{Error, Result};
use crate::plan::TablePlan;
use std::ops::Range;
use std::sync::mpsc::{self, Receiver};
use std::time::Instant;

/// What the device does in one submission, after which a bake can be stopped: as much as one dispatch may.
const EVALUATIONS_PER_SUBMISSION: u64 = 1 << 23;

/// Where a tile is computed and where the host reads it. Two of them take turns: the first touch of a
/// buffer costs more than to compute what it holds.
struct Slot {
    output: wgpu::Buffer,
    staging: wgpu::Buffer,
    /// The tile on its way, if there is one.
    flight: Option<Flight>,
}

struct Flight {
    last: wgpu::SubmissionIndex,
    mapped: Receiver<Result<(), wgpu::BufferAsyncError>>,
    bytes: u64,
    /// The share of the table's work that nobody waited for yet.
    share: f64,
}

impl Device {
    /// The values of a table, row-major, channels last. `tick` is called as work is done, with its
    /// share of the table, and stops it by an error.
    pub(crate) fn evaluate(
        &self,
        table: &TablePlan,
        times: &mut Stages,
        tick: &(impl Fn(f64) -> Result<()> + Sync),
    ) -> Result<Vec<f32>> {
        let mut values = Vec::with_capacity(table.texels() * table.channels.len());
        self.tiles(table, None, times, tick, &mut |_, tile| {
            values.extend_from_slice(tile);
            Ok(())
        })?;
        Ok(values)
    }

    /// The values of some rows of a table of values at a time (a row is all azimuths of an α and a pair):
    /// `sink` gets each of `tiles` in order, while the device computes the next.
    pub(crate) fn stream(
        &self,
        table: &TablePlan,
        tiles: &[Range<usize>],
        times: &mut Stages,
        sink: &mut dyn FnMut(usize, &[f32]) -> Result<()>,
    ) -> Result<()> {
        self.tiles(table, Some(tiles), times, &|_| Ok(()), sink)
    }

    fn tiles(
        &self,
        table: &TablePlan,
        tiles: Option<&[Range<usize>]>,
        times: &mut Stages,
        tick: &impl Fn(f64) -> Result<()>,
        sink: &mut dyn FnMut(usize, &[f32]) -> Result<()>,
    ) -> Result<()> {
        let start = Instant::now();
        let composed = self.baker.compose_seconds();
        let layout = Layout::new(table);
        let stages = self.baker.stages(table)?;
        let tiles = tiles.map_or_else(|| layout.tiles(&stages), <[_]>::to_vec);
        let largest = layout.bytes(tiles.iter().map(Range::len).max().unwrap_or(0)) as u64;
        let mut slots: Vec<_> = tiles.iter().take(2).map(|_| self.slot(largest)).collect();
        times.compile += start.elapsed().as_secs_f64();

        let mut values = Vec::new();
        for k in 0..=tiles.len() {
            if let Some(units) = tiles.get(k) {
                let share = units.len() as f64 / layout.units as f64;
                self.launch(&mut slots[k % 2], &layout, &stages, units, share, times, tick)?;
            }
            let landing = k.checked_sub(1).and_then(|last| Some((last, slots.get_mut(last % 2)?)));
            if let Some((last, slot)) = landing {
                values.clear();
                let share = self.land(slot, &layout, times, &mut values)?;
                sink(last, &values)?;
                tick(share)?;
            }
        }
        let composing = self.baker.compose_seconds() - composed;
        times.compose += composing;
        times.compile -= composing;
        Ok(())
    }

    /// Starts a tile; waits for all its submissions but the last.
    #[allow(clippy::too_many_arguments)]
    fn launch(
        &self,
        slot: &mut Slot,
        layout: &Layout,
        stages: &[Work],
        units: &Range<usize>,
        share: f64,
        times: &mut Stages,
        tick: &impl Fn(f64) -> Result<()>,
    ) -> Result<()> {
        let Baker { device, queue, .. } = &self.baker;
        let start = Instant::now();
        let steps = self.baker.fill(&slot.output, stages, units.clone())?;
        times.compile += start.elapsed().as_secs_f64();
        let start = Instant::now();
        let all: u64 = steps.iter().map(|step| step.evaluations).sum();
        let part = |evaluations: u64| share * evaluations as f64 / all.max(1) as f64;
        let mut encoder = device.create_command_encoder(&Default::default());
        let (mut recorded, mut left) = (0, share);
        for step in &steps {
            if recorded > 0 && recorded + step.evaluations > EVALUATIONS_PER_SUBMISSION {
                queue.submit([encoder.finish()]);
                self.wait(wgpu::PollType::wait_indefinitely())?;
                tick(part(recorded))?;
                left -= part(recorded);
                recorded = 0;
                encoder = device.create_command_encoder(&Default::default());
            }
            step.encode(&mut encoder);
            recorded += step.evaluations;
        }
        let bytes = layout.bytes(units.len()) as u64;
        encoder.copy_buffer_to_buffer(&slot.output, 0, &slot.staging, 0, bytes);
        let last = queue.submit([encoder.finish()]);
        let (sender, mapped) = mpsc::channel();
        slot.staging.map_async(wgpu::MapMode::Read, ..bytes, move |result| {
            // Without a receiver nobody wants the tile any more.
            let _ = sender.send(result);
        });
        slot.flight = Some(Flight { last, mapped, bytes, share: left });
        times.dispatch += start.elapsed().as_secs_f64();
        Ok(())
    }

    /// Waits for a tile and appends its values, without their padding. Returns the share of the work that
    /// is done by that.
    fn land(
        &self,
        slot: &mut Slot,
        layout: &Layout,
        times: &mut Stages,
        values: &mut Vec<f32>,
    ) -> Result<f64> {
        let Some(Flight { last, mapped, bytes, share }) = slot.flight.take() else { return Ok(0.0) };
        let start = Instant::now();
        self.wait(wgpu::PollType::Wait { submission_index: Some(last), timeout: None })?;
        times.dispatch += start.elapsed().as_secs_f64();
        let start = Instant::now();
        let lost = |why: String| Error::Device(format!("{}: cannot read results back: {why}", self.name()));
        mapped.recv().map_err(|e| lost(e.to_string()))?.map_err(|e| lost(e.to_string()))?;
        let view = slot.staging.get_mapped_range(..bytes).map_err(|e| lost(e.to_string()))?;
        let (row, kept) = (layout.padded * layout.channels * 4, layout.texels * layout.channels * 4);
        for row in view.chunks_exact(row) {
            // Bytes of f32s, whatever their alignment.
            values.extend(row[..kept].chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])));
        }
        drop(view);
        slot.staging.unmap();
        times.readback += start.elapsed().as_secs_f64();
        Ok(share)
    }

    fn wait(&self, what: wgpu::PollType) -> Result<()> {
        let polled = self.baker.device.poll(what);
        self.fault()?;
        polled.map_err(|e| Error::Device(format!("{}: {e}", self.name())))?;
        Ok(())
    }

    fn slot(&self, bytes: u64) -> Slot {
        let staging = self.baker.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: bytes,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        Slot { output: self.baker.output(bytes as usize), staging, flight: None }
    }
}
