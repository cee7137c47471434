//! The table: values, axes, provenance and error. The one currency between all parts.

use crate::axis::Axis;
use crate::error::{Error, Result};
use serde::Serialize;
use std::collections::BTreeMap;

/// A baked table: `quantity × axes × subject`, row-major, the channels last.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Unique in its set; also the stem of its files.
    pub name: String,
    /// The name of the quantity: `brdf`, `rho_dh`, …
    pub quantity: String,
    /// The unit of the values: `sr⁻¹` or `1`.
    pub unit: String,
    /// What was tabulated: a basis (`ggx`) or a material's name.
    pub subject: String,
    /// Parameters that are the same for the whole table, by name.
    pub parameters: BTreeMap<String, f64>,
    /// The axes, slowest first.
    pub axes: Vec<Axis>,
    /// The channels' names: `A`, `B` of a basis, `R`, `G`, `B` of a material.
    pub channels: Vec<String>,
    /// The values, row-major over the axes, channels last.
    pub values: Vec<f32>,
    /// How it was computed, in words: "warped 32 v × 2·24 φ".
    pub rule: String,
    /// The arithmetic: `f32` or `f64`.
    pub precision: String,
    /// How far the values are from the truth.
    pub error: TableError,
    /// Time to compute it and to read it back; neither compiling nor the check.
    pub seconds: f64,
}

/// The error of a table against the f64 reference.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TableError {
    /// `absolute` for integrals, `relative` for values.
    pub kind: ErrorKind,
    /// Relative errors are |x − f| / max(f, floor); in the table's unit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub floor: Option<f64>,
    /// What the rule promises a priori, where it promises anything.
    pub estimate: Option<f64>,
    /// The largest difference found; `None` when nothing was checked.
    pub measured_max: Option<f64>,
    /// The root mean square of the differences found.
    pub measured_rms: Option<f64>,
    /// How many texels were compared.
    pub texels_checked: usize,
    /// Where the largest difference lies, axis by axis, with both values.
    pub worst: BTreeMap<String, f64>,
}

/// Whether errors are differences or ratios.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ErrorKind {
    /// |x − f|
    Absolute,
    /// |x − f| / max(f, floor)
    Relative,
}

impl Table {
    /// Samples along each axis, slowest first; without the channels.
    pub fn shape(&self) -> Vec<usize> {
        self.axes.iter().map(Axis::len).collect()
    }

    /// Number of texels: the product of the shape.
    pub fn texels(&self) -> usize {
        self.shape().iter().product()
    }

    /// The image that holds the table: width is the last axis, height the product of the others.
    pub fn image_size(&self) -> (usize, usize) {
        let width = self.axes.last().map_or(1, Axis::len);
        (width, self.texels() / width)
    }

    /// The index along each axis of a texel.
    pub fn indices(&self, texel: usize) -> Vec<usize> {
        indices(&self.shape(), texel)
    }

    /// The channels of one texel.
    pub fn texel(&self, texel: usize) -> &[f32] {
        let n = self.channels.len();
        &self.values[texel * n..(texel + 1) * n]
    }

    /// Refuses a table with a value that is not finite or is negative: the device may not say so
    /// itself (WGSL lets an implementation assume that NaN does not occur), so the host looks.
    pub fn check_sane(&self) -> Result<()> {
        self.check_sane_from(0, &self.values)
    }

    /// The same of a part of its values, which begin at a texel.
    pub(crate) fn check_sane_from(&self, texel: usize, values: &[f32]) -> Result<()> {
        let channels = self.channels.len();
        let Some(at) = values.iter().position(|v| !v.is_finite() || v.is_sign_negative() && *v != 0.0) else {
            return Ok(());
        };
        Err(Error::Promise(format!(
            "table {}: {} at {}; a BRDF is finite and non-negative",
            self.name,
            values[at],
            self.place(texel + at / channels),
        )))
    }

    /// A texel's coordinates, in words.
    pub fn place(&self, texel: usize) -> String {
        let coordinates = self.axes.iter().zip(self.indices(texel));
        let words: Vec<_> =
            coordinates.map(|(axis, k)| format!("{} = {}", axis.variable.name(), axis.values[k])).collect();
        words.join(", ")
    }
}

/// The index along each axis, slowest first, of a flat row-major index.
pub fn indices(shape: &[usize], mut flat: usize) -> Vec<usize> {
    let mut indices = vec![0; shape.len()];
    for (index, &n) in indices.iter_mut().zip(shape).rev() {
        *index = flat % n;
        flat /= n;
    }
    indices
}
