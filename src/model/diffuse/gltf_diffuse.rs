//! The diffuse lobe of glTF 2.0 metallic-roughness. Twin of `shaders/diffuse/gltf_diffuse.wgsl`.

use crate::base::half_angle::Half;
use crate::base::precision::VALUE_F32;
use crate::base::tolerance::decade;
use crate::model::fresnel::schlick;
use crate::model::{Component, Integral, Model, part};
use std::f64::consts::FRAC_1_PI;

pub(crate) static MODEL: Model = Model {
    name: "gltf_diffuse",
    summary: "glTF's diffuse lobe: f = albedo (1 − Fc)/π with Fc of the half vector",
    source: "glTF 2.0 specification, Appendix B.3.5",
    microfacet: None,
    components: &Component::DIFFUSE,
    shape: None,
    parameters: &[],
    derive: |_| {},
    rho_bound: 1.0,
    parts: &[schlick::PART, part!("diffuse/gltf_diffuse")],
    value_f32: VALUE_F32,
    integral: Integral::Smooth(nodes),
    lobe: |p, a, _| {
        let h = Half::new(p, a);
        [schlick::fresnel(h.c, h.one_minus_c)[0] * FRAC_1_PI, 0.0]
    },
};

/// Nodes in θe and δφ for tolerances 1e-1 … 1e-10, measured: the error of each count alone, worst over
/// θi, is below a quarter of the tolerance.
fn nodes(tolerance: f64) -> [usize; 2] {
    const COUNTS: [[usize; 2]; 10] =
        [[3, 2], [3, 4], [4, 5], [5, 6], [6, 8], [8, 10], [12, 16], [16, 20], [20, 24], [24, 32]];
    COUNTS[decade(tolerance)]
}
