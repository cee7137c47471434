//! The map of GGX's slopes for tolerances below 1e-6. Twin of `shaders/ndf/ggx_fine.wgsl`,
//! which has the derivation.

use crate::model::ndf::MappedSlope;
use crate::model::{Part, part};

pub(crate) const PART: Part = part!("ndf/ggx_fine");

/// Where ωe grazes, (ωe·ωm)/μe lifts what is beyond the coarse map's cap of 1e9 to 1e-9 of ρ.
const CAP: f64 = 1e12;

/// r at which tan θm reaches `t_max`.
pub(crate) fn map_end(t_max: f64, alpha: f64) -> f64 {
    let sinh_v = (t_max / alpha).min(CAP);
    let cosh_2 = (0.5 + 0.5 * (1.0 + sinh_v * sinh_v).sqrt()).sqrt();
    let cosh_4 = (0.5 + 0.5 * cosh_2).sqrt();
    0.25 * sinh_v / (cosh_2 * cosh_4 * (1.0 + cosh_4))
}

pub(crate) fn map(r: f64, alpha: f64) -> MappedSlope {
    let r2 = r * r;
    let b = 1.0 - r2;
    let ra = r + r * r2;
    let s = 1.0 + r2 * (6.0 + r2);
    let cosh = s * s + 16.0 * ra * ra;
    MappedSlope { p: 8.0 * alpha * ra * s, m: b.powi(4), weight: 128.0 * ra * s * b.powi(3) / cosh.powi(3) }
}
