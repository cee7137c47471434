//! Incident light and the irradiance, exitant radiance and radiosity under it.
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
#[cfg(feature = "files")]
pub(crate) mod set;
mod sky;

pub use environment::{Clamped, Environment, MAX_TEXELS};
#[cfg(feature = "files")]
pub use read::{InvalidTexels, MapFile, read};
#[cfg(feature = "files")]
pub use set::{LightSource, SetDetails};
pub use sky::{Directional, Disk, Radiance, Sky};

/// Distant incident light: the same at every point of a surface.
#[derive(Debug, Clone, PartialEq)]
pub enum Light {
    /// The same radiance from all directions.
    Constant(Radiance),
    /// Light from one direction.
    Directional(Directional),
    /// A disk or a sphere of uniform radiance.
    Disk(Disk),
    /// A gradient from the zenith to the horizon, and a ground.
    Sky(Sky),
    /// An environment map.
    Map(Environment),
}

impl Light {
    /// Returns L from a direction of the world, a unit vector. A directional light has no radiance: 0.
    pub fn radiance(&self, direction: [f64; 3]) -> [f64; 3] {
        match self {
            Self::Constant(radiance) => radiance.rgb(),
            Self::Directional(_) => [0.0; 3],
            Self::Disk(disk) => disk.radiance_from(direction),
            Self::Sky(sky) => sky.radiance_from(direction),
            Self::Map(map) => map.radiance(direction),
        }
    }

    /// Describes the light in a few words.
    pub fn summary(&self) -> String {
        match self {
            Self::Constant(_) => "constant".into(),
            Self::Directional(_) => "directional".into(),
            Self::Disk(disk) => format!("disk of {:.4}° half angle", disk.radius().to_degrees()),
            Self::Sky(_) => "sky gradient".into(),
            Self::Map(map) => format!("map of {} × {}", map.width(), map.height()),
        }
    }
}

/// Returns the unit vector at (θ, φ), rad.
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
    /// Builds the frame of a normal n(θn, φn), rad: tangent along ∂n/∂θn, bitangent along ∂n/∂φn.
    pub fn new(theta: f64, phi: f64) -> Self {
        let ((st, ct), (sp, cp)) = (theta.sin_cos(), phi.sin_cos());
        Self { axes: [[ct * cp, ct * sp, -st], [-sp, cp, 0.0], [st * cp, st * sp, ct]] }
    }

    /// The normal.
    pub fn normal(&self) -> [f64; 3] {
        self.axes[2]
    }

    /// Transforms a vector from the world to this frame.
    pub fn to_local(&self, world: [f64; 3]) -> [f64; 3] {
        self.axes.map(|axis| dot(axis, world))
    }

    /// Transforms a vector from this frame to the world.
    pub fn to_world(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [t, b, n] = self.axes;
        std::array::from_fn(|k| x * t[k] + y * b[k] + z * n[k])
    }
}

/// Returns (θ, φ) of a vector; φ = 0 for the zenith.
pub(crate) fn angles([x, y, z]: [f64; 3]) -> (f64, f64) {
    (x.hypot(y).atan2(z), y.atan2(x))
}
