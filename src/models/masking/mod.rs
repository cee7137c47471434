//! Masking and shadowing of microfacets.

pub(crate) mod smith;
