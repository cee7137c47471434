//! Ashikhmin & Shirley 2000, *An Anisotropic Phong BRDF Model*, its specular part with nu = nv = n. Twin of
//! `shaders/classic/ashikhmin_shirley.wgsl`. What the paper has below it is `ashikhmin-shirley-diffuse`.
//!
//! ```text
//! f = (n + 1)/(8π) · cosⁿθm / ((ωi·ωm) max(μi, μe)) · (f0 (1 − Fc) + f90 Fc),   Fc = (1 − ωi·ωm)⁵,   n = 2/α² − 2
//! ```
//!
//! | parameter | range | unit | default | |
//! |---|---|---|---|---|
//! | `roughness`, or `alpha` | [0, 1] | – | none | α = roughness²; n from ∞ down to 0; 0 has integrals alone |
//! | `f0` | [0, 1] | – | 0.04 | Rs, weighs A |
//! | `f90` | [0, 1] | – | 1 | weighs B; 1 in the paper |
//!
//! The normals are distributed as Blinn's, and the masking, μi μe/((ωi·ωm) max(μi, μe)), makes what they reflect at most
//! what meets them, ρ_dh ≤ ∫ D dωm = 1. α → 0 is the mirror.
//!
//! Kept: finite but where both directions graze, not negative, reciprocal to the bit; energy.

use crate::base::half_angle::Half;
use crate::model::classic::cosine;
use crate::model::classic::cosine::COSINE_F32;
use crate::model::directions::Map;
use crate::model::fresnel::schlick;
use crate::model::half_vector;
use crate::model::half_vector::Kinks;
use crate::model::{Component, Integral, Model, Shape, part};
use std::f64::consts::FRAC_1_PI;

pub(crate) static MODEL: Model = Model {
    name: "ashikhmin-shirley",
    summary: "Ashikhmin and Shirley's Phong with Schlick's Fresnel: f = F0·A + F90·B",
    source: "Ashikhmin & Shirley 2000, the specular term",
    microfacet: None,
    components: &Component::schlick(0.04),
    shape: Some(Shape::ALPHA),
    parameters: &[],
    derive: |_| {},
    rho_bound: 1.0,
    parts: &[schlick::PART, cosine::PART, part!("classic/ashikhmin_shirley")],
    value_f32: COSINE_F32,
    integral: Integral::Listed(Map {
        samples: |fixed, s, tolerance| cosine::samples(fixed, s, tolerance, Kinks::OF_EQUAL_COSINES),
        most: |_, tolerance| cosine::most(tolerance, &Kinks::OF_EQUAL_COSINES),
        mean: Some(half_vector::mean),
        limit: |mu, s| (s.alpha == 0.0).then(|| schlick::fresnel(mu, 1.0 - mu)),
    }),
    lobe: |p, a, s| {
        let h = Half::new(p, a);
        let root = cosine::root_of_power(&h, p.hz2, s);
        let a2 = s.alpha * s.alpha;
        let row = 0.125 * FRAC_1_PI * (2.0 - a2) / (a2 * p.mu_i.max(p.mu_e));
        schlick::fresnel(h.c, h.one_minus_c).map(|f| f * row * root * root / h.c)
    },
};
