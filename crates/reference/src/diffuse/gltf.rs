//! The diffuse lobe of glTF 2.0's metallic-roughness material.

use crate::directions::Pair;
use crate::fresnel::schlick;
use crate::setting::Setting;
use crate::{Angles, Reference, definition};
use std::f64::consts::FRAC_1_PI;

/// Khronos 2021, *glTF 2.0 Specification*, Appendix B.3.5 (`fresnel_mix`): Lambert's lobe under the light
/// that the specular one reflects: A = (1 − Fc)/π, B = Fc/π, Fc = (1 − ωi·ωm)⁵.
///
/// As Fc depends on the half vector this is not Lambert's BRDF, but A + B is.
pub static GLTF_DIFFUSE: &dyn Reference = &GltfDiffuse;

struct GltfDiffuse;

impl Reference for GltfDiffuse {
    fn brdf(&self, angles: &Angles, _: &Setting) -> Option<[f64; 2]> {
        Some(value(angles))
    }

    fn rho_dh(&self, mu: f64, setting: &Setting) -> [f64; 2] {
        definition::rho_dh(value, mu, setting)
    }
}

fn value(angles: &Angles) -> [f64; 2] {
    let pair = Pair::new(angles);
    schlick::weights(pair.cos_d, pair.one_minus_cos_d).map(|weight| weight * FRAC_1_PI)
}
