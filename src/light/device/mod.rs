//! Integrals over environment maps on the device: bands of rows, whose parts the host adds up in f64.

mod harmonics;
mod irradiance;

use crate::backend::gpu::baker::{Baker, DispatchStep};
use crate::backend::gpu::device::Device;
use crate::base::error::Result;
use crate::base::precision::Precision;
use crate::shader::Kernel;
use std::ops::Range;

const WORKGROUP: usize = 64;
/// Bytes of texels and of sums that are uploaded together: half of what every device binds.
const BAND_BYTES: usize = 1 << 26;
/// Bytes of a dispatch's results.
const RESULT_BYTES: usize = 1 << 25;

/// A kernel, and where its results go.
struct ResultBuffers<'a> {
    device: &'a Device,
    pipeline: wgpu::ComputePipeline,
    output: wgpu::Buffer,
    staging: wgpu::Buffer,
}

impl<'a> ResultBuffers<'a> {
    /// With room for so many bytes of results.
    fn new(device: &'a Device, kernel: Kernel, bytes: usize) -> Result<Self> {
        let pipeline = device.baker.pipeline(kernel, None, 3, Precision::F32)?;
        let (output, staging) = (device.baker.output(bytes), device.staging(bytes as u64));
        Ok(Self { device, pipeline, output, staging })
    }

    /// Runs some invocations, each of which has so many results, and shows them.
    fn run(
        &self,
        job: &[u8],
        inputs: &[&wgpu::Buffer],
        invocations: usize,
        results: usize,
        take: &mut dyn FnMut(&[[u8; 4]]),
    ) -> Result<()> {
        let Self { device, pipeline, output, staging } = self;
        let Baker { device: own, .. } = &device.baker;
        let job = device.baker.init(job, wgpu::BufferUsages::UNIFORM);
        let buffers = [&job, output].into_iter().chain(inputs.iter().copied());
        let step = DispatchStep {
            pipeline: pipeline.clone(),
            bind_group: device.baker.bind(pipeline, buffers.map(wgpu::Buffer::as_entire_binding)),
            workgroups: [crate::backend::gpu::baker::count(invocations.div_ceil(WORKGROUP))?, 1],
            evaluations: invocations as u64,
        };
        let mut encoder = own.create_command_encoder(&Default::default());
        step.encode(&mut encoder);
        let flight = device.send(encoder, output, staging, (4 * invocations * results) as u64);
        device.arrive(&flight)?;
        device.land(staging, flight, &mut |bytes| take(bytes.as_chunks().0))
    }
}

impl Device {
    fn storage(&self, values: &[f32]) -> wgpu::Buffer {
        self.baker.init(bytemuck::cast_slice(values), wgpu::BufferUsages::STORAGE)
    }
}

/// Adds numbers to sums.
fn add<const N: usize>(sums: &mut [f64; N], bytes: &[[u8; 4]; N]) {
    for (sum, &bytes) in sums.iter_mut().zip(bytes) {
        *sum += f64::from(f32::from_le_bytes(bytes));
    }
}

/// 0..`n` in pieces of `most`.
fn pieces(n: usize, most: usize) -> impl Iterator<Item = Range<usize>> {
    (0..n).step_by(most).map(move |first| first..(first + most).min(n))
}
