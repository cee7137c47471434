//! Schlick's approximation of Smith's masking, with the two k that Karis gives.

use crate::masking::{Facet, Masking};

/// Karis 2013, *Real Shading in Unreal Engine 4*: k = α/2 for image-based light.
pub(crate) struct SchlickGgx;

/// The same, for lights: k = (roughness + 1)²/8 with α = roughness².
pub(crate) struct SchlickGgxDirect;

impl Masking for SchlickGgx {
    fn g2(&self, facet: &Facet) -> f64 {
        g2(facet, |alpha| alpha / 2.0)
    }
}

impl Masking for SchlickGgxDirect {
    fn g2(&self, facet: &Facet) -> f64 {
        g2(facet, |alpha| (alpha.sqrt() + 1.0).powi(2) / 8.0)
    }
}

/// Schlick 1994: G(v) = n·v / (n·v (1 − k) + k) for each direction.
fn g2(facet: &Facet, k: impl Fn(f64) -> f64) -> f64 {
    let g1 = |at: usize| {
        let (mu, k) = (facet.mu[at], k(facet.alpha[at]));
        mu / (mu * (1.0 - k) + k)
    };
    g1(0) * g1(1)
}
