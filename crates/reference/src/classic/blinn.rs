//! Blinn's lobe.

use crate::Reference;
use crate::classic::Classic;
use crate::directions::Pair;
use std::f64::consts::PI;

/// (n + 2)(n + 4) / (8π (2^(−n/2) + n)) (n·h)ⁿ (Giesen 2009).
pub static BLINN: &dyn Reference = &Classic {
    value: |pair, alpha| {
        let n = exponent(alpha);
        [(n + 2.0) * (n + 4.0) / (8.0 * PI * ((-n / 2.0).exp2() + n)) * power(pair, n), 0.0]
    },
    // At a peak as narrow as that f is n/(8π) (n·h)ⁿ, and ∫ (n·h)ⁿ dωm = 2π/n; dωe = 4 μ dωm, and cos θe = μ.
    smooth: |mu| [mu * mu, 0.0],
};

/// n of α.
pub(super) fn exponent(alpha: f64) -> f64 {
    2.0 / (alpha * alpha) - 2.0
}

/// (n·h)ⁿ = (1 + tan²θm)^(−n/2), which keeps its digits at large n.
pub(super) fn power(pair: &Pair, n: f64) -> f64 {
    (-0.5 * n * pair.tan2_m.ln_1p()).exp()
}
