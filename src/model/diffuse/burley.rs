//! Burley 2012, *Physically-Based Shading at Disney*, section 5.3. Twin of `shaders/diffuse/burley.wgsl`.
//!
//! ```text
//! f = albedo/π · (1 + (F90 − 1)(1 − μi)⁵)(1 + (F90 − 1)(1 − μe)⁵),   F90 = 0.5 + 2 roughness (ωi·ωm)²
//! ```
//!
//! | parameter | range | unit | default | |
//! |---|---|---|---|---|
//! | `roughness` | [0, 1] | – | none | as it is, not squared |
//! | `albedo` | [0, 1] | – | none | baseColor, weighs A |
//!
//! At roughness 0 it is not Lambert: half of the light is lost on the way in at grazing, and half on the way
//! out, so that edges are dark. At 0.5 it is nearly Lambert, at 1 edges lit from behind the viewer shine.
//!
//! Kept: finite, bounded (6.25/π), not negative, reciprocal to the bit. Broken: energy. At roughness 1, ρ_dh
//! is 1.036 at the normal and 785/504 = 1.5575 where ωi grazes, the largest there is; from roughness 0.4 on
//! some is gained.

use crate::base::precision::VALUE_F32;
use crate::model::diffuse::grazing;
use crate::model::diffuse::grazing::{cos2_d, scatter};
use crate::model::{Component, Integral, Model, Shape, part};
use std::f64::consts::FRAC_2_SQRT_PI;

pub(crate) static MODEL: Model = Model {
    name: "burley",
    summary: "Disney's diffuse lobe: dark edges where smooth, bright ones where rough",
    source: "Burley 2012, section 5.3",
    microfacet: None,
    components: &Component::DIFFUSE,
    shape: Some(Shape::ROUGHNESS),
    parameters: &[],
    derive: |_| {},
    rho_bound: 1.5576,
    parts: &[grazing::PART, part!("diffuse/burley")],
    value_f32: VALUE_F32,
    integral: Integral::Smooth(grazing::nodes),
    lobe: |p, a, s| {
        let f90 = 0.5 + 2.0 * s.alpha * cos2_d(p, a);
        [(INV_SQRT_PI * scatter(p.mu_i, f90)) * (INV_SQRT_PI * scatter(p.mu_e, f90)), 0.0]
    },
};

/// 1/√π, once for each direction, as the shader has it.
const INV_SQRT_PI: f64 = 0.5 * FRAC_2_SQRT_PI;
