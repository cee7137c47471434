//! The headless bake: the same recording, one submission a dispatch, read back.

use super::baker::{Baker, Layout, Step, Tile};
use super::device::Device;
use crate::bake::Stages;
use crate::error::{Error, Result};
use crate::plan::{Precision, TablePlan};
use crate::table::Values;
use std::sync::mpsc;
use std::time::Instant;

impl Device {
    /// The values of a table, row-major, channels last. `tick` is called as work is done, with its
    /// share of the table, and stops it by an error.
    pub(crate) fn evaluate(
        &self,
        table: &TablePlan,
        precision: Precision,
        times: &mut Stages,
        tick: &(impl Fn(f64) -> Result<()> + Sync),
    ) -> Result<Values> {
        let start = Instant::now();
        let composed = self.baker.compose_seconds();
        let layout = Layout::new(table, precision);
        let stages = self.baker.stages(table, precision)?;
        let tiles = layout.tiles(&stages);
        let mut bytes = Vec::with_capacity(layout.bytes(layout.units));
        times.compile += start.elapsed().as_secs_f64();
        for units in &tiles {
            let start = Instant::now();
            let tile = self.baker.tile(&layout, &stages, units.clone())?;
            times.compile += start.elapsed().as_secs_f64();
            let start = Instant::now();
            self.run(&tile, &|share| tick(share / tiles.len() as f64))?;
            times.dispatch += start.elapsed().as_secs_f64();
            let start = Instant::now();
            self.read_back(&tile, &layout, &mut bytes)?;
            times.readback += start.elapsed().as_secs_f64();
        }
        let composing = self.baker.compose_seconds() - composed;
        times.compose += composing;
        times.compile -= composing;
        Ok(layout.values(&bytes))
    }

    fn run(&self, tile: &Tile, tick: &impl Fn(f64) -> Result<()>) -> Result<()> {
        let all: u64 = tile.steps.iter().map(|step| step.evaluations).sum();
        for step in &tile.steps {
            self.submit(step)?;
            tick(step.evaluations as f64 / all.max(1) as f64)?;
        }
        Ok(())
    }

    fn submit(&self, step: &Step) -> Result<()> {
        let Baker { device, queue, .. } = &self.baker;
        let mut encoder = device.create_command_encoder(&Default::default());
        step.encode(&mut encoder);
        queue.submit([encoder.finish()]);
        self.wait()
    }

    pub(super) fn wait(&self) -> Result<()> {
        let polled = self.baker.device.poll(wgpu::PollType::wait_indefinitely());
        self.fault()?;
        polled.map_err(|e| Error::Device(format!("{}: {e}", self.name())))?;
        Ok(())
    }

    /// Appends a tile's values as bytes, without their padding.
    pub(super) fn read_back(&self, tile: &Tile, layout: &Layout, bytes: &mut Vec<u8>) -> Result<()> {
        let Baker { device, queue, .. } = &self.baker;
        let staging = device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: tile.buffer.size(),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(&tile.buffer, 0, &staging, 0, tile.buffer.size());
        queue.submit([encoder.finish()]);
        let (sender, receiver) = mpsc::channel();
        staging.map_async(wgpu::MapMode::Read, .., move |result| {
            // The receiver lives to the end of this function; nobody else could miss the message.
            let _ = sender.send(result);
        });
        self.wait()?;
        let lost = |why: String| Error::Device(format!("{}: cannot read results back: {why}", self.name()));
        receiver.recv().map_err(|e| lost(e.to_string()))?.map_err(|e| lost(e.to_string()))?;
        let view = staging.get_mapped_range(..).map_err(|e| lost(e.to_string()))?;
        let number = layout.channels * layout.precision.bytes();
        for row in view.chunks_exact(layout.padded * number) {
            bytes.extend_from_slice(&row[..layout.texels * number]);
        }
        Ok(())
    }
}
