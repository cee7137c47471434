//! Ward 1992, *Measuring and Modeling Anisotropic Reflection*, isotropic, as published. Twin of
//! `shaders/classic/ward.wgsl`.
//!
//! ```text
//! f = specular · exp(−tan²θm/α²) / (4π α² √(μi μe))
//! ```
//!
//! | parameter | range | unit | default | |
//! |---|---|---|---|---|
//! | `roughness`, or `alpha` | [0, 1] | – | none | α = roughness², the root mean square slope times √2; 0 has no values |
//! | `specular` | [0, 1] | – | 1 | ρs, weighs A |
//!
//! A Gaussian of slopes, as Beckmann's, without cos⁴θm. α → 0 tends to a mirror that reflects μ. The diffuse part of the paper is the model `lambert` beside it.
//!
//! Kept: finite, not negative, reciprocal to the bit. Broken: energy. As the directions graze, ρ_dh grows as 1/√μ,
//! beyond any bound, so that it has no integrals here: Dür 2006, *An Improved Normalization for the Ward Reflectance
//! Model*, section 2. Its successor, `ward-dur`, has them.

use crate::base::half_angle::Half;
use crate::model::classic::gaussian::GAUSSIAN_F32;
use crate::model::{Component, Integral, Model, Shape, part};
use std::f64::consts::FRAC_1_PI;

pub(crate) static MODEL: Model = Model {
    name: "ward",
    summary: "Ward's Gaussian of slopes as published, unbounded at grazing",
    source: "Ward 1992, the isotropic model",
    microfacet: None,
    components: &Component::SPECULAR,
    shape: Some(Shape::ALPHA),
    parameters: &[],
    derive: |_| {},
    rho_bound: f64::INFINITY,
    parts: &[part!("classic/ward", "elementary")],
    value_f32: GAUSSIAN_F32,
    integral: Integral::Unbounded(
        "ρ of Ward's lobe grows as 1/√μ at grazing, beyond any bound, and no tolerance holds there",
    ),
    lobe: |p, a, s| {
        let h = Half::new(p, a);
        let row = 0.25 * FRAC_1_PI / (s.alpha * s.alpha * (p.mu_i * p.mu_e).sqrt());
        let root = (-0.5 * h.ht2 / (s.alpha * s.alpha * p.hz2)).exp();
        [row * root * root, 0.0]
    },
};
