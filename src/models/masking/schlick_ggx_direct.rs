//! Schlick's masking with k = (r + 1)²/8, r = √α, for lights: G1 = μ / (μ (1 − k) + k). Twin of
//! `shaders/masking/schlick_ggx_direct.wgsl`.
//!
//! It masks even a mirror: as α → 0, k → 1/8. It keeps energy and reciprocity.

use super::{Masking, more, schlick};
use crate::models::ndf::Ndf;
use crate::models::{SlopeCounts, Term, part};
use crate::reference;
use crate::setting::Setting;

pub(crate) struct SchlickGgxDirect;

impl Masking for SchlickGgxDirect {
    const TERM: Term = Term {
        name: "schlick-ggx-direct",
        summary: "Schlick's G with k = (r + 1)²/8, for lights",
        source: "Schlick 1994; Karis 2013, Real Shading in Unreal Engine 4",
        part: part!("masking/schlick_ggx_direct", "masking/schlick"),
    };
    const REFERENCE: &'static dyn reference::Masking = &reference::SchlickGgxDirect;

    fn counts(correlated: [SlopeCounts; 2], _tolerance: f64) -> [SlopeCounts; 2] {
        correlated.map(more)
    }

    fn visibility<N: Ndf>(mu_i: f64, mu_e: f64, s: &Setting) -> f64 {
        schlick::visibility(mu_i, mu_e, k(s.alpha))
    }

    fn masking<N: Ndf>(x: f64, y: f64, mu_e: f64, s: &Setting) -> f64 {
        schlick::masking([x, y], mu_e, k(s.alpha))
    }

    fn mirror(mu: f64) -> f64 {
        schlick::mirror(mu, k(0.0))
    }
}

fn k(alpha: f64) -> f64 {
    0.125 * (alpha.sqrt() + 1.0).powi(2)
}
