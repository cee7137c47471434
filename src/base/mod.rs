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
