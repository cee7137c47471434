//! The diffuse lobe of glTF 2.0's metallic-roughness material on a rough surface.

use crate::diffuse::oren_nayar;
use crate::directions::Pair;
use crate::fresnel::schlick;
use crate::measure::Measure;
use crate::setting::Setting;
use crate::{Angles, Reference, definition};

/// Khronos, *KHR_materials_diffuse_roughness* (draft): `diffuse_brdf` of *glTF 2.0*, Appendix B, of V-cavities with Lambertian
/// facets whose slope angle has the standard deviation σ = π/2 · roughness; and what `fresnel_mix` leaves of it, 1 − Fc with
/// Fc = (1 − ωi·ωm)⁵.
pub static GLTF_OREN_NAYAR: &dyn Reference = &GltfOrenNayar;

struct GltfOrenNayar;

impl Reference for GltfOrenNayar {
    fn measure(&self) -> Measure {
        Measure::Sigma
    }

    fn brdf(&self, angles: &Angles, setting: &Setting) -> Option<[f64; 2]> {
        Some(value(angles, setting.alpha))
    }

    fn rho_dh(&self, mu: f64, setting: &Setting) -> [f64; 2] {
        definition::rho_dh_kinked(|angles| value(angles, setting.alpha), mu, setting)
    }
}

fn value(angles: &Angles, sigma: f64) -> [f64; 2] {
    let pair = Pair::new(angles);
    let [left, _] = schlick::weights(pair.cos_d, pair.one_minus_cos_d);
    oren_nayar::value(angles, sigma).map(|rough| left * rough)
}
