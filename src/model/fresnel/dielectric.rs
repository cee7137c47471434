//! Fresnel's equations for a dielectric. Twin of `shaders/fresnel/dielectric.wgsl`.
//!
//! With c = ωi·ωm and g = √(η² − 1 + c²) (Walter et al. 2007, eq. 22; Cook & Torrance 1982, appendix):
//!
//! ```text
//! F = ½ (g − c)²/(g + c)² · (1 + (c (g + c) − 1)²/(c (g − c) + 1)²)
//! ```
//!
//! | parameter | range | unit | default | what it is |
//! |---|---|---|---|---|
//! | `eta` | [1, 1000] | | 1.5 | the index of what is below the surface over that of what is above |
//! | `specular` | [0, 1] | | 1 | what weighs F: 1 is the physics |
//!
//! Light comes from the thinner side, so that nothing is reflected totally. Unlike Schlick's, F is not linear in F0 =
//! ((η − 1)/(η + 1))²: every η is a basis of its own.
//!
//! Limits: η → 1 reflects nothing but at grazing, where F → 1 for every η > 1; η → ∞ is a perfect mirror. η = 1.5 has
//! F0 = 0.04 and a mean of 2 ∫ F μ dμ = 0.0918, Schlick with F0 = 0.04 one of 0.0857.
//!
//! Promises: all of a microfacet model's. F ≤ 1, so that it conserves energy.

use crate::model::fresnel::{Fresnel, FresnelCounts, exact};
use crate::model::parameters::{Parameters, Setting};
use crate::model::{Component, Parameter, SlopeCounts, Term, part};

pub(crate) struct Dielectric;

const ETA: usize = 4;

impl Fresnel for Dielectric {
    const TERM: Term = Term {
        name: "dielectric",
        summary: "exact Fresnel of a dielectric of index eta",
        source: "Fresnel's equations as in Walter et al. 2007, eq. 22",
        part: part!("fresnel/dielectric"),
    };
    const COMPONENTS: &'static [Component] = &Component::SPECULAR;
    const COUNTS: Option<FresnelCounts> = Some(FresnelCounts { near, ..FresnelCounts::SCHLICK });
    const PARAMETERS: &'static [Parameter] = &[Parameter {
        name: "eta",
        summary: "index of refraction, over that of the medium outside",
        unit: "",
        range: [1.0, 1e3],
        default: Some(1.5),
        place: ETA,
    }];

    /// η² − 1 in place of η, of which f32 would lose η − 1.
    fn derive(parameters: &mut Parameters) {
        parameters[ETA] = e(parameters[ETA]);
    }

    #[inline(never)]
    fn fresnel(c: f64, x: f64, s: &Setting) -> [f64; 2] {
        let e = e(s.parameters[ETA]);
        let g = (e + c * c).sqrt();
        let sum = (g + c).max(NO_SURFACE);
        let r = e / (sum * sum);
        let cg = c * g;
        let s2 = x * (1.0 + c);
        let q = (cg - s2) / (cg + s2);
        [0.5 * (r * r) * (1.0 + q * q), 0.0]
    }
}

fn near(schlick: SlopeCounts, s: &Setting, tolerance: f64) -> SlopeCounts {
    let e = e(s.parameters[ETA]);
    exact(schlick, [e, e + 2.0], tolerance)
}

/// η² − 1
fn e(eta: f64) -> f64 {
    (eta - 1.0) * (eta + 1.0)
}

/// Far below any g + c but that of η = 1 at c = 0, where 0/0 is 0.
const NO_SURFACE: f64 = 1e-18;
