//! Smith's masking-shadowing of GGX, height-correlated: Heitz 2014, eq. 99. Twin of
//! `shaders/masking/smith.wgsl`.

use crate::models::{Part, part};

pub(crate) const PART: Part = part!("masking/smith");

/// G2 / (4 μi μe)
pub(crate) fn visibility(mu_i: f64, mu_e: f64, alpha: f64) -> f64 {
    0.5 / (mu_i * root(mu_e, alpha) + mu_e * root(mu_i, alpha))
}

/// (1 + 2Λ) μ
pub(crate) fn root(mu: f64, alpha: f64) -> f64 {
    (alpha * alpha + (1.0 - alpha * alpha) * mu * mu).sqrt()
}

/// G2 = 2 μe x / masking(x, y), for μi = μe x/y.
pub(crate) fn masking(x: f64, y: f64, mu_e: f64, alpha: f64) -> f64 {
    let (a2, b2) = (alpha * alpha, (1.0 - alpha * alpha) * mu_e * mu_e);
    x * root(mu_e, alpha) + (a2 * y * y + b2 * x * x).sqrt()
}
