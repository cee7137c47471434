//! The quadrature rules of hemispherical integrals.

use std::fmt;

/// A quadrature rule of hemispherical integrals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// Each model's own map, which puts nodes where the lobe is, up to the exact horizon.
    Warped,
    /// Midpoints over (θ, φ), each times its cell's projected solid angle: the sum in the definition.
    Grid {
        /// Cells in θ ∈ [0, π/2].
        theta: usize,
        /// Cells in φ ∈ [0, 2π); even, as the two halves are alike.
        phi: usize,
    },
    /// Gauss–Legendre over the same (θ, φ).
    Gauss {
        /// Nodes in θ ∈ [0, π/2].
        theta: usize,
        /// Nodes in φ ∈ [0, 2π); even, as the two halves are alike.
        phi: usize,
    },
    /// Importance sampling of the distribution of normals by Hammersley's points, as most bakers do.
    Hammersley {
        /// Samples a texel: up to 1024, or a multiple of it.
        samples: usize,
    },
    /// Importance sampling of the visible normals by Hammersley's points.
    Vndf {
        /// Samples a texel: up to 1024, or a multiple of it.
        samples: usize,
    },
    /// Importance sampling of the visible normals at random, independently in each texel.
    Random {
        /// Samples a texel: up to 1024, or a multiple of it.
        samples: usize,
    },
}

impl Rule {
    /// The name in recipes and files.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Warped => "warped",
            Self::Grid { .. } => "grid",
            Self::Gauss { .. } => "gauss",
            Self::Hammersley { .. } => "hammersley",
            Self::Vndf { .. } => "vndf",
            Self::Random { .. } => "random",
        }
    }

    /// The samples of a texel, if the rule draws samples.
    pub(crate) fn samples(&self) -> Option<usize> {
        match *self {
            Self::Hammersley { samples } | Self::Vndf { samples } | Self::Random { samples } => Some(samples),
            Self::Warped | Self::Grid { .. } | Self::Gauss { .. } => None,
        }
    }

    /// The nodes in θ and φ, if the rule is a product of both.
    pub(crate) fn nodes(&self) -> Option<[usize; 2]> {
        match *self {
            Self::Grid { theta, phi } | Self::Gauss { theta, phi } => Some([theta, phi]),
            _ => None,
        }
    }
}

impl fmt::Display for Rule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Warped => f.write_str("warped"),
            Self::Grid { theta, phi } | Self::Gauss { theta, phi } => {
                write!(f, "{} {theta} θ × {phi} φ", self.name())
            }
            Self::Hammersley { samples } | Self::Vndf { samples } | Self::Random { samples } => {
                write!(f, "{}, {samples} samples", self.name())
            }
        }
    }
}

/// The finest grid rule: with more nodes in θ, the half-angle terms of no table fit. The device checks which loops its
/// driver runs.
pub(crate) const MAX_GRID: usize = 1 << 16;

/// The finest Gauss–Legendre rule: beyond it the host takes seconds to find the nodes.
pub(crate) const MAX_GAUSS: usize = 4096;

/// The largest number of samples: their draws take 32 MiB.
pub(crate) const MAX_SAMPLES: usize = 1 << 22;

/// The number of samples that one invocation sums. A driver may stop a loop at 65,535 turns and say nothing.
pub(crate) const CHUNK: usize = 1024;
