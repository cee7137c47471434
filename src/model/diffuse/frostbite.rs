//! Lagarde & de Rousiers 2014, *Moving Frostbite to Physically Based Rendering*, the listing of
//! `Fr_DisneyDiffuse`. Twin of `shaders/diffuse/frostbite.wgsl`.
//!
//! ```text
//! f = albedo/π · c (1 + (F90 − 1)(1 − μi)⁵)(1 + (F90 − 1)(1 − μe)⁵)
//! c = (1 − r) + r/1.51,   F90 = r (0.5 + 2 (ωi·ωm)²)
//! ```
//!
//! | parameter | range | unit | default | |
//! |---|---|---|---|---|
//! | `roughness` | [0, 1] | – | none | r, the notes' linearRoughness: as it is, not squared |
//! | `albedo` | [0, 1] | – | none | weighs A |
//!
//! At roughness 0 all is lost at grazing, on the way in and out. At 1 the normal is a third darker than
//! Lambert's, and edges lit from behind the viewer shine.
//!
//! Kept: finite, bounded (6.25/(1.51 π)), not negative, reciprocal to the bit. Broken: energy, at roughness
//! near 1 where ωi grazes: ρ_dh is up to 785/(504 · 1.51) = 1.0315.

use crate::base::precision::VALUE_F32;
use crate::model::diffuse::grazing;
use crate::model::diffuse::grazing::{cos2_d, scatter};
use crate::model::{Component, Integral, Model, Shape, part};
use std::f64::consts::FRAC_1_PI;

pub(crate) static MODEL: Model = Model {
    name: "frostbite",
    summary: "Disney's diffuse lobe renormalised for Frostbite: hardly any gain",
    source: "Lagarde & de Rousiers 2014, Fr_DisneyDiffuse",
    microfacet: None,
    components: &Component::DIFFUSE,
    shape: Some(Shape::ROUGHNESS),
    parameters: &[],
    derive: |_| {},
    rho_bound: 1.0315,
    parts: &[grazing::PART, part!("diffuse/frostbite")],
    value_f32: VALUE_F32,
    integral: Integral::Smooth(grazing::nodes),
    lobe: |p, a, s| {
        let f90 = s.alpha * (0.5 + 2.0 * cos2_d(p, a));
        let factor = FRAC_1_PI * (1.0 - s.alpha * (0.51 / 1.51));
        [factor * (scatter(p.mu_i, f90) * scatter(p.mu_e, f90)), 0.0]
    },
};
