//! Storage: the format that values are rounded to, and what is refused rather than lost.

use crate::table::{ErrorKind, Values};
use half::f16;
use serde::Serialize;

/// The format of stored values. Rounding is to the nearest, ties to even.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Storage {
    /// 32-bit floats.
    #[default]
    F32,
    /// 64-bit floats; worth it where the arithmetic is f64 too.
    F64,
    /// 16-bit floats: 11 bits of precision from 2⁻¹⁴ to 65504.
    F16,
    /// 16-bit integers over [0, 1]: value = stored / 65535.
    Unorm16,
}

/// The rounded values, and the number of them that fell below the normal range of halves.
pub(crate) struct Stored {
    pub values: Values,
    pub underflows: usize,
    /// The bound on the rounding of the values, absolute or relative; of 16-bit formats the largest there is.
    pub rounding: f64,
}

impl Storage {
    /// All formats.
    pub const ALL: [Self; 4] = [Self::F32, Self::F64, Self::F16, Self::Unorm16];

    /// The name in recipes and manifests.
    pub fn name(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::F64 => "f64",
            Self::F16 => "f16",
            Self::Unorm16 => "unorm16",
        }
    }

    /// Bytes of one value.
    pub fn bytes(self) -> usize {
        match self {
            Self::F64 => 8,
            Self::F32 => 4,
            Self::F16 | Self::Unorm16 => 2,
        }
    }

    /// The bound on the rounding error of a value: absolute for values up to 1, or relative.
    pub fn rounding(self, kind: ErrorKind) -> f64 {
        match (self, kind) {
            (Self::F64, _) => f64::EPSILON / 2.0,
            (Self::F32, _) => f64::from(f32::EPSILON) / 2.0,
            // Half of the spacing: 2⁻¹¹ below 1, and up to 2⁻¹⁰ of the value itself.
            (Self::F16, ErrorKind::Absolute) => 1.0 / 4096.0,
            (Self::F16, ErrorKind::Relative) => 1.0 / 2048.0,
            (Self::Unorm16, ErrorKind::Absolute) => 0.5 / UNORM,
            // A value near 0 loses all of its digits.
            (Self::Unorm16, ErrorKind::Relative) => 1.0,
        }
    }

    /// The bound on the absolute rounding error of integrals up to `largest` in 16-bit formats; else 0, as the arithmetic's
    /// error is measured with rounding to f32.
    pub(crate) fn coarse_rounding(self, largest: f64) -> f64 {
        let rounding = self.rounding(ErrorKind::Absolute);
        match self {
            // The spacing of halves doubles at each power of two.
            Self::F16 if largest > 1.0 => rounding * 2f64.powf(largest.log2().floor() + 1.0),
            Self::F16 | Self::Unorm16 => rounding,
            Self::F32 | Self::F64 => 0.0,
        }
    }

    /// The value that a reader of the stored one gets; infinite or out of [0, 1] where it does not fit.
    pub fn round(self, value: f64) -> f64 {
        match self {
            Self::F64 => value,
            Self::F32 => f64::from(value as f32),
            Self::F16 => f16::from_f64(value).to_f64(),
            Self::Unorm16 => (value * UNORM).round_ties_even() / UNORM,
        }
    }

    /// Rounds the values. Values that do not fit are refused, with a reason: overflow of halves, values
    /// outside [0, 1] for unorm16, and underflow (a value that is not 0 below 2⁻¹⁴, where halves lose
    /// their precision) if errors are relative. If they are absolute, underflow costs at most 2⁻²⁵: it
    /// is counted, and measured with the rest.
    pub(crate) fn store(self, values: Values, kind: ErrorKind) -> Result<Stored, String> {
        let count = |test: &dyn Fn(f64) -> bool| values.iter().filter(|&value| test(value)).count();
        let refuse = |n: usize, what: &str| match n {
            0 => Ok(()),
            n => Err(format!("{n} of its {} values {what}; store it as f32", values.len())),
        };
        let mut underflows = 0;
        match self {
            Self::F32 | Self::F64 => {}
            Self::F16 => {
                let overflows = |value: f64| value.is_finite() && self.round(value).is_infinite();
                refuse(count(&overflows), "overflow half floats, which end at 65504")?;
                let normal = f16::MIN_POSITIVE.to_f64();
                underflows = count(&|value| value != 0.0 && self.round(value).abs() < normal);
                if kind == ErrorKind::Relative {
                    refuse(underflows, "underflow half floats, which lose precision below 2⁻¹⁴")?;
                }
            }
            Self::Unorm16 => {
                let outside = |value: f64| !(0.0..=1.0).contains(&self.round(value));
                refuse(count(&outside), "are outside [0, 1], which is all that unorm16 has")?;
            }
        }
        let mut rounding = if self.bytes() < Self::F32.bytes() { 0.0 } else { self.rounding(kind) };
        let values = match (self, values) {
            (Self::F64, values) => Values::F64(values.iter().collect()),
            (Self::F32, values) => Values::F32(values.to_f32().into_owned()),
            (_, values) => {
                let round = |value: f64| {
                    let stored = self.round(value);
                    let unit =
                        if kind == ErrorKind::Absolute { 1.0 } else { value.abs().max(f64::MIN_POSITIVE) };
                    rounding = f64::max(rounding, (stored - value).abs() / unit);
                    stored as f32
                };
                Values::F32(values.iter().map(round).collect())
            }
        };
        Ok(Stored { values, underflows, rounding })
    }
}

/// The largest stored integer of unorm16.
pub(crate) const UNORM: f64 = 65535.0;
