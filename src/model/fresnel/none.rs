//! Perfect mirrors, F = 1, under a constant weight. Twin of `shaders/fresnel/none.wgsl`.

use crate::model::fresnel::{Fresnel, FresnelCounts};
use crate::model::parameters::Setting;
use crate::model::{Component, Term, part};

pub(crate) struct Constant;

impl Fresnel for Constant {
    const TERM: Term = Term {
        name: "none",
        summary: "F the same at every angle: f = F0·A",
        source: "F = 1 under the weight F0",
        part: part!("fresnel/none"),
    };
    // The name that this reflectance has in every other Fresnel term.
    const COUNTS: Option<FresnelCounts> = Some(FresnelCounts::SCHLICK);
    const POLYNOMIAL: bool = true;
    const COMPONENTS: &'static [Component] = &[Component { name: "A", weight: "f0", default: Some(1.0) }];

    fn fresnel(_c: f64, _x: f64, _s: &Setting) -> [f64; 2] {
        [1.0, 0.0]
    }
}
