//! Incident light, and what comes of it: irradiance, exitant radiance, radiosity.
//!
//! # Conventions
//!
//! The world has z up: θ from +z and φ from +x towards +y, as everywhere here. A surface in it has a normal n(θn, φn),
//! and the tangent frame of a BRDF is (∂n/∂θn, ∂n/∂φn / sin θn, n); at θn = φn = 0 that is the world's own.
//!
//! Radiance is in W sr⁻¹ m⁻² for each of R, G and B, or in whatever unit the map has; irradiance and radiosity are
//! then in π sr of it, W m⁻².
//!
//! | quantity | | here |
//! |---|---|---|
//! | irradiance | E(n) = ∫ L(ωi) cos θi dωi | [`irradiance`] |
//! | its harmonics | nine coefficients of L or of E | [`harmonics`] |
//! | exitant radiance | Le(ωe) = ∫ f L cos θi dωi | [`exitant`] |
//! | radiosity | M = ∫ Le cos θe dωe = ∫ ρ_dh(ωi) L cos θi dωi | [`exitant`] |

pub mod bake;
mod device;
mod environment;
pub mod exitant;
pub mod harmonics;
pub mod irradiance;
#[cfg(feature = "files")]
mod read;
mod reference;
mod sky;

pub use environment::{Clamped, Environment, MAX_TEXELS};
#[cfg(feature = "files")]
pub use read::read;
pub use sky::{Disk, Sky};

use crate::base::error::Result;

/// Light that comes from everywhere else, far away: the same at every point of a surface.
#[derive(Debug, Clone, PartialEq)]
pub enum Light {
    /// The same radiance from everywhere.
    Constant([f64; 3]),
    /// From one direction, as of a star: a delta, so it has an irradiance and no radiance.
    Directional {
        /// Towards the light, unit.
        direction: [f64; 3],
        /// E of a surface that faces it, W m⁻².
        irradiance: [f64; 3],
    },
    /// A disk or a sphere of uniform radiance.
    Disk(Disk),
    /// A gradient from the zenith to the horizon, and a ground.
    Sky(Sky),
    /// An environment map.
    Map(Environment),
}

impl Light {
    /// L from a direction, unit, in the world; of a directional light 0, as it has none.
    pub fn radiance(&self, direction: [f64; 3]) -> [f64; 3] {
        match self {
            Self::Constant(radiance) => *radiance,
            Self::Directional { .. } => [0.0; 3],
            Self::Disk(disk) => disk.radiance_from(direction),
            Self::Sky(sky) => sky.radiance_from(direction),
            Self::Map(map) => map.radiance(direction),
        }
    }

    /// A few words for people.
    pub fn summary(&self) -> String {
        match self {
            Self::Constant(_) => "constant".into(),
            Self::Directional { .. } => "directional".into(),
            Self::Disk(disk) => format!("disk of {:.4}° half angle", disk.radius.to_degrees()),
            Self::Sky(_) => "sky gradient".into(),
            Self::Map(map) => format!("map of {} × {}", map.width(), map.height()),
        }
    }

    /// Refuses what is no light.
    ///
    /// # Errors
    /// When a radiance is negative or not finite, or a direction is not unit.
    pub fn check(&self) -> Result<()> {
        match self {
            Self::Constant(radiance) => sky::check_radiance("constant", radiance),
            Self::Directional { direction, irradiance } => {
                sky::check_direction(direction)?;
                sky::check_radiance("directional", irradiance)
            }
            Self::Disk(disk) => disk.check(),
            Self::Sky(sky) => sky.check(),
            Self::Map(_) => Ok(()),
        }
    }
}

/// The unit vector at (θ, φ), rad.
pub fn direction(theta: f64, phi: f64) -> [f64; 3] {
    let ((st, ct), (sp, cp)) = (theta.sin_cos(), phi.sin_cos());
    [st * cp, st * sp, ct]
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A surface's tangent frame in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Tangent, bitangent and normal, unit and perpendicular to each other.
    pub axes: [[f64; 3]; 3],
}

impl Frame {
    /// That of a normal n(θn, φn), rad: tangent along ∂n/∂θn, bitangent along ∂n/∂φn.
    pub fn new(theta: f64, phi: f64) -> Self {
        let ((st, ct), (sp, cp)) = (theta.sin_cos(), phi.sin_cos());
        Self { axes: [[ct * cp, ct * sp, -st], [-sp, cp, 0.0], [st * cp, st * sp, ct]] }
    }

    /// The normal.
    pub fn normal(&self) -> [f64; 3] {
        self.axes[2]
    }

    /// A vector of the world in this frame.
    pub fn to_local(&self, world: [f64; 3]) -> [f64; 3] {
        self.axes.map(|axis| dot(axis, world))
    }

    /// A vector of this frame in the world.
    pub fn to_world(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [t, b, n] = self.axes;
        std::array::from_fn(|k| x * t[k] + y * b[k] + z * n[k])
    }
}

/// (θ, φ) of a vector; of the zenith φ = 0.
pub(crate) fn angles([x, y, z]: [f64; 3]) -> (f64, f64) {
    (x.hypot(y).atan2(z), y.atan2(x))
}
