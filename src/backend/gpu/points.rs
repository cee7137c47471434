//! Values at a list of pairs of directions: chunk after chunk, the next one's factors made while the device
//! computes.

use crate::backend::gpu::baker::{Baker, Step, count};
use crate::backend::gpu::device::Device;
use crate::backend::gpu::dispatch::Job;
use crate::backend::gpu::readback::Flight;
use crate::backend::scaled_lobe::ScaledLobe;
use crate::base::angles::Angles;
use crate::base::error::Result;
use crate::base::half_angle::{Azimuth, Pair};
use crate::base::precision::Precision;
use crate::model::directions::{POINT, POINT_MUS, POINT_WEIGHT, Sample};
use crate::model::lobe::Lobe;
use crate::shader::Kernel;
use rayon::prelude::*;
use std::ops::Range;

/// Values of a chunk: some milliseconds of any device, and buffers that stay in a cache.
const CHUNK: usize = 1 << 17;
/// Settings of a chunk: what its factors cost is then little for each.
const SETTINGS: usize = 64;
const WORKGROUP: usize = 64;

/// The lobes' kernels, and the buffers that all chunks share: the first touch of a buffer costs more than
/// to compute what it holds.
pub(crate) struct Points<'a> {
    device: &'a Device,
    lobes: Vec<(wgpu::ComputePipeline, Job)>,
    channels: usize,
    factors: Vec<Factors>,
    slots: [Slot; 2],
}

/// `Point` of `shaders/kernel/point.wgsl`.
type Factors = [f32; POINT];

/// One of two that take turns.
struct Slot {
    points: wgpu::Buffer,
    output: wgpu::Buffer,
    staging: wgpu::Buffer,
    flight: Option<(Flight, Chunk)>,
}

/// Some settings at some points.
#[derive(Clone)]
struct Chunk {
    settings: Range<usize>,
    points: Range<usize>,
}

impl<'a> Points<'a> {
    pub fn new(device: &'a Device, lobes: &[Lobe]) -> Result<Self> {
        device.guarded(|| Self::open(device, lobes))
    }

    fn open(device: &'a Device, lobes: &[Lobe]) -> Result<Self> {
        let channels = lobes.first().map_or(0, |lobe| lobe.weights().len());
        let lobe = |(k, lobe): (usize, &Lobe)| {
            let kernel = if k == 0 { Kernel::Points } else { Kernel::AddPoints };
            let pipeline = device.baker.pipeline(kernel, Some(lobe.model()), channels, Precision::F32)?;
            Ok((pipeline, Job::new(lobe, 1.0)))
        };
        let bytes = CHUNK * 4 * channels;
        let slot = || Slot {
            points: device.baker.input(CHUNK * size_of::<Factors>()),
            output: device.baker.output(bytes),
            staging: device.staging(bytes as u64),
            flight: None,
        };
        let lobes = lobes.iter().enumerate().map(lobe).collect::<Result<_>>()?;
        Ok(Self { device, lobes, channels, factors: Vec::new(), slots: [slot(), slot()] })
    }

    /// Other weights for the same models.
    pub fn set(&mut self, lobes: &[Lobe]) {
        for ((_, job), lobe) in self.lobes.iter_mut().zip(lobes) {
            *job = Job::new(lobe, 1.0);
        }
    }

    /// Fills `values`, by setting, point and channel. A setting has an α and a factor for each lobe.
    pub fn evaluate(
        &mut self,
        settings: &[Vec<ScaledLobe>],
        angles: &[Angles],
        values: &mut [f32],
    ) -> Result<()> {
        self.device.guarded(|| self.run(settings, angles, values))
    }

    fn run(&mut self, settings: &[Vec<ScaledLobe>], angles: &[Angles], values: &mut [f32]) -> Result<()> {
        let per_chunk = CHUNK / settings.len().clamp(1, SETTINGS);
        let groups = ranges(settings.len(), SETTINGS);
        let chunks: Vec<_> = groups
            .flat_map(|settings| {
                ranges(angles.len(), per_chunk)
                    .map(move |points| Chunk { settings: settings.clone(), points })
            })
            .collect();
        for k in 0..=chunks.len() {
            if let Some(chunk) = chunks.get(k) {
                let factors = angles[chunk.points.clone()].par_iter().map(|angles| factors(angles.factors()));
                factors.collect_into_vec(&mut self.factors);
                self.launch(k % 2, chunk, &settings[chunk.settings.clone()])?;
            }
            if k > 0 {
                self.land((k - 1) % 2, angles.len(), values)?;
            }
        }
        Ok(())
    }

    /// Starts a chunk, whose factors are made.
    fn launch(&mut self, slot: usize, chunk: &Chunk, settings: &[Vec<ScaledLobe>]) -> Result<()> {
        let Self { device, lobes, channels, factors, slots } = self;
        let Baker { device: wgpu, queue, .. } = &device.baker;
        let slot = &mut slots[slot];
        queue.write_buffer(&slot.points, 0, bytemuck::cast_slice(factors));
        let mut encoder = wgpu.create_command_encoder(&Default::default());
        for (k, setting) in settings.iter().enumerate() {
            for ((pipeline, job), ScaledLobe { alpha, scale }) in lobes.iter().zip(setting) {
                let (end, base) = (count(factors.len())?, count(k * factors.len())?);
                let job = Job { end, base, alpha: *alpha as f32, ..*job };
                let job = device.baker.init(bytemuck::bytes_of(&job), wgpu::BufferUsages::UNIFORM);
                // A lobe with a factor has points of its own, whose weights are that.
                let weighed = (!scale.is_one()).then(|| {
                    let times = |&point: &Factors| {
                        let [mu_i, mu_e] = POINT_MUS.map(|k| f64::from(point[k]));
                        let mut point = point;
                        point[POINT_WEIGHT] = scale.at(mu_i, mu_e) as f32;
                        point
                    };
                    let weighed: Vec<_> = factors.par_iter().map(times).collect();
                    device.baker.init(bytemuck::cast_slice(&weighed), wgpu::BufferUsages::STORAGE)
                });
                let points = weighed.as_ref().unwrap_or(&slot.points);
                let buffers = [&job, &slot.output, points];
                let step = Step {
                    pipeline: pipeline.clone(),
                    bind_group: device.baker.bind(pipeline, buffers.map(wgpu::Buffer::as_entire_binding)),
                    workgroups: [count(factors.len().div_ceil(WORKGROUP))?, 1],
                    evaluations: factors.len() as u64,
                };
                step.encode(&mut encoder);
            }
        }
        let bytes = settings.len() * factors.len() * *channels * 4;
        slot.flight = Some((device.send(encoder, &slot.output, &slot.staging, bytes as u64), chunk.clone()));
        Ok(())
    }

    /// Puts a chunk where it belongs among the values of all `points`.
    fn land(&mut self, slot: usize, points: usize, values: &mut [f32]) -> Result<()> {
        let slot = &mut self.slots[slot];
        let Some((flight, chunk)) = slot.flight.take() else { return Ok(()) };
        self.device.arrive(&flight)?;
        let row = chunk.points.len() * self.channels;
        self.device.land(&slot.staging, flight, &mut |bytes| {
            for (setting, bytes) in chunk.settings.clone().zip(bytes.chunks_exact(row * 4)) {
                let first = (setting * points + chunk.points.start) * self.channels;
                for (value, bytes) in values[first..first + row].iter_mut().zip(bytes.as_chunks().0) {
                    *value = f32::from_le_bytes(*bytes);
                }
            }
        })
    }
}

fn factors((pair, azimuth): (Pair, Azimuth)) -> Factors {
    Sample { pair, azimuth, weight: 1.0 }.to_array().map(|x| x as f32)
}

/// 0..`n` in pieces of `most`.
fn ranges(n: usize, most: usize) -> impl Iterator<Item = Range<usize>> {
    (0..n).step_by(most).map(move |first| first..(first + most).min(n))
}
