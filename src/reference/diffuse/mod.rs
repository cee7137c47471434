//! Diffuse lobes.

pub(super) mod gltf;
pub(super) mod lambert;
