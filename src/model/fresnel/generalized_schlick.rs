//! Schlick with another exponent, as MaterialX's generalized_schlick has it. Twin of
//! `shaders/fresnel/generalized_schlick.wgsl`.
//!
//! ```text
//! F = F0 (1 − xᵖ) + F90 xᵖ,  x = 1 − ωi·ωm
//! ```
//!
//! | parameter | range | unit | default | what it is |
//! |---|---|---|---|---|
//! | `exponent` | [2, 10] | | 5 | p, how late F rises |
//! | `f0` | [0, 1] | | 0.04 | what weighs component A: F at normal incidence |
//! | `f90` | [0, 1] | | 1 | what weighs component B: F at grazing |
//!
//! Where ωi and ωe agree F has x^p, x ~ δ²: below p = 2 it bends there so sharply that no rule converges in reason; from 10
//! on it is F0 up to 80°.
//!
//! Limits: p = 5 is Schlick; 2 ∫ F μ dμ = F0 + (F90 − F0) · 2/((p + 1)(p + 2)).
//!
//! Promises: all of a microfacet model's. A + B = 1, so that it conserves energy.

use crate::base::tolerance::is_fine;
use crate::model::fresnel::{Fresnel, FresnelCounts};
use crate::model::parameters::Setting;
use crate::model::{Component, Parameter, SlopeCounts, Term, part};

pub(crate) struct GeneralizedSchlick;

const EXPONENT: usize = 4;

impl Fresnel for GeneralizedSchlick {
    const TERM: Term = Term {
        name: "generalized-schlick",
        summary: "Schlick with another exponent, f = F0·A + F90·B",
        source: "Schlick 1994, eq. 15; MaterialX's generalized_schlick_bsdf",
        part: part!("fresnel/generalized_schlick", "elementary"),
    };
    const COMPONENTS: &'static [Component] = &Component::schlick(0.04);
    const VALUE_F32: f64 = EXPONENT_F32;
    const COUNTS: Option<FresnelCounts> =
        Some(FresnelCounts { near: more, far: more, ..FresnelCounts::SCHLICK });
    const PARAMETERS: &'static [Parameter] = &[Parameter {
        name: "exponent",
        summary: "how late F rises: 5 is Schlick's",
        unit: "",
        range: [2.0, 10.0],
        default: Some(5.0),
        place: EXPONENT,
    }];

    #[inline(never)]
    fn fresnel(c: f64, x: f64, s: &Setting) -> [f64; 2] {
        let y = s.parameters[EXPONENT] * (c / x).ln_1p();
        [-(-y).exp_m1(), (-y).exp()]
    }
}

/// In units of 2⁻²⁴: five roundings of x weigh p ≤ 10 in place of Schlick's 5; those of y = p ln 1/x weigh y, up to 69
/// where B is 2⁻¹⁰⁰ of the sum: four of the logarithm, two of p and its product; and three of the exponential,
/// twice.
const EXPONENT_F32: f64 = (25.0 + 6.0 * 69.0 + 6.0) / (1 << 24) as f64;

/// Of other exponents Schlick's counts leave 1.1 times a tolerance; of p that are not whole xᵖ is not analytic where ωi and
/// ωe agree, which counts below p = 3, beyond 1e-6.
fn more(schlick: SlopeCounts, s: &Setting, tolerance: f64) -> SlopeCounts {
    let p = s.parameters[EXPONENT];
    match is_fine(tolerance) {
        _ if p == 5.0 => schlick,
        true if p < 3.0 && p.fract() != 0.0 => schlick.more(2.5),
        _ => schlick.more(1.25),
    }
}
