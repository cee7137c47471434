//! The classics: lobes of the half vector, or about an axis, that are no microfacet models.

pub(crate) mod ashikhmin_shirley;
pub(crate) mod ashikhmin_shirley_diffuse;
mod axis;
pub(crate) mod blinn;
mod cosine;
mod gaussian;
pub(crate) mod lafortune;
pub(crate) mod phong;
pub(crate) mod ward;
pub(crate) mod ward_dur;

pub(crate) use axis::FAINT as FAINT_ABOUT_AXIS;
