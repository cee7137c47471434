//! Schlick's masking with k = α/2, for image-based light: G1 = μ / (μ (1 − k) + k). Twin of
//! `shaders/masking/schlick_ggx.wgsl`.
//!
//! No Smith: it masks up to 0.3 less than GGX's own at grazing, and a table of it belongs beside a shader of it alone.
//! It keeps energy and reciprocity.

use super::{Masking, more, schlick};
use crate::models::ndf::Ndf;
use crate::models::{SlopeCounts, Term, part};
use crate::reference;
use crate::setting::Setting;

pub(crate) struct SchlickGgx;

impl Masking for SchlickGgx {
    const TERM: Term = Term {
        name: "schlick-ggx",
        summary: "Schlick's G with k = α/2, for image-based light",
        source: "Schlick 1994; Karis 2013, Real Shading in Unreal Engine 4",
        part: part!("masking/schlick_ggx", "masking/schlick"),
    };
    const REFERENCE: &'static dyn reference::Masking = &reference::SchlickGgx;

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
    0.5 * alpha
}
