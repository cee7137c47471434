//! The map of GGX's slopes for tolerances down to 1e-6. Twin of `shaders/ndf/ggx_coarse.wgsl`,
//! which has the derivation.

use crate::model::ndf::MappedSlope;
use crate::model::ndf::ggx::TAN_CAP;
use crate::model::{Part, part};

pub(crate) const PART: Part = part!("ndf/ggx_coarse");

/// r at which tan θm reaches `t_max`.
pub(crate) fn map_end(t_max: f64, alpha: f64) -> f64 {
    let sinh_v = (t_max / alpha).min(TAN_CAP);
    let cosh_2 = (0.5 + 0.5 * (1.0 + sinh_v * sinh_v).sqrt()).sqrt();
    0.5 * sinh_v / (cosh_2 * (1.0 + cosh_2))
}

pub(crate) fn map(r: f64, alpha: f64) -> MappedSlope {
    let r2 = r * r;
    let b = 1.0 - r2;
    let ra = r + r * r2;
    let s = 1.0 + r2 * (6.0 + r2);
    MappedSlope { p: 4.0 * alpha * ra, m: b * b, weight: 32.0 * ra * b / (s * s * s) }
}
