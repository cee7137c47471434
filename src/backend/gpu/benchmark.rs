//! Measures the seconds that the device takes, by submitting and waiting: timestamps lie on some software drivers.

use crate::backend::gpu::baker::{Baker, DispatchStep, EVALUATIONS_PER_DISPATCH, ResultLayout, Tile};
use crate::backend::gpu::device::Device;
use crate::base::error::{Error, Result};
use crate::base::precision::Precision;
use crate::base::timings::Stopwatch;
use crate::plan::TablePlan;
use crate::shader::Kernel;
use crate::table::Values;

/// A table that is ready to be baked again and again: pipelines are compiled and buffers touched.
pub(crate) struct WarmTable<'a> {
    device: &'a Device,
    layout: ResultLayout,
    tiles: Vec<Tile>,
    /// The seconds that the host spends on nodes, half-angle terms and upload before the device starts.
    pub prepare: f64,
}

/// The largest rates that the device reaches.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rates {
    /// The bytes written in a second.
    pub bytes: f64,
    /// The multiplications and additions in a second.
    pub operations: f64,
}

impl WarmTable<'_> {
    /// Bakes once, and returns the seconds from the first submission to the end of the last.
    pub fn run(&self) -> Result<f64> {
        let steps: Vec<_> = self.tiles.iter().flat_map(|tile| &tile.steps).collect();
        let start = Stopwatch::start();
        self.device.submit_all(&steps)?;
        Ok(start.seconds())
    }

    /// The values of the last run.
    pub fn values(&self) -> Result<Values> {
        let mut values = self.layout.values(self.layout.units);
        for tile in &self.tiles {
            self.device.read_back(tile, &self.layout, &mut values)?;
        }
        Ok(values)
    }
}

impl Device {
    /// Makes a table ready, and bakes it once.
    pub(crate) fn warm(&self, table: &TablePlan, precision: Precision) -> Result<WarmTable<'_>> {
        let prepare = || -> Result<(ResultLayout, Vec<Tile>)> {
            let layout = ResultLayout::new(table, precision);
            let dispatches = self.baker.dispatches(table, precision, || self.known_turns())?;
            let tiles = layout.tiles(&dispatches, &self.baker.device.limits()).into_iter();
            let tiles =
                tiles.map(|units| self.baker.tile(&layout, &dispatches, units)).collect::<Result<_>>()?;
            Ok((layout, tiles))
        };
        drop(prepare()?); // compiles
        let start = Stopwatch::start();
        let (layout, tiles) = prepare()?;
        let warm = WarmTable { device: self, layout, tiles, prepare: start.seconds() };
        warm.run()?;
        Ok(warm)
    }

    /// Reads a tile that was computed, and appends its values.
    fn read_back(&self, tile: &Tile, layout: &ResultLayout, values: &mut Values) -> Result<()> {
        let staging = self.staging(tile.buffer.size());
        let encoder = self.baker.device.create_command_encoder(&Default::default());
        let flight = self.send(encoder, &tile.buffer, &staging, tile.buffer.size());
        self.arrive(&flight)?;
        self.land(&staging, flight, &mut |bytes| layout.append(bytes, values))
    }

    /// Submits the steps in as few submissions as the limit on a dispatch allows.
    fn submit_all(&self, steps: &[&DispatchStep]) -> Result<()> {
        let Baker { device, queue, .. } = &self.baker;
        let mut rest = steps;
        while !rest.is_empty() {
            let mut evaluations = 0;
            let fits = rest.iter().take_while(|step| {
                evaluations += step.evaluations;
                evaluations <= EVALUATIONS_PER_DISPATCH as u64
            });
            let (now, later) = rest.split_at(fits.count().max(1));
            let mut encoder = device.create_command_encoder(&Default::default());
            now.iter().for_each(|step| step.encode(&mut encoder));
            queue.submit([encoder.finish()]);
            self.wait()?;
            rest = later;
        }
        Ok(())
    }

    /// Measures the rates by kernels that only store, or only compute.
    pub(crate) fn rates(&self) -> Result<Rates> {
        // 32 MiB, as four vectors of 16 bytes an invocation.
        const FILL_GROUPS: u32 = 2048;
        const FILL_BYTES: usize = FILL_GROUPS as usize * 256 * 4 * 16;
        // 64 invocations of 256 turns of eight chains of four, each a product and a sum.
        const GROUPS: u32 = 512;
        const OPERATIONS: f64 = GROUPS as f64 * 64.0 * 256.0 * 8.0 * 4.0 * 2.0;
        Ok(Rates {
            bytes: FILL_BYTES as f64 / self.probe(Kernel::Fill, FILL_BYTES, FILL_GROUPS)?,
            operations: OPERATIONS / self.probe(Kernel::MultiplyAdd, GROUPS as usize * 64 * 16, GROUPS)?,
        })
    }

    /// The seconds of the shortest of several runs.
    fn probe(&self, kernel: Kernel, bytes: usize, groups: u32) -> Result<f64> {
        const RUNS: usize = 8;
        let Baker { device, queue, .. } = &self.baker;
        let pipeline = self.baker.pipeline(kernel, None, 0, Precision::F32)?;
        let buffer = self.baker.output(bytes);
        let bind_group = self.baker.bind(&pipeline, [buffer.as_entire_binding()]);
        let mut least = f64::INFINITY;
        for run in 0..=RUNS {
            let start = Stopwatch::start();
            let mut encoder = device.create_command_encoder(&Default::default());
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &bind_group, &[]);
            pass.dispatch_workgroups(groups, 1, 1);
            drop(pass);
            queue.submit([encoder.finish()]);
            self.wait()?;
            // The first run touches the buffer.
            if run > 0 {
                least = least.min(start.seconds());
            }
        }
        if least > 0.0 {
            Ok(least)
        } else {
            Err(Error::Device(format!("{}: its clock stands still", self.name())))
        }
    }
}
