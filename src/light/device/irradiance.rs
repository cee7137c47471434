//! Irradiance of an environment map on the device: bands of rows, groups of normals, and where a row has more crossed columns
//! than every driver's loops take, these in parts.

use crate::backend::gpu::baker::{EVALUATIONS_PER_DISPATCH, count};
use crate::backend::gpu::device::Device;
use crate::backend::gpu::loop_limit::SAFE_TURNS;
use crate::base::error::Result;
use crate::light::device::{BAND_BYTES, RESULT_BYTES, ResultBuffers, add, pieces};
use crate::light::irradiance::{BLOCK, MapColumn, PreparedMap, Row};
use crate::shader::Kernel;
use bytemuck::{Pod, Zeroable};

/// `Job` of `shaders/light/irradiance.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct IrradianceJob {
    first: u32,
    count: u32,
    rows: u32,
    width: u32,
    split: u32,
    block: u32,
    kept: u32,
    skip: u32,
    most: u32,
    step: f32,
    half: f32,
    margin: f32,
}

impl Device {
    /// E of some normals of the world, R, G, B: as [`PreparedMap::irradiance`], in f32. `tick` is called with shares of the
    /// work, and stops it by an error.
    pub(crate) fn irradiance(
        &self,
        map: &PreparedMap,
        normals: &[[f64; 3]],
        split: u32,
        tick: &dyn Fn(f64) -> Result<()>,
    ) -> Result<Vec<[f64; 3]>> {
        self.guarded(|| self.irradiance_unguarded(map, normals, split, tick))
    }

    fn irradiance_unguarded(
        &self,
        map: &PreparedMap,
        normals: &[[f64; 3]],
        split: u32,
        tick: &dyn Fn(f64) -> Result<()>,
    ) -> Result<Vec<[f64; 3]>> {
        let (width, height) = (map.map.width(), map.map.height());
        let mut sums = vec![[0.0; 3]; normals.len()];
        if normals.is_empty() {
            return Ok(sums);
        }
        let of_normal = |&world: &[f64; 3]| {
            let normal = map.normal(world);
            let [x, y, z] = normal.n;
            let column = normal.place.floor();
            [x, y, z, normal.sin, column, normal.place - column, 0.0, 0.0].map(|x| x as f32)
        };
        let uploaded: Vec<_> = normals.iter().map(of_normal).collect();
        let uploaded = self.storage(uploaded.as_flattened());
        let columns: Vec<_> = map.columns.iter().map(of_column).collect();
        let columns = self.storage(columns.as_flattened());

        let row_bytes = (12 * width).max(72 * map.kept());
        let band = (BAND_BYTES / row_bytes).clamp(1, height);
        // Four nodes a piece of all columns that a normal's horizon crosses: of a band at most each column once, and each row's
        // borders on both sides.
        let cost = 4 * split as usize * (width + 4 * band) + 8 * band;
        let most = (RESULT_BYTES / (12 * band)).min(EVALUATIONS_PER_DISPATCH / cost).max(1);
        let groups: Vec<_> = pieces(normals.len(), most).collect();
        let place = ResultBuffers::new(self, Kernel::Irradiance, 12 * most.min(normals.len()) * band)?;
        let crossed = crossed_columns(split);
        for rows in pieces(height, band) {
            let of_rows: Vec<_> = map.rows[rows.clone()].iter().map(of_row).collect();
            let of_rows = self.storage(of_rows.as_flattened());
            let texels = &map.map.texels()[rows.start * width..rows.end * width];
            let texels = self.storage(texels.as_flattened());
            let kept = &map.sums[rows.start * map.kept()..rows.end * map.kept()];
            let pairs: Vec<_> = kept.as_flattened().as_flattened().iter().map(|&x| split_in_two(x)).collect();
            let kept = self.storage(pairs.as_flattened());
            let inputs = [&uploaded, &of_rows, &columns, &texels, &kept];
            for group in &groups {
                // Columns and the margins on both sides.
                for part in pieces(width + 4 + 2 * map.margin.ceil() as usize, crossed) {
                    let job = IrradianceJob {
                        first: count(group.start)?,
                        count: count(group.len())?,
                        rows: count(rows.len())?,
                        width: count(width)?,
                        split,
                        block: count(map.block)?,
                        kept: count(map.kept())?,
                        skip: count(part.start)?,
                        most: count(part.len())?,
                        step: map.step as f32,
                        half: map.half as f32,
                        margin: map.margin as f32,
                    };
                    let invocations = group.len() * rows.len();
                    place.run(bytemuck::bytes_of(&job), &inputs, invocations, 3, &mut |parts| {
                        for row in parts.as_chunks::<3>().0.chunks_exact(group.len()) {
                            sums[group.clone()].iter_mut().zip(row).for_each(|(sum, part)| add(sum, part));
                        }
                    })?;
                }
                tick((rows.len() * group.len()) as f64 / (height * normals.len()) as f64)?;
            }
        }
        Ok(sums)
    }
}

/// Crossed columns of a row that one invocation takes: a turn each, and for both parts one for each piece and the one that ends
/// them; and beside them those of the sums, twice at both ends of a run.
fn crossed_columns(split: u32) -> usize {
    (SAFE_TURNS as usize - 4 * BLOCK - 64) / (2 * split as usize + 3)
}

fn of_row(row: &Row) -> [f32; 8] {
    let Row { edges: [[a, b], [c, d]], middle: [e, f], across, along } = *row;
    [a, b, c, d, e, f, across, along].map(|x| x as f32)
}

fn of_column(column: &MapColumn) -> [f32; 4] {
    let MapColumn { middle: [a, b], chord: [c, d] } = *column;
    [a, b, c, d].map(|x| x as f32)
}

/// A number as two f32.
fn split_in_two(x: f64) -> [f32; 2] {
    let high = x as f32;
    [high, (x - f64::from(high)) as f32]
}
