//! The table: values, axes, provenance and error. Every other room makes tables or reads them.

pub mod axis;
mod check;
pub mod quantity;
pub mod report;
pub mod rule;
pub mod storage;

pub use check::Check;

use crate::base::error::{Error, Result};
use crate::base::precision::Precision;
use crate::table::axis::Axis;
use crate::table::quantity::Quantity;
use crate::table::report::Choice;
use crate::table::report::InterpolationError;
use crate::table::storage::Storage;
use serde::Serialize;
use std::borrow::Cow;
use std::collections::BTreeMap;

/// A baked table: `quantity × axes × subject`, row-major, the channels last.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// The name, unique in its set; also the stem of its files.
    pub name: String,
    /// The quantity of the values, with its unit.
    pub quantity: &'static Quantity,
    /// The subject: a basis (`ggx`) or a material's name.
    pub subject: String,
    /// Parameters that are the same for the whole table, by name.
    pub parameters: BTreeMap<String, f64>,
    /// The axes, slowest first.
    pub axes: Vec<Axis>,
    /// The channels' names: `A`, `B` of a basis, `R`, `G`, `B` of a material.
    pub channels: Vec<String>,
    /// The values, row-major over the axes, channels last.
    pub values: Values,
    /// The rule of integration, in words: "warped 32 v × 2·24 φ".
    pub rule: String,
    /// The format that the values were rounded to.
    pub storage: Storage,
    /// The layout that the layout search chose, where it did.
    pub bilinear: Option<Choice>,
    /// The arithmetic.
    pub precision: Precision,
    /// The error of the values against the reference.
    pub error: TableError,
    /// The seconds to compute the table and to read it back, without compiling and without the check.
    pub seconds: f64,
}

/// The values of a table, in the precision in which they were computed or to which they were rounded.
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
    /// The bound on the error of the stored values, where there is one: of integrals the difference of two rules and what the
    /// finer of them promises, or without a check what the rule promises; of values the budget of the arithmetic. It
    /// includes `rounding`.
    pub estimate: Option<f64>,
    /// The largest rounding to a 16-bit storage format.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rounding: Option<f64>,
    /// The largest difference found; `None` when nothing was checked.
    pub measured_max: Option<f64>,
    /// The root mean square of the differences found.
    pub measured_rms: Option<f64>,
    /// The number of texels that were compared.
    pub texels_checked: usize,
    /// The name of the values that texels were compared with, where that is not the f64 reference.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub against: Option<String>,
    /// The number of values below the normal range of half floats, where they lose relative precision.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub underflows: Option<usize>,
    /// The error of look-ups between the samples; `None` where that was not measured.
    pub interpolation: Option<InterpolationError>,
    /// The coordinates of the largest difference, axis by axis, with its channel and both values.
    pub worst: BTreeMap<String, f64>,
}

impl TableError {
    /// The error of a table of which nothing was compared yet.
    pub(crate) fn unmeasured(kind: ErrorKind, floor: Option<f64>, estimate: Option<f64>) -> Self {
        Self {
            kind,
            floor,
            estimate,
            rounding: None,
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

/// The largest differences between the texels of two tables, after one replaced values by the other's; 0 where there are
/// none.
pub(crate) struct Replacement {
    /// The largest difference of a texel that kept its value.
    pub kept: f64,
    /// The largest difference of a texel whose value was replaced.
    pub replaced: f64,
}

impl Values {
    /// The number of values.
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

    /// Drops the values and keeps their allocation.
    #[cfg(feature = "batch")]
    pub(crate) fn clear(&mut self) {
        match self {
            Self::F32(values) => values.clear(),
            Self::F64(values) => values.clear(),
        }
    }

    /// The value at an index, as f64, which holds both precisions.
    pub fn get(&self, k: usize) -> f64 {
        match self {
            Self::F32(values) => f64::from(values[k]),
            Self::F64(values) => values[k],
        }
    }

    /// All values, in order.
    pub fn iter(&self) -> impl Iterator<Item = f64> + Clone {
        (0..self.len()).map(|k| self.get(k))
    }

    /// Prints the value at an index in the fewest digits that tell it from its neighbours.
    pub fn show(&self, k: usize) -> String {
        match self {
            Self::F32(values) => values[k].to_string(),
            Self::F64(values) => values[k].to_string(),
        }
    }

    /// Replaces every texel, of `channels` values, that differs by more than `limit` from that of `other`.
    pub(crate) fn replace_beyond(&mut self, limit: f64, other: &Self, channels: usize) -> Replacement {
        let mut replacement = Replacement { kept: 0.0, replaced: 0.0 };
        for texel in 0..self.len() / channels {
            let range = texel * channels..(texel + 1) * channels;
            let difference = range.clone().map(|k| (self.get(k) - other.get(k)).abs()).fold(0.0, f64::max);
            if difference <= limit {
                replacement.kept = replacement.kept.max(difference);
                continue;
            }
            replacement.replaced = replacement.replaced.max(difference);
            match (&mut *self, other) {
                (Self::F32(to), Self::F32(from)) => to[range.clone()].copy_from_slice(&from[range]),
                (Self::F64(to), Self::F64(from)) => to[range.clone()].copy_from_slice(&from[range]),
                (Self::F32(to), Self::F64(from)) => range.for_each(|k| to[k] = from[k] as f32),
                (Self::F64(to), Self::F32(from)) => range.for_each(|k| to[k] = f64::from(from[k])),
            }
        }
        replacement
    }

    /// The values rounded to f32, to the nearest.
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

    /// The (width, height) of the image that holds the table: the last axis, and the product of the others.
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

    /// Refuses impossible values as [`check_sane`](Self::check_sane) does, among values that begin at `texel`.
    pub(crate) fn check_sane_from<T>(&self, texel: usize, values: &[T]) -> Result<()>
    where
        T: Copy + Into<f64>,
    {
        let channels = self.channels.len();
        let Some(index) = values.iter().position(|&value| !self.quantity.allows(value.into())) else {
            return Ok(());
        };
        Err(Error::Promise(format!(
            "table {}: {} at {}; {}",
            self.name,
            in_digits(values[index].into()),
            self.coordinates(texel + index / channels),
            self.quantity.allowed(),
        )))
    }

    /// Prints a texel's coordinates: "roughness = 0.5, mu = 1".
    pub fn coordinates(&self, texel: usize) -> String {
        let coordinates = self.axes.iter().zip(self.indices(texel));
        let words: Vec<_> = coordinates
            .map(|(axis, k)| format!("{} = {}", axis.variable().name(), axis.values()[k]))
            .collect();
        words.join(", ")
    }
}

/// A number in few characters: with an exponent where it has many zeros.
fn in_digits(value: f64) -> String {
    match value.abs() {
        x if x == 0.0 || (1e-3..1e6).contains(&x) || !x.is_finite() => value.to_string(),
        _ => format!("{value:e}"),
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
    fn tiny_numbers_have_an_exponent() {
        let printed = [-1.5e-30, 0.25, -3.0, 0.0, f64::NAN, 1e-4].map(in_digits);
        assert_eq!(printed, ["-1.5e-30", "0.25", "-3", "0", "NaN", "1e-4"]);
    }

    #[test]
    fn only_texels_that_differ_too_much_are_replaced() {
        let mut values = Values::F64(vec![1.0, 1.0, 2.0, 2.0, 3.0, 3.0]);
        let replacement = values.replace_beyond(0.1, &Values::F64(vec![1.0, 1.05, 2.0, 2.5, 3.0, 3.0]), 2);
        assert_eq!(values, Values::F64(vec![1.0, 1.0, 2.0, 2.5, 3.0, 3.0]));
        assert!((replacement.kept - 0.05).abs() < 1e-12 && (replacement.replaced - 0.5).abs() < 1e-12);
    }
}
