//! Distributions of microfacet normals.

pub(crate) mod beckmann;
pub(crate) mod blinn_phong;
pub(crate) mod charlie;
pub(crate) mod ggx;
pub(crate) mod gtr;
pub(crate) mod student_t;

use crate::measure::Measure;
use crate::setting::Parameters;

/// D(ωm) of a rough surface, isotropic.
pub(crate) trait Ndf: Sync {
    /// D, sr⁻¹, at α > 0; its projection ∫ D cos θm dωm is 1.
    fn d(&self, cos2_m: f64, tan2_m: f64, alpha: f64, parameters: &Parameters) -> f64;

    /// Smith's Λ of this distribution: projected hidden area over visible area, at tan² θ of a direction.
    fn lambda(&self, tan2: f64, alpha: f64, parameters: &Parameters) -> f64;

    /// The α of a roughness.
    fn measure(&self) -> Measure {
        Measure::ALPHA
    }

    /// Whether α → 0 is the ideal mirror.
    fn is_mirror_at_0(&self) -> bool {
        true
    }
}
