//! Irradiance of an environment map on the device: bands of rows and of normals, whose parts the host adds up in f64.

use super::baker::{Baker, EVALUATIONS_PER_DISPATCH, Step, count};
use super::compose::Kernel;
use super::device::Device;
use super::loops::SAFE_TURNS;
use crate::error::Result;
use crate::light::irradiance::{BLOCK, Column, Prepared, Row};
use crate::plan::Precision;
use bytemuck::{Pod, Zeroable};
use std::ops::Range;

const WORKGROUP: usize = 64;
/// Bytes of texels and of sums that are uploaded together: half of what every device binds.
const BAND_BYTES: usize = 1 << 26;
/// Bytes of a dispatch's results.
const RESULT_BYTES: usize = 1 << 25;

/// `Job` of `shaders/light/irradiance.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Job {
    first: u32,
    count: u32,
    rows: u32,
    width: u32,
    split: u32,
    kept: u32,
    step: f32,
    half: f32,
}

impl Device {
    /// E of some normals of the world, R, G, B: as [`Prepared::irradiance`], in f32. `tick` is called with shares of the
    /// work, and stops it by an error.
    pub(crate) fn irradiance(
        &self,
        map: &Prepared,
        normals: &[[f64; 3]],
        split: u32,
        tick: &dyn Fn(f64) -> Result<()>,
    ) -> Result<Vec<[f64; 3]>> {
        let pipeline = self.baker.pipeline(Kernel::Irradiance, None, 3, Precision::F32)?;
        let (width, height) = (map.map.width(), map.map.height());
        let mut sums = vec![[0.0; 3]; normals.len()];
        if normals.is_empty() {
            return Ok(sums);
        }
        let of_normal = |&world: &[f64; 3]| {
            let normal = map.normal(world);
            let [x, y, z] = normal.n;
            [x, y, z, normal.sin, normal.place, 0.0, 0.0, 0.0].map(|x| x as f32)
        };
        let uploaded: Vec<_> = normals.iter().map(of_normal).collect();
        let uploaded = self.storage(uploaded.as_flattened());
        let columns: Vec<_> = map.columns.iter().map(of_column).collect();
        let columns = self.storage(columns.as_flattened());

        let row_bytes = (12 * width).max(72 * map.kept());
        let band = (BAND_BYTES / row_bytes).clamp(1, height);
        // What an invocation costs: sums beside whole blocks, and a few cells that the horizon crosses.
        let cost = 4 * BLOCK + width / 8;
        for rows in pieces(height, band) {
            let of_rows: Vec<_> = map.rows[rows.clone()].iter().map(of_row).collect();
            let of_rows = self.storage(of_rows.as_flattened());
            let texels = &map.map.texels()[rows.start * width..rows.end * width];
            let texels = self.storage(texels.as_flattened());
            let kept = &map.sums[rows.start * map.kept()..rows.end * map.kept()];
            let pairs: Vec<_> = kept.as_flattened().as_flattened().iter().map(|&x| split_in_two(x)).collect();
            let kept = self.storage(pairs.as_flattened());
            let fits = RESULT_BYTES / (12 * rows.len());
            let most = fits.min(EVALUATIONS_PER_DISPATCH / (cost * rows.len()));
            let bytes = |normals: &Range<usize>| 12 * normals.len() * rows.len();
            let groups: Vec<_> = pieces(normals.len(), most.max(1)).collect();
            let largest = groups.iter().map(bytes).max().unwrap_or(0);
            let (output, staging) = (self.baker.output(largest), self.staging(largest as u64));
            for group in groups {
                let job = Job {
                    first: count(group.start)?,
                    count: count(group.len())?,
                    rows: count(rows.len())?,
                    width: count(width)?,
                    split,
                    kept: count(map.kept())?,
                    step: map.step as f32,
                    half: map.half as f32,
                };
                let job = self.baker.init(bytemuck::bytes_of(&job), wgpu::BufferUsages::UNIFORM);
                let buffers = [&job, &output, &uploaded, &of_rows, &columns, &texels, &kept];
                let invocations = group.len() * rows.len();
                let step = Step {
                    pipeline: pipeline.clone(),
                    bind_group: self.baker.bind(&pipeline, buffers.map(wgpu::Buffer::as_entire_binding)),
                    workgroups: [count(invocations.div_ceil(WORKGROUP))?, 1],
                    evaluations: (invocations * cost) as u64,
                };
                let Baker { device, .. } = &self.baker;
                let mut encoder = device.create_command_encoder(&Default::default());
                step.encode(&mut encoder);
                let flight = self.send(encoder, &output, &staging, bytes(&group) as u64);
                self.arrive(&flight)?;
                self.land(&staging, flight, &mut |bytes| {
                    for (k, parts) in bytes.as_chunks::<12>().0.chunks_exact(rows.len()).enumerate() {
                        for part in parts {
                            for (sum, bytes) in sums[group.start + k].iter_mut().zip(part.as_chunks().0) {
                                *sum += f64::from(f32::from_le_bytes(*bytes));
                            }
                        }
                    }
                })?;
                tick((rows.len() * group.len()) as f64 / (height * normals.len()) as f64)?;
            }
        }
        Ok(sums)
    }

    /// Whether its kernels' loops are known to run to their end: the crossed cells of a row, at most all.
    pub(crate) fn runs_irradiance(&self, map: &Prepared, split: u32) -> Result<bool> {
        let parts = (split * (split + 1) + 1) as usize;
        let turns = map.map.width() * (1 + parts) + 6 * BLOCK + 64;
        Ok(turns <= SAFE_TURNS as usize || turns <= self.known_turns()? as usize)
    }

    fn storage(&self, values: &[f32]) -> wgpu::Buffer {
        self.baker.init(bytemuck::cast_slice(values), wgpu::BufferUsages::STORAGE)
    }
}

fn of_row(row: &Row) -> [f32; 8] {
    let Row { edges: [[a, b], [c, d]], middle: [e, f], across, along } = *row;
    [a, b, c, d, e, f, across, along].map(|x| x as f32)
}

fn of_column(column: &Column) -> [f32; 8] {
    let Column { edge: [a, b], middle: [c, d], chord: [e, f] } = *column;
    [a, b, c, d, e, f, 0.0, 0.0].map(|x| x as f32)
}

/// A number as two f32.
fn split_in_two(x: f64) -> [f32; 2] {
    let high = x as f32;
    [high, (x - f64::from(high)) as f32]
}

/// 0..`n` in pieces of `most`.
fn pieces(n: usize, most: usize) -> impl Iterator<Item = Range<usize>> {
    (0..n).step_by(most).map(move |first| first..(first + most).min(n))
}
