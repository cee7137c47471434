//! Phong 1975, *Illumination for Computer Generated Pictures*, as a BRDF: Lafortune & Willems 1994, *Using the Modified
//! Phong Reflectance Model for Physically Based Rendering*, its specular part. Twin of `shaders/classic/phong.wgsl`.
//!
//! ```text
//! f = specular · (n + 2)/(2π) cosⁿγ,   γ from the mirror direction to ωe, 0 beyond 90°,   n = 2/α² − 1
//! ```
//!
//! | parameter | range | unit | default | |
//! |---|---|---|---|---|
//! | `roughness`, or `alpha` | [0, 1] | – | none | α = roughness², the lobe's width: f falls as exp(−γ²/α²); 0 has integrals alone |
//! | `specular` | [0, 1] | – | 1 | ks, weighs A |
//!
//! Of an exponent n, α = √(2/(n + 1)). α is the width about the mirror direction, where Blinn's is that of normals, which
//! turn half as far: his highlight of the same α is about twice as wide. n begins at 1: below, the lobe ends as a cliff at
//! γ = 90°.
//!
//! All is reflected at the normal, ρ_dh(0) = 1 for any n. As ωi leaves it, the lobe's cosine falls, and part of it is below
//! the horizon: with q and β as in [`axis`](crate::model::classic::axis),
//!
//! ```text
//! ρ_dh(θ) = C (cos θ ∫ cosⁿ⁺¹β dβ + sinⁿ⁺²θ/(n + 1)),   β ∈ [θ − π/2, π/2],   C = (n + 2)/(2π) ∫ (1 − w²)^((n+1)/2) dw
//! ```
//!
//! whose derivative, C sin θ (cos θ sinⁿθ/(n + 1) − ∫ cosⁿ⁺¹β dβ), is nowhere positive: no direction reflects more than all.
//! n = 1: 2/π (cos θ ((π − θ)/2 + sin 2θ/4) + sin³θ/2), which is 1/π where ωi grazes. α → 0 tends to a mirror that reflects
//! μ.
//!
//! Kept: finite, bounded, not negative, reciprocal to the bit; energy.

use crate::model::classic::axis;
use crate::model::classic::axis::{AXIS_F32, LobeAxis};
use crate::model::directions::Map;
use crate::model::half_vector;
use crate::model::{Component, Integral, Model, Shape, part};

pub(crate) static MODEL: Model = Model {
    name: "phong",
    summary: "Phong's power of the cosine to the mirror direction, normalised at the normal",
    source: "Phong 1975; Lafortune & Willems 1994, the specular term",
    microfacet: None,
    components: &Component::SPECULAR,
    shape: Some(Shape::ABOUT_AXIS),
    parameters: &[],
    derive: |_| {},
    rho_bound: 1.0,
    parts: &[axis::PART, part!("classic/phong")],
    value_f32: AXIS_F32,
    integral: Integral::Listed(Map {
        samples: |fixed, s, tolerance| axis::samples(fixed, &LobeAxis::MIRROR, s.alpha, tolerance),
        most: |_, tolerance| axis::most(tolerance),
        mean: Some(half_vector::mean),
        limit: |mu, s| axis::is_narrow(s).then_some([mu, 0.0]),
    }),
    lobe: |p, a, s| {
        let cosine = p.mu_i * p.mu_e + p.ss * (a.cos2 - a.sin2);
        axis::power(cosine, 2.0 * (p.sd + p.ss * a.sin2), s)
    },
};
