//! Schlick's masking with k = (r + 1)²/8, r = √α, for lights: G1 = μ / (μ (1 − k) + k). Twin of
//! `shaders/masking/schlick_ggx_direct.wgsl`.
//!
//! It masks even a mirror: as α → 0, k → 1/8. It keeps energy and reciprocity.

use crate::model::masking::schlick::SchlickMasking;
use crate::model::{Term, part};

pub(crate) struct SchlickGgxDirect;

impl SchlickMasking for SchlickGgxDirect {
    const TERM: Term = Term {
        name: "schlick-ggx-direct",
        summary: "Schlick's G with k = (r + 1)²/8, for lights",
        source: "SchlickMasking 1994; Karis 2013, Real Shading in Unreal Engine 4",
        part: part!("masking/schlick_ggx_direct", "masking/schlick"),
    };

    fn k(alpha: f64) -> f64 {
        0.125 * (alpha.sqrt() + 1.0).powi(2)
    }
}
