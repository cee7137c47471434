//! Light as the reference takes it: the same numbers, and none of our conventions.

use crate::base::error::{Error, Result};
use crate::light::{Disk, Light, Sky};
use gonio_reference::light;

impl Light {
    /// This light for the reference, which has its own reading of maps.
    ///
    /// # Errors
    /// When the counts of a map do not fit, which [`Environment::new`](crate::light::Environment::new) refuses.
    pub fn to_reference(&self) -> Result<light::Light<'_>> {
        Ok(match self {
            Self::Constant(radiance) => light::Light::Constant(*radiance),
            &Self::Directional { direction, irradiance } => {
                light::Light::Directional { direction, irradiance }
            }
            &Self::Disk(Disk { direction, radius, radiance }) => {
                light::Light::Disk(light::Disk { direction, radius, radiance })
            }
            &Self::Sky(Sky { zenith, horizon, ground }) => {
                light::Light::Sky(light::Sky { zenith, horizon, ground })
            }
            Self::Map(map) => {
                let map = light::Map::new(map.width(), map.height(), map.texels(), map.rotation());
                light::Light::Map(map.ok_or_else(|| Error::Internal("a map's counts do not fit".into()))?)
            }
        })
    }
}
