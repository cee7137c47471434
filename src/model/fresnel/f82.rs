//! F82-tint: Schlick with the dip that metals have before grazing. Twin of `shaders/fresnel/f82.wgsl`.
//!
//! Lazányi & Szirmay-Kalos 2005 subtract a c (1 − c)⁶ from Schlick's F; Hoffman 2019 ("Fresnel Equations Considered
//! Harmful") chooses a by the reflectance at arccos 1/7 = 81.8°, where the subtrahend is largest; Kutz, Hašan &
//! Edmondson 2021 ("Novel aspects of the Adobe Standard Material") give that reflectance as a tint of Schlick's, as
//! do OpenPBR and MaterialX:
//!
//! ```text
//! F(c) = S(c) − (1 − f82) S(1/7) M(c),  S(c) = F0 + (F90 − F0)(1 − c)⁵,  M(c) = c (1 − c)⁶ / (1/7 · (6/7)⁶)
//! ```
//!
//! | parameter | range | unit | default | what it is |
//! |---|---|---|---|---|
//! | `f82` | [0.55, 1] | | 1 | F(1/7) over Schlick's, for R, G and B |
//! | `f0` | [0, 1] | | 0.8 | what weighs component A: F at normal incidence |
//! | `f90` | [0, 1] | | 1 | what weighs component B: F at grazing |
//!
//! F is linear in F0 and F90, which are weights, and not in all three: f82 is the parameter. Below 25/49 = 0.51 the
//! formula is negative for small F0, and renderers clamp it; no metal needs that (Cr, Fe and Ti have 0.74 to 0.8, Ag,
//! Al, Au and Cu 0.88 and above; over all η and k with η² + k² ≥ 1 and F0 > 0.1 it is 0.59 or more). At 0.55 both
//! components are still positive with digits to spare, so no clamp is needed and f stays linear in its weights. The
//! exponent is Schlick's 5: another one costs digits in f32 (`generalized-schlick`).
//!
//! Limits: f82 = 1 is Schlick. 2 ∫ F μ dμ = (20 F0 + F90)/21 − (1 − f82) S(1/7) / (126 · 1/7 · (6/7)⁶).
//!
//! Promises: all of a microfacet model's. A + B ≤ 1, so that it conserves energy.

use crate::model::fresnel::{Fresnel, FresnelCounts};
use crate::model::parameters::{Parameters, Setting};
use crate::model::{Component, Parameter, Term, part};

pub(crate) struct F82;

const TINT: usize = 4;
/// Where its shader finds 4 − q.
const FOUR: usize = 5;

impl Fresnel for F82 {
    const TERM: Term = Term {
        name: "f82",
        summary: "F82-tint: Schlick with a metal's dip before grazing, f = F0·A + F90·B",
        source: "Kutz, Hašan & Edmondson 2021; Hoffman 2019; Lazányi & Szirmay-Kalos 2005",
        part: part!("fresnel/f82"),
    };
    const COMPONENTS: &'static [Component] = &Component::schlick(0.8);
    /// The dip is of degree 7, where Schlick's is 5. Measured: without, 0.55 is off by 1.7 times 1e-6.
    const COUNTS: Option<FresnelCounts> = Some(FresnelCounts {
        near: |schlick, s, _| if s.parameters[TINT] < 1.0 { schlick.more(1.25) } else { schlick },
        ..FresnelCounts::SCHLICK
    });
    const PARAMETERS: &'static [Parameter] = &[Parameter {
        name: "f82",
        summary: "the reflectance at 81.8° over Schlick's",
        unit: "",
        range: [0.55, 1.0],
        default: Some(1.0),
        place: TINT,
    }];

    /// 5 − w in place of f82, and 4 − q: of a rounded w and q they would lose digits.
    fn derive(parameters: &mut Parameters) {
        [parameters[TINT], parameters[FOUR]] = dip(parameters[TINT]);
    }

    #[inline(never)]
    fn fresnel(c: f64, x: f64, s: &Setting) -> [f64; 2] {
        let [five, four] = dip(s.parameters[TINT]);
        let small = c.min(x);
        let large = 1.0 - small;
        let y = if c < x { large } else { small };
        let y2 = y * y;
        let a = c * (five * (y2 * y2 * y2) + c * (1.0 + y * (2.0 + y * (3.0 + y * (4.0 + 5.0 * (y + y2))))));
        let difference = large - small;
        [a, y2 * y2 * y * (difference * difference + four * small * large)]
    }
}

/// 5 − w and 4 − q, where A and B lose w c x⁶ and q c x⁶: w = (1 − f82)(1 − x̄⁵)/(c̄ x̄⁶) and q = (1 − f82)/(c̄ x̄), with
/// c̄ = 1/7 and x̄ = 6/7.
fn dip(tint: f64) -> [f64; 2] {
    let (c, x) = (1.0 / 7.0, 6.0_f64 / 7.0);
    [5.0 - (1.0 - tint) * (1.0 - x.powi(5)) / (c * x.powi(6)), 4.0 - (1.0 - tint) / (c * x)]
}
