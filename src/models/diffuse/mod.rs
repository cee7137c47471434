//! Lobes as wide as the hemisphere.

pub(crate) mod gltf_diffuse;
pub(crate) mod lambert;
