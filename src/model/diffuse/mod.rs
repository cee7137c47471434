//! Lobes as wide as the hemisphere.

pub(crate) mod burley;
pub(crate) mod disney_sheen;
pub(crate) mod disney_subsurface;
pub(crate) mod eon;
pub(crate) mod frostbite;
pub(crate) mod fujii;
pub(crate) mod gltf_diffuse;
pub(crate) mod gltf_oren_nayar;
mod grazing;
pub(crate) mod lambert;
#[cfg(test)]
mod nodes;
pub(crate) mod oren_nayar;
mod retro;
