//! Schlick 1994, eq. 15, split by what multiplies F0 and F90. Twin of `shaders/fresnel/schlick.wgsl`.

use crate::models::{Part, part};

pub(crate) const PART: Part = part!("fresnel/schlick");

/// (1 − Fc, Fc), Fc = x⁵, for c = ωi·ωm and x = 1 − c.
pub(crate) fn fresnel(c: f64, x: f64) -> [f64; 2] {
    let x2 = x * x;
    [c * (1.0 + x + x2 * (1.0 + x + x2)), x2 * x2 * x]
}
