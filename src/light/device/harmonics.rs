//! Spherical harmonics of an environment map on the device.

use crate::backend::gpu::baker::count;
use crate::backend::gpu::device::Device;
use crate::base::error::Result;
use crate::light::device::{BAND_BYTES, RESULT_BYTES, ResultBuffers, add, pieces};
use crate::light::harmonics::{Coefficients, MapFactors};
use crate::shader::Kernel;
use bytemuck::{Pod, Zeroable};

/// Columns that one invocation adds up, about.
const SHARE: usize = 256;
/// Numbers that an invocation makes.
const RESULTS: usize = 27;

/// `Job` of `shaders/light/harmonics.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct HarmonicsJob {
    rows: u32,
    width: u32,
    shares: u32,
    step: f32,
}

impl Device {
    /// The coefficients of a map's radiance: as [`MapFactors::sum`], in f32.
    pub(crate) fn harmonics(&self, factors: &MapFactors) -> Result<Coefficients> {
        self.guarded(|| self.harmonics_unguarded(factors))
    }

    fn harmonics_unguarded(&self, factors: &MapFactors) -> Result<Coefficients> {
        let map = factors.map;
        let (width, height) = (map.width(), map.height());
        let shares = width.div_ceil(SHARE);
        let columns: Vec<_> = factors.columns.iter().map(|column| column.map(|x| x as f32)).collect();
        let columns = self.storage(columns.as_flattened());
        let fits = BAND_BYTES / (12 * width);
        let band = fits.min(RESULT_BYTES / (4 * RESULTS * shares)).clamp(1, height);
        let place = ResultBuffers::new(self, Kernel::Harmonics, 4 * RESULTS * shares * band)?;
        let mut sums = [0.0; RESULTS];
        for rows in pieces(height, band) {
            let of_rows: Vec<_> =
                factors.rows[rows.clone()].iter().map(|row| row.map(|x| x as f32)).collect();
            let of_rows = self.storage(of_rows.as_flattened());
            let texels = &map.texels()[rows.start * width..rows.end * width];
            let texels = self.storage(texels.as_flattened());
            let job = HarmonicsJob {
                rows: count(rows.len())?,
                width: count(width)?,
                shares: count(shares)?,
                step: factors.step as f32,
            };
            let inputs = [&of_rows, &columns, &texels];
            place.run(bytemuck::bytes_of(&job), &inputs, rows.len() * shares, RESULTS, &mut |parts| {
                parts.as_chunks().0.iter().for_each(|part| add(&mut sums, part));
            })?;
        }
        Ok(std::array::from_fn(|k| std::array::from_fn(|c| sums[3 * k + c])))
    }
}
