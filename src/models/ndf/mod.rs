//! Distributions of microfacet normals.

pub(crate) mod ggx;
