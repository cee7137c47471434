//! Phong's lobe, normalised.

use crate::Reference;
use crate::classic::axis::{AboutAxis, Axis, cosine_lobe, exponent};

/// Lafortune & Willems 1994: ks (n + 2)/(2π) cosⁿγ, γ from the mirror direction, at most π/2.
pub static PHONG: &dyn Reference = &AboutAxis {
    // The mirror direction R is (sin θi, 0, cos θi) in the frame of `Pair`, and ωe − R is (hx, hy, dz):
    // cos γ = 1 − |ωe − R|²/2.
    value: |pair, s| {
        let n = exponent(s.alpha);
        let versine = 0.5 * (pair.h.x * pair.h.x + pair.h.y * pair.h.y + pair.d.z * pair.d.z);
        cosine_lobe(n, versine, pair.mu_i * pair.mu_e + pair.tangential_cos)
    },
    axis: |cos, sin, _| Axis { sin, cos, scale: 1.0 },
};
