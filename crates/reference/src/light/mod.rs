//! What light does to a surface, in f64, by other ways than tables of it: irradiance along meridians, and everything else by
//! cells of directions that are quartered until quarters agree.
//!
//! The world has z up, θ from +z and φ from +x towards +y. Radiance L is in W sr⁻¹ m⁻², irradiance E in W m⁻², R, G and B.

mod albedo;
mod exitant;
mod frame;
mod harmonics;
mod irradiance;
mod map;
mod source;

pub use albedo::Albedo;
pub use exitant::{Incident, exitant, radiosity};
pub use frame::Frame;
pub use harmonics::{Harmonics, harmonics};
pub use irradiance::{Meridians, irradiance};
pub use map::Map;

use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Light from far away.
#[derive(Debug, Clone, Copy)]
pub enum Light<'a> {
    /// The same radiance from everywhere.
    Constant([f64; 3]),
    /// A delta of light from one direction.
    Directional {
        /// Towards the light, unit.
        direction: [f64; 3],
        /// E of a surface that faces it.
        irradiance: [f64; 3],
    },
    /// The same radiance from all directions within an angle of one.
    Disk(Disk),
    /// A gradient above the horizon, and a ground.
    Sky(Sky),
    /// An environment map.
    Map(Map<'a>),
}

/// A disk of light.
#[derive(Debug, Clone, Copy)]
pub struct Disk {
    /// Towards its middle, unit.
    pub direction: [f64; 3],
    /// Its half angle, rad.
    pub radius: f64,
    /// L.
    pub radiance: [f64; 3],
}

/// L = horizon + (zenith − horizon) cos θ above the horizon, and the ground's below.
#[derive(Debug, Clone, Copy)]
pub struct Sky {
    /// L at the zenith.
    pub zenith: [f64; 3],
    /// L at the horizon.
    pub horizon: [f64; 3],
    /// L from below.
    pub ground: [f64; 3],
}

/// One of a light's cells of directions.
#[derive(Debug, Clone, Copy)]
struct Cell {
    row: usize,
    column: usize,
    /// θ of its borders.
    theta: [f64; 2],
    /// φ of its borders.
    phi: [f64; 2],
}

/// How near to a border, rad, a direction is on either side of it: roundings of frames are 1e-15.
const BORDER: f64 = 1e-9;

impl Light<'_> {
    /// L from a direction of the world, unit; where it is on a border between two radiances, both of them. A
    /// directional light has none.
    pub fn radiances(&self, direction: [f64; 3]) -> Vec<[f64; 3]> {
        let [x, y, z] = direction;
        match self {
            Self::Constant(radiance) => vec![*radiance],
            Self::Directional { .. } => vec![[0.0; 3]],
            Self::Disk(disk) => {
                let away = DVec3::from(direction).angle_between(DVec3::from(disk.direction));
                // The arc cosine of a dot product is known to 1e-8.
                match away - disk.radius {
                    x if x > 1e-7 => vec![[0.0; 3]],
                    x if x < -1e-7 => vec![disk.radiance],
                    _ => vec![disk.radiance, [0.0; 3]],
                }
            }
            Self::Sky(sky) => {
                let above = std::array::from_fn(|c| sky.horizon[c] + (sky.zenith[c] - sky.horizon[c]) * z);
                match z {
                    z if z > BORDER => vec![above],
                    z if z < -BORDER => vec![sky.ground],
                    _ => vec![above, sky.ground],
                }
            }
            Self::Map(map) => map.radiances(x.hypot(y).atan2(z), y.atan2(x), BORDER),
        }
    }
}

/// Where A cos θ + B sin θ is largest: in (−π/2, 3π/2], so that what is above 0 in [0, π] is within a quarter turn of it.
fn peak_of(a: f64, b: f64) -> f64 {
    let peak = b.atan2(a);
    if peak < -FRAC_PI_2 { peak + TAU } else { peak }
}
