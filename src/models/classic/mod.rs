//! The classics: lobes of the half vector that are no microfacet models.

pub(crate) mod ashikhmin_shirley;
pub(crate) mod ashikhmin_shirley_diffuse;
pub(crate) mod blinn;
mod cosine;
mod gaussian;
pub(crate) mod ward;
pub(crate) mod ward_dur;
