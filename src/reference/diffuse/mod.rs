//! Diffuse lobes.

pub(super) mod burley;
pub(super) mod frostbite;
pub(super) mod gltf;
pub(super) mod lambert;

