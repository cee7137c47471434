//! What Burley's principled BRDF mixes into its diffuse lobe for a surface that light enters, after Hanrahan & Krueger 1993:
//! Burley 2012, *Physically-Based Shading at Disney*; the formula is `ss` of BRDF Explorer's `disney.brdf`. Twin of
//! `shaders/diffuse/disney_subsurface.wgsl`.
//!
//! ```text
//! f = albedo · 1.25/π (Fss (1/(μi + μe) − 1/2) + 1/2)
//! Fss = (1 + (F90 − 1)(1 − μi)⁵)(1 + (F90 − 1)(1 − μe)⁵),   F90 = roughness (ωi·ωm)²
//! ```
//!
//! | parameter | range | unit | default | |
//! |---|---|---|---|---|
//! | `roughness` | [0, 1] | – | none | as it is, not squared |
//! | `albedo` | [0, 1] | – | none | baseColor, weighs A |
//!
//! A flat lobe: a full moon is nearly as bright at its rim as in its middle. At roughness 0 edges are darker.
//!
//! Kept: finite but where both directions graze, not negative, reciprocal. Broken: energy, which the 1.25 is to keep
//! roughly: ρ_dh at the normal is 0.75 to 0.76; at 60° it is 1.06 at roughness 0 and 1.10 at 1; where ωi grazes 0.63 and
//! 1.5126, the largest there is.

use crate::base::precision::VALUE_F32;
use crate::base::tolerance::decade;
use crate::model::diffuse::grazing;
use crate::model::diffuse::grazing::{cos2_d, scatter};
use crate::model::directions::{Fixed, Map, Sample};
use crate::model::panels::directions;
use crate::model::parameters::Setting;
use crate::model::{Component, Integral, Model, Shape, part};
use std::f64::consts::FRAC_1_PI;

pub(crate) static MODEL: Model = Model {
    name: "disney-subsurface",
    summary: "Disney's flat diffuse lobe of a surface that light enters",
    source: "Burley 2012; disney.brdf",
    microfacet: None,
    components: &Component::DIFFUSE,
    shape: Some(Shape::ROUGHNESS),
    parameters: &[],
    derive: |_| {},
    rho_bound: 1.5127,
    parts: &[grazing::PART, part!("diffuse/disney_subsurface")],
    value_f32: VALUE_F32,
    integral: Integral::Listed(Map {
        samples,
        most: |_, tolerance| most(tolerance),
        mean: None,
        limit: |_, _| None,
    }),
    lobe: |p, a, s| {
        let f90 = s.alpha * cos2_d(p, a);
        let m = 0.5 * (p.mu_i + p.mu_e);
        let flat = (1.0 - m) / (2.0 * m);
        [1.25 * FRAC_1_PI * (scatter(p.mu_i, f90) * scatter(p.mu_e, f90) * flat + 0.5), 0.0]
    },
};

/// 1/(μi + μe) turns at μe = μi.
fn samples(fixed: &Fixed, _: &Setting, tolerance: f64) -> Vec<Sample> {
    let more = if fixed.factored { 2 } else { 1 };
    directions(fixed, fixed.mu, &fixed.kinks, nodes(tolerance).map(|n| more * n), false)
}

fn most(tolerance: f64) -> usize {
    let [theta, steep, phi] = nodes(tolerance);
    (theta + steep) * phi
}

/// Nodes in θe up to 60°, in asinh(μe/μi) from there, and in δφ, for tolerances 1e-1 … 1e-10, measured apart from this code:
/// the error of each count alone, worst over μi ∈ [2⁻²⁴, 1] and the roughness, is below a fifth of the tolerance.
fn nodes(tolerance: f64) -> [usize; 3] {
    const COUNTS: [[usize; 3]; 10] = [
        [2, 6, 2],
        [3, 7, 3],
        [3, 9, 4],
        [4, 11, 5],
        [5, 12, 5],
        [6, 16, 6],
        [6, 17, 7],
        [7, 19, 7],
        [8, 21, 8],
        [9, 24, 8],
    ];
    COUNTS[decade(tolerance)]
}
