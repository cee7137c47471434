//! Evaluates a list of pairs of directions on a device, chunk after chunk: the host makes the next chunk's half-angle
//! terms while the device computes.

use crate::backend::gpu::baker::{Baker, DispatchStep, count};
use crate::backend::gpu::device::Device;
use crate::backend::gpu::dispatch::KernelJob;
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

/// The number of values of a chunk: they take some milliseconds on any device, and their buffers stay in a cache.
const CHUNK: usize = 1 << 17;
/// The number of settings of a chunk, among which the cost of its half-angle terms is shared.
const SETTINGS: usize = 64;
const WORKGROUP: usize = 64;

/// The lobes' kernels, and the buffers that all chunks share: the first touch of a buffer costs more than
/// to compute what it holds.
pub(crate) struct PointKernels<'a> {
    device: &'a Device,
    lobes: Vec<(wgpu::ComputePipeline, KernelJob)>,
    channels: usize,
    terms: Vec<PointTerms>,
    slots: [ChunkBuffers; 2],
}

/// The half-angle terms of a point: `Point` of `shaders/kernel/point.wgsl`.
type PointTerms = [f32; POINT];

/// The buffers of a chunk. Two of them take turns.
struct ChunkBuffers {
    points: wgpu::Buffer,
    output: wgpu::Buffer,
    staging: wgpu::Buffer,
    flight: Option<(Flight, Chunk)>,
}

/// A part of the list: some settings at some points.
#[derive(Clone)]
struct Chunk {
    settings: Range<usize>,
    points: Range<usize>,
}

impl<'a> PointKernels<'a> {
    pub fn new(device: &'a Device, lobes: &[Lobe]) -> Result<Self> {
        device.guarded(|| Self::open(device, lobes))
    }

    fn open(device: &'a Device, lobes: &[Lobe]) -> Result<Self> {
        let channels = lobes.first().map_or(0, |lobe| lobe.weights().len());
        let lobe = |(k, lobe): (usize, &Lobe)| {
            let kernel = if k == 0 { Kernel::Points } else { Kernel::AddPoints };
            let pipeline = device.baker.pipeline(kernel, Some(lobe.model()), channels, Precision::F32)?;
            Ok((pipeline, KernelJob::new(lobe, 1.0)))
        };
        let bytes = CHUNK * 4 * channels;
        let slot = || ChunkBuffers {
            points: device.baker.input(CHUNK * size_of::<PointTerms>()),
            output: device.baker.output(bytes),
            staging: device.staging(bytes as u64),
            flight: None,
        };
        let lobes = lobes.iter().enumerate().map(lobe).collect::<Result<_>>()?;
        Ok(Self { device, lobes, channels, terms: Vec::new(), slots: [slot(), slot()] })
    }

    /// Sets other weights for the same models.
    pub fn set(&mut self, lobes: &[Lobe]) {
        for ((_, job), lobe) in self.lobes.iter_mut().zip(lobes) {
            *job = KernelJob::new(lobe, 1.0);
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
                let terms =
                    angles[chunk.points.clone()].par_iter().map(|angles| point_terms(angles.factors()));
                terms.collect_into_vec(&mut self.terms);
                self.launch(k % 2, chunk, &settings[chunk.settings.clone()])?;
            }
            if k > 0 {
                self.land((k - 1) % 2, angles.len(), values)?;
            }
        }
        Ok(())
    }

    /// Starts a chunk, whose half-angle terms are made.
    fn launch(&mut self, slot: usize, chunk: &Chunk, settings: &[Vec<ScaledLobe>]) -> Result<()> {
        let Self { device, lobes, channels, terms, slots } = self;
        let Baker { device: wgpu, queue, .. } = &device.baker;
        let slot = &mut slots[slot];
        queue.write_buffer(&slot.points, 0, bytemuck::cast_slice(terms));
        let mut encoder = wgpu.create_command_encoder(&Default::default());
        for (k, setting) in settings.iter().enumerate() {
            for ((pipeline, job), ScaledLobe { alpha, scale }) in lobes.iter().zip(setting) {
                let (end, base) = (count(terms.len())?, count(k * terms.len())?);
                let job = KernelJob { end, base, alpha_or_bound: *alpha as f32, ..*job };
                let job = device.baker.init(bytemuck::bytes_of(&job), wgpu::BufferUsages::UNIFORM);
                // A lobe with factors has its own points, whose weights are the scale.
                let weighed = (!scale.is_one()).then(|| {
                    let with_scale = |&point: &PointTerms| {
                        let [mu_i, mu_e] = POINT_MUS.map(|k| f64::from(point[k]));
                        let mut point = point;
                        point[POINT_WEIGHT] = scale.value(mu_i, mu_e) as f32;
                        point
                    };
                    let weighed: Vec<_> = terms.par_iter().map(with_scale).collect();
                    device.baker.init(bytemuck::cast_slice(&weighed), wgpu::BufferUsages::STORAGE)
                });
                let points = weighed.as_ref().unwrap_or(&slot.points);
                let buffers = [&job, &slot.output, points];
                let step = DispatchStep {
                    pipeline: pipeline.clone(),
                    bind_group: device.baker.bind(pipeline, buffers.map(wgpu::Buffer::as_entire_binding)),
                    workgroups: [count(terms.len().div_ceil(WORKGROUP))?, 1],
                    evaluations: terms.len() as u64,
                };
                step.encode(&mut encoder);
            }
        }
        let bytes = settings.len() * terms.len() * *channels * 4;
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

fn point_terms((pair, azimuth): (Pair, Azimuth)) -> PointTerms {
    Sample { pair, azimuth, weight: 1.0 }.to_array().map(|x| x as f32)
}

/// Splits 0..`n` into ranges of at most `length`.
fn ranges(n: usize, length: usize) -> impl Iterator<Item = Range<usize>> {
    (0..n).step_by(length).map(move |first| first..(first + length).min(n))
}
