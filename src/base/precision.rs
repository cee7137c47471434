//! The two arithmetics, and the errors that f32 makes in values and integrals.

/// The floating-point format that values are computed in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Precision {
    /// Single: 24 bits.
    F32,
    /// Double: 53 bits.
    F64,
}

impl std::fmt::Display for Precision {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.pad(self.name())
    }
}

impl Precision {
    /// `f32` or `f64`.
    pub fn name(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::F64 => "f64",
        }
    }

    /// The bytes of one number.
    pub(crate) fn bytes(self) -> usize {
        match self {
            Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

/// The relative error of values in f32, in units of 2⁻²⁴: half-angle terms, α and weights are rounded once each;
/// q of GGX's D takes 5 and is squared; G2/(4 μi μe) takes 6; Fc is the fifth power of what takes 4;
/// products take 4. The sum bounds the worst case, B of a lobe.
pub const VALUE_F32: f64 = 40.0 / (1 << 24) as f64;

/// The least tolerance that integrals in f32 meet: a sum of some hundred terms rounds by 5e-7, measured.
pub const INTEGRAL_F32: f64 = 1e-6;

/// The floor of relative errors, sr⁻¹: a value's error is divided by max(f, floor), as f32 runs out of exponent below.
pub const VALUE_FLOOR: f64 = 1e-30;

/// The relative error of f64 values stored as f32.
pub const STORED_F32: f64 = 1.0 / (1 << 24) as f64;
