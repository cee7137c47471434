//! The base that all other rooms use: errors, precision, angles, half-angle terms, quadrature.

pub mod angles;
pub(crate) mod cubature;
pub mod error;
pub mod half_angle;
pub mod precision;
pub mod quadrature;
pub mod radiometry;
pub(crate) mod sequence;
pub mod timings;
pub mod tolerance;
#[cfg(feature = "files")]
pub(crate) mod words;

/// Whether tests take all of their cases, as `scripts/test.sh --long` has them, rather than a few of each kind.
#[cfg(test)]
pub(crate) fn is_thorough() -> bool {
    std::env::var_os("GONIO_THOROUGH").is_some()
}
