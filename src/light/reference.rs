//! Converts lights to those of the reference: the same numbers, without this crate's conventions.

use crate::base::error::{Error, Result};
use crate::light::Light;
use gonio_reference::light;

impl Light {
    /// Converts to the light of the reference, which looks maps up by code of its own.
    ///
    /// # Errors
    /// When the counts of a map do not fit, which [`Environment::new`](crate::light::Environment::new) refuses.
    pub fn to_reference(&self) -> Result<light::Light<'_>> {
        Ok(match self {
            Self::Constant(radiance) => light::Light::Constant(radiance.rgb()),
            Self::Directional(sun) => {
                light::Light::Directional { direction: sun.direction(), irradiance: sun.irradiance() }
            }
            Self::Disk(disk) => light::Light::Disk(light::Disk {
                direction: disk.direction(),
                radius: disk.radius(),
                radiance: disk.radiance(),
            }),
            Self::Sky(sky) => light::Light::Sky(light::Sky {
                zenith: sky.zenith(),
                horizon: sky.horizon(),
                ground: sky.ground(),
            }),
            Self::Map(map) => {
                let map = light::Map::new(map.width(), map.height(), map.texels(), map.rotation());
                light::Light::Map(map.ok_or_else(|| Error::Internal("a map's counts do not fit".into()))?)
            }
        })
    }
}
