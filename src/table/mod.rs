//! The table: values, axes, provenance and error. The one currency between all parts.

pub mod axis;
mod check;
pub mod quantity;
pub mod report;
pub mod rule;
pub mod storage;

pub use check::Check;

use crate::base::error::{Error, Result};
use crate::table::axis::Axis;
use crate::table::quantity::Quantity;
use crate::table::report::Choice;
use crate::table::report::InterpolationError;
use crate::table::storage::Storage;
use serde::Serialize;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt::Display;

/// A baked table: `quantity × axes × subject`, row-major, the channels last.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Unique in its set; also the stem of its files.
    pub name: String,
    /// What the values are, and in which unit.
    pub quantity: &'static Quantity,
    /// What was tabulated: a basis (`ggx`) or a material's name.
    pub subject: String,
    /// Parameters that are the same for the whole table, by name.
    pub parameters: BTreeMap<String, f64>,
    /// The axes, slowest first.
    pub axes: Vec<Axis>,
    /// The channels' names: `A`, `B` of a basis, `R`, `G`, `B` of a material.
    pub channels: Vec<String>,
    /// The values, row-major over the axes, channels last.
    pub values: Values,
    /// How it was computed, in words: "warped 32 v × 2·24 φ".
    pub rule: String,
    /// The format that the values were rounded to.
    pub storage: Storage,
    /// What the storage optimiser chose, where it did.
    pub bilinear: Option<Choice>,
    /// The arithmetic: `f32` or `f64`.
    pub precision: String,
    /// How far the values are from the truth.
    pub error: TableError,
    /// Time to compute it and to read it back; neither compiling nor the check.
    pub seconds: f64,
}

/// Values in the arithmetic that made them, or in that which they were rounded to.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Values {
    /// Single precision.
    F32(Vec<f32>),
    /// Double precision.
    F64(Vec<f64>),
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
    /// What they were compared with, where that is not the f64 reference.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub against: Option<String>,
    /// Values below the normal range of half floats, where they lose relative precision.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub underflows: Option<usize>,
    /// What look-ups between the samples cost; `None` where that was not measured.
    pub interpolation: Option<InterpolationError>,
    /// Where the largest difference lies, axis by axis, with both values.
    pub worst: BTreeMap<String, f64>,
}

impl TableError {
    /// Nothing was compared yet.
    pub(crate) fn unmeasured(kind: ErrorKind, floor: Option<f64>, estimate: Option<f64>) -> Self {
        Self {
            kind,
            floor,
            estimate,
            measured_max: None,
            measured_rms: None,
            texels_checked: 0,
            against: None,
            underflows: None,
            interpolation: None,
            worst: BTreeMap::new(),
        }
    }
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

/// The largest differences of two tables' texels: of those that were kept, and of those that were taken
/// from the other; 0 where there are none.
pub(crate) struct Taken {
    pub kept: f64,
    pub largest: f64,
}

impl Values {
    /// How many.
    pub fn len(&self) -> usize {
        match self {
            Self::F32(values) => values.len(),
            Self::F64(values) => values.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Drops them and keeps their room.
    #[cfg(feature = "batch")]
    pub(crate) fn clear(&mut self) {
        match self {
            Self::F32(values) => values.clear(),
            Self::F64(values) => values.clear(),
        }
    }

    /// One of them; both kinds fit f64.
    pub fn get(&self, k: usize) -> f64 {
        match self {
            Self::F32(values) => f64::from(values[k]),
            Self::F64(values) => values[k],
        }
    }

    /// All of them, in order.
    pub fn iter(&self) -> impl Iterator<Item = f64> + Clone {
        (0..self.len()).map(|k| self.get(k))
    }

    /// One of them in the fewest digits that tell it from its neighbours.
    pub fn show(&self, k: usize) -> String {
        match self {
            Self::F32(values) => values[k].to_string(),
            Self::F64(values) => values[k].to_string(),
        }
    }

    /// Takes the values of `other` for every texel of so many channels where both differ by more than
    /// `limit`.
    pub(crate) fn take_beyond(&mut self, limit: f64, other: &Self, channels: usize) -> Taken {
        let mut taken = Taken { kept: 0.0, largest: 0.0 };
        for texel in 0..self.len() / channels {
            let range = texel * channels..(texel + 1) * channels;
            let difference = range.clone().map(|k| (self.get(k) - other.get(k)).abs()).fold(0.0, f64::max);
            if difference <= limit {
                taken.kept = taken.kept.max(difference);
                continue;
            }
            taken.largest = taken.largest.max(difference);
            match (&mut *self, other) {
                (Self::F32(to), Self::F32(from)) => to[range.clone()].copy_from_slice(&from[range]),
                (Self::F64(to), Self::F64(from)) => to[range.clone()].copy_from_slice(&from[range]),
                // One path makes one kind.
                _ => {}
            }
        }
        taken
    }

    /// Rounded to f32, to the nearest.
    pub fn to_f32(&self) -> Cow<'_, [f32]> {
        match self {
            Self::F32(values) => Cow::Borrowed(values),
            Self::F64(values) => values.iter().map(|&v| v as f32).collect(),
        }
    }
}

impl From<Vec<f32>> for Values {
    fn from(values: Vec<f32>) -> Self {
        Self::F32(values)
    }
}

impl From<Vec<f64>> for Values {
    fn from(values: Vec<f64>) -> Self {
        Self::F64(values)
    }
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

    /// One channel of one texel.
    pub fn value(&self, texel: usize, channel: usize) -> f64 {
        self.values.get(texel * self.channels.len() + channel)
    }

    /// The channels of one texel.
    pub fn texel(&self, texel: usize) -> Vec<f64> {
        (0..self.channels.len()).map(|channel| self.value(texel, channel)).collect()
    }

    /// Refuses a table with a value that its quantity cannot have, such as NaN: the device may not say so
    /// itself (WGSL lets an implementation assume that NaN does not occur), so the host looks.
    pub fn check_sane(&self) -> Result<()> {
        match &self.values {
            Values::F32(values) => self.check_sane_from(0, values),
            Values::F64(values) => self.check_sane_from(0, values),
        }
    }

    /// The same of a part of its values, which begin at a texel.
    pub(crate) fn check_sane_from<T>(&self, texel: usize, values: &[T]) -> Result<()>
    where
        T: Copy + Into<f64> + Display,
    {
        let channels = self.channels.len();
        let Some(at) = values.iter().position(|&value| !self.quantity.allows(value.into())) else {
            return Ok(());
        };
        Err(Error::Promise(format!(
            "table {}: {} at {}; {}",
            self.name,
            values[at],
            self.place(texel + at / channels),
            self.quantity.allowed(),
        )))
    }

    /// A texel's coordinates, in words.
    pub fn place(&self, texel: usize) -> String {
        let coordinates = self.axes.iter().zip(self.indices(texel));
        let words: Vec<_> = coordinates
            .map(|(axis, k)| format!("{} = {}", axis.variable().name(), axis.values()[k]))
            .collect();
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_texels_that_differ_too_much_are_taken() {
        let mut values = Values::F64(vec![1.0, 1.0, 2.0, 2.0, 3.0, 3.0]);
        let taken = values.take_beyond(0.1, &Values::F64(vec![1.0, 1.05, 2.0, 2.5, 3.0, 3.0]), 2);
        assert_eq!(values, Values::F64(vec![1.0, 1.0, 2.0, 2.5, 3.0, 3.0]));
        assert!((taken.kept - 0.05).abs() < 1e-12 && (taken.largest - 0.5).abs() < 1e-12);
    }
}
