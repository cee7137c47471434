//! Fresnel reflectance.

pub(crate) mod schlick;
