//! Distributions of microfacet normals.

pub(crate) mod ggx;
pub(crate) mod ggx_coarse;
pub(crate) mod ggx_fine;
pub(crate) mod ggx_nodes;
pub(crate) mod ggx_samples;
