//! Khronos, *KHR_materials_diffuse_roughness* (draft): the diffuse lobe of glTF 2.0, Appendix B.3.5, with V-cavities of
//! Lambertian facets in place of Lambert, whose model is Oren & Nayar 1994. Twin of `shaders/diffuse/gltf_oren_nayar.wgsl`.
//!
//! ```text
//! f = albedo (1 − Fc) (A + B max(0, cos(φi − φe)) sin α tan β)/π,   A, B, α and β as oren-nayar has them
//! Fc = (1 − ωi·ωm)⁵
//! ```
//!
//! | parameter | range | unit | default | |
//! |---|---|---|---|---|
//! | `roughness`, or `sigma` | [0, 1]; [0, π/2] | –; rad | none | σ = π/2 · roughness, as the text has it |
//! | `albedo` | [0, 1] | – | none | of a facet, weighs A |
//!
//! σ = 0 is `gltf_diffuse`. Kept: finite but where both directions graze on the same side, not negative, reciprocal to the
//! bit; energy: what oren-nayar gains where ωi grazes Fc takes.

use crate::base::half_angle::Half;
use crate::base::precision::VALUE_F32;
use crate::base::tolerance::decade;
use crate::model::diffuse::retro;
use crate::model::fresnel::schlick;
use crate::model::{Component, Integral, Model, Shape, part};
use std::f64::consts::FRAC_1_PI;

pub(crate) static MODEL: Model = Model {
    name: "gltf_oren_nayar",
    summary: "glTF's diffuse lobe of a rough surface: f = albedo (1 − Fc) times oren-nayar",
    source: "KHR_materials_diffuse_roughness (draft); Oren & Nayar 1994, qualitative model",
    microfacet: None,
    components: &Component::DIFFUSE,
    shape: Some(Shape::SIGMA),
    parameters: &[],
    derive: |_| {},
    rho_bound: 1.0,
    parts: &[schlick::PART, retro::PART, part!("diffuse/gltf_oren_nayar")],
    value_f32: VALUE_F32,
    integral: Integral::Kinked(nodes),
    lobe: |p, a, s| {
        let h = Half::new(p, a);
        let s2 = s.alpha * s.alpha;
        let (a_term, b_term) = (1.0 - 0.5 * s2 / (s2 + 0.33), 0.45 * s2 / (s2 + 0.09));
        let rough = FRAC_1_PI * (a_term + b_term * retro::retro(p, a));
        [schlick::fresnel(h.c, h.one_minus_c)[0] * rough, 0.0]
    },
};

/// Nodes in each panel of θe and of δφ for tolerances 1e-1 … 1e-10, measured (`nodes.rs`): the error of each
/// count alone, worst over θi and the roughness, is below a quarter of the tolerance.
fn nodes(tolerance: f64) -> [usize; 2] {
    const COUNTS: [[usize; 2]; 10] =
        [[3, 2], [3, 2], [4, 3], [5, 4], [6, 5], [8, 7], [11, 9], [14, 12], [19, 17], [25, 21]];
    COUNTS[decade(tolerance)]
}
