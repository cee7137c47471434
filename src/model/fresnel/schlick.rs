//! Schlick 1994, eq. 15, split by what multiplies F0 and F90. Twin of `shaders/fresnel/schlick.wgsl`.

use crate::model::fresnel::{Fresnel, FresnelCounts};
use crate::model::parameters::Setting;
use crate::model::{Component, Part, Term, part};

pub(crate) const PART: Part = part!("fresnel/schlick");

pub(crate) struct Schlick;

impl Fresnel for Schlick {
    const TERM: Term = Term {
        name: "schlick",
        summary: "Schlick: f = F0·A + F90·B",
        source: "Schlick 1994, eq. 15",
        part: PART,
    };
    const COUNTS: Option<FresnelCounts> = Some(FresnelCounts::SCHLICK);
    const POLYNOMIAL: bool = true;
    const COMPONENTS: &'static [Component] = &Component::schlick(0.04);

    fn fresnel(c: f64, x: f64, _s: &Setting) -> [f64; 2] {
        fresnel(c, x)
    }
}

/// (1 − Fc, Fc), Fc = x⁵, for c = ωi·ωm and x = 1 − c.
pub(crate) fn fresnel(c: f64, x: f64) -> [f64; 2] {
    let x2 = x * x;
    [c * (1.0 + x + x2 * (1.0 + x + x2)), x2 * x2 * x]
}
