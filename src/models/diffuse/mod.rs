//! Lobes as wide as the hemisphere.

pub(crate) mod burley;
pub(crate) mod frostbite;
pub(crate) mod gltf_diffuse;
mod grazing;
pub(crate) mod lambert;
