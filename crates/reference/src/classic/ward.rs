//! Ward's lobe as he published it.

use crate::Reference;
use crate::classic::Classic;
use std::f64::consts::PI;

/// Ward 1992, the isotropic model: exp(−tan²δ/α²) / (4π α² √(cos θi cos θr)), δ the angle of the half vector from the
/// normal.
pub static WARD: &dyn Reference = &Classic {
    value: |pair, alpha| {
        let exponential = (-pair.tan2_m / (alpha * alpha)).exp();
        [exponential / (pair.mu_i * pair.mu_e).sqrt() / (4.0 * PI * alpha * alpha), 0.0]
    },
    smooth: |mu| [mu, 0.0],
};
