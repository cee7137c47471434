//! Fresnel's equations for a conductor. Twin of `shaders/fresnel/conductor.wgsl`, which has the form that it takes.
//!
//! With n = η + ik, c = ωi·ωm and g = √(n² − 1 + c²), both n and g complex (Born & Wolf 1999, section 14.2):
//!
//! ```text
//! F = (|r_s|² + |r_p|²)/2,  r_s = (c − g)/(c + g),  r_p = (n²c − g)/(n²c + g)
//! ```
//!
//! | parameter | range | unit | default | what it is |
//! |---|---|---|---|---|
//! | `eta` | [0.01, 1000] | | 1 | the real part of the index, for R, G and B |
//! | `k` | [0, 100] | | 5 | the imaginary part, the extinction coefficient, for R, G and B |
//! | `metal` | see [`METALS`](crate::model::fresnel::metals::METALS) | | | a name that stands for both |
//! | `specular` | [0, 1] | | 1 | what weighs F: 1 is the physics |
//!
//! The index is that of the metal over that of what is outside. One with |n| < 1 and little extinction reflects
//! totally from an angle on where F has a vertical tangent: no arithmetic keeps its digits there and no rule of few
//! nodes converges, so η² + k² < 1 is refused. No metal has it where its colour is seen.
//!
//! Limits: k → 0 is the dielectric of η, k → ∞ a perfect mirror; at normal incidence
//! ((η − 1)² + k²)/((η + 1)² + k²). Past 70° F dips before it rises to 1 at grazing, by what f82 has a name for.
//!
//! Promises: all of a microfacet model's. F ≤ 1, so that it conserves energy.

use crate::model::fresnel::metals::METALS;
use crate::model::fresnel::{Fresnel, FresnelCounts, exact};
use crate::model::parameters::{Parameters, Setting};
use crate::model::{Component, Metal, Parameter, SlopeCounts, Term, part};

pub(crate) struct Conductor;

const ETA: usize = 4;
const K: usize = 5;

impl Fresnel for Conductor {
    const TERM: Term = Term {
        name: "conductor",
        summary: "exact Fresnel of a metal of index eta + ik",
        source: "Fresnel's equations as in Born & Wolf 1999, section 14.2",
        part: part!("fresnel/conductor"),
    };
    const COMPONENTS: &'static [Component] = &Component::SPECULAR;
    const PARAMETERS: &'static [Parameter] = &[
        Parameter {
            name: "eta",
            summary: "index of refraction, over that of the medium outside",
            unit: "",
            range: [0.01, 1e3],
            default: Some(1.0),
            place: ETA,
        },
        Parameter {
            name: "k",
            summary: "extinction coefficient, over the index of the medium outside; eta² + k² is at least 1",
            unit: "",
            range: [0.0, 100.0],
            default: Some(5.0),
            place: K,
        },
    ];

    const COUNTS: Option<FresnelCounts> = Some(FresnelCounts { near, ..FresnelCounts::SCHLICK });
    const METALS: &'static [Metal] = &METALS;

    /// (η + ik)² − 1 in place of η and k.
    fn derive(parameters: &mut Parameters) {
        [parameters[ETA], parameters[K]] = e(parameters[ETA], parameters[K]);
    }

    fn refused(parameters: &Parameters) -> Option<&'static str> {
        let (eta, k) = (parameters[ETA], parameters[K]);
        let thinner = eta * eta + k * k < 1.0;
        thinner.then_some(
            "eta² + k² < 1 reflects totally from an angle on, which no tolerance is kept at; give a larger k",
        )
    }

    #[inline(never)]
    fn fresnel(c: f64, x: f64, s: &Setting) -> [f64; 2] {
        let [e_re, e_im] = e(s.parameters[ETA], s.parameters[K]);
        let re = e_re + c * c;
        let g2 = (re * re + e_im * e_im).sqrt();
        let root = (0.5 * (g2 + re.abs())).sqrt();
        let re_g = if re < 0.0 { 0.5 * e_im / root.max(NO_SURFACE) } else { root };
        let sum = (g2 + c * (c + 2.0 * re_g)).max(NO_SURFACE);
        let s2 = x * (1.0 + c);
        let even = c * c * g2 + s2 * s2;
        let odd = 2.0 * c * s2 * re_g;
        let q = (even - odd) / (even + odd);
        [0.5 * ((e_re * e_re + e_im * e_im) / (sum * sum)) * (1.0 + q), 0.0]
    }
}

fn near(schlick: SlopeCounts, s: &Setting, tolerance: f64) -> SlopeCounts {
    let [re, im] = e(s.parameters[ETA], s.parameters[K]);
    exact(schlick, [re.hypot(im), (re + 2.0).hypot(im)], tolerance)
}

/// (η + ik)² − 1
fn e(eta: f64, k: f64) -> [f64; 2] {
    [(eta - 1.0) * (eta + 1.0) - k * k, 2.0 * eta * k]
}

/// Far below any |g + c|² but that of η = 1, k = 0 at c = 0, where 0/0 is 0.
const NO_SURFACE: f64 = 1e-18;
