//! Schlick's masking with k = α/2, for image-based light: G1 = μ / (μ (1 − k) + k). Twin of
//! `shaders/masking/schlick_ggx.wgsl`.
//!
//! No Smith: it masks up to 0.3 less than GGX's own at grazing, and a table of it belongs beside a shader of it alone.
//! It keeps energy and reciprocity.

use crate::model::masking::schlick::SchlickMasking;
use crate::model::{Term, part};

pub(crate) struct SchlickGgx;

impl SchlickMasking for SchlickGgx {
    const TERM: Term = Term {
        name: "schlick-ggx",
        summary: "Schlick's G with k = α/2, for image-based light",
        source: "SchlickMasking 1994; Karis 2013, Real Shading in Unreal Engine 4",
        part: part!("masking/schlick_ggx", "masking/schlick"),
    };
    const UNBOUNDED_OFF_PEAK: Option<&'static str> = Some(
        "without a peak ρ grows as α → 0 where k vanishes, beyond any bound, and no tolerance holds there",
    );

    fn k(alpha: f64) -> f64 {
        0.5 * alpha
    }
}
