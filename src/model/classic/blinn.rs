//! Blinn 1977, *Models of Light Reflection for Computer Synthesized Pictures*, his variant of Phong's highlight, as a
//! BRDF. Twin of `shaders/classic/blinn.wgsl`. Not to be taken for microfacets that are so distributed.
//!
//! ```text
//! f = specular · (n + 2)(n + 4) / (8π (n + 2^(−n/2))) cosⁿθm,   n = 2/α² − 2
//! ```
//!
//! | parameter | range | unit | default | |
//! |---|---|---|---|---|
//! | `roughness`, or `alpha` | [0, 1] | – | none | α = roughness²; n from ∞ down to 0; 0 has integrals alone |
//! | `specular` | [0, 1] | – | 1 | weighs A |
//!
//! The factor is the exact one: all is reflected at the normal (Giesen 2009, *Phong and Blinn-Phong normalization
//! factors*). The customary (n + 8)/(8π) (Akenine-Möller, Haines & Hoffman 2008, section 7.6) is up to some percent
//! more, and creates energy.
//!
//! At α = 1 it is Lambert. Highlights fade where light grazes: α → 0 tends to a mirror that reflects μ².
//!
//! Kept: finite, bounded, not negative, reciprocal to the bit; energy.

use crate::base::half_angle::Half;
use crate::model::classic::cosine;
use crate::model::classic::cosine::COSINE_F32;
use crate::model::directions::Map;
use crate::model::half_vector::Kinks;
use crate::model::{Component, Integral, Model, Shape, part};
use std::f64::consts::{LN_2, PI};

pub(crate) static MODEL: Model = Model {
    name: "blinn",
    summary: "Blinn's power of n·h, normalised at the normal; alpha 1 is Lambert",
    source: "Blinn 1977; normalised as by Giesen 2009",
    microfacet: None,
    components: &Component::SPECULAR,
    shape: Some(Shape::ALPHA),
    parameters: &[],
    derive: |_| {},
    rho_bound: 1.0,
    parts: &[cosine::PART, part!("classic/blinn")],
    value_f32: COSINE_F32,
    integral: Integral::Listed(Map {
        samples: |fixed, s, tolerance| cosine::samples(fixed, s, tolerance, Kinks::NONE),
        most: |_, tolerance| cosine::most(tolerance, &Kinks::NONE),
        mean: None,
        limit: |mu, s| (s.alpha == 0.0).then_some([mu * mu, 0.0]),
    }),
    lobe: |p, a, s| {
        let root = cosine::root_of_power(&Half::new(p, a), p.hz2, s);
        [scale(s.alpha) * root * root, 0.0]
    },
};

/// (n + 2)(n + 4) / (8π (n + 2^(−n/2))) = (1 + α²) / (2π α² (2 (1 − α²) + α² 2^(−n/2)))
fn scale(alpha: f64) -> f64 {
    let (a2, rest) = (alpha * alpha, (1.0 - alpha) * (1.0 + alpha));
    (1.0 + a2) / (2.0 * PI * a2 * (2.0 * rest + a2 * (-LN_2 * rest / a2).exp()))
}
