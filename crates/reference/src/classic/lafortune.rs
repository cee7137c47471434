//! Lafortune's generalised cosine lobe, normalised, with Cx = Cy.

use crate::Reference;
use crate::classic::axis::{AboutAxis, Axis, cosine_lobe, exponent};
use crate::setting::{Parameters, Setting};

/// Lafortune et al. 1997, eq. 6: (Cx ux vx + Cy uy vy + Cz uz vz)ⁿ, times (n + 2)/(2π); Cx is `cxy` and Cz is `cz`.
pub static LAFORTUNE: &dyn Reference = &AboutAxis {
    value: |pair, s| {
        let n = exponent(s.alpha);
        let [cx, cz] = matrix(&s.parameters);
        let (mu, sin) = (pair.mu_i, pair.tan2_i.sqrt() * pair.mu_i);
        // In the frame of `Pair`, u = (−sin θi, 0, cos θi); v − Cu from v + u or v − u, whichever is nearer. Then
        // v·Cu = 1 − |v − Cu|²/2 − (1 − |Cu|²)/2.
        let x = if cx < 0.0 { pair.h.x + (1.0 + cx) * sin } else { pair.d.x - (1.0 - cx) * sin };
        let (y, z) = (pair.h.y, pair.d.z + (1.0 - cz) * mu);
        let rest = 0.5 * (x * x + y * y + z * z + lost(mu, sin, [cx, cz]));
        cosine_lobe(n, rest, cz * pair.mu_i * pair.mu_e - cx * pair.tangential_cos)
    },
    // |Cu|ⁿ times the lobe about it.
    axis: |mu, sin, s: &Setting| {
        let c = matrix(&s.parameters);
        let length = (c[0] * sin).hypot(c[1] * mu);
        let scale = match s.alpha {
            _ if length == 0.0 => 0.0,
            0.0 if lost(mu, sin, c) > 0.0 => 0.0,
            0.0 => 1.0,
            alpha => (0.5 * exponent(alpha) * (-lost(mu, sin, c)).ln_1p()).exp(),
        };
        Axis { sin: c[0].abs() * sin / length, cos: c[1] * mu / length, scale }
    },
};

fn matrix(p: &Parameters) -> [f64; 2] {
    [p.cxy, p.cz]
}

/// 1 − |Cu|²
fn lost(mu: f64, sin: f64, [cx, cz]: [f64; 2]) -> f64 {
    (1.0 - cx) * (1.0 + cx) * sin * sin + (1.0 - cz) * (1.0 + cz) * mu * mu
}
