//! Distributions of microfacet normals.

pub(super) mod beckmann;
pub(super) mod blinn_phong;
pub(super) mod charlie;
pub(super) mod ggx;
pub(super) mod gtr;

use crate::model::parameters::Setting;

/// D(ωm) of a rough surface, isotropic.
pub(crate) trait Ndf: Sync {
    /// D, sr⁻¹, at α > 0; its projection ∫ D cos θm dωm is 1.
    fn d(&self, cos2_m: f64, tan2_m: f64, setting: &Setting) -> f64;

    /// Smith's Λ of this distribution: projected hidden area over visible area, at tan² θ of a direction.
    fn lambda(&self, tan2: f64, setting: &Setting) -> f64;

    /// Whether α → 0 is the ideal mirror.
    fn is_mirror_at_0(&self) -> bool {
        true
    }
}
