//! Schlick's masking for any k, twin of `shaders/masking/schlick.wgsl`: G1 = μ / (μ (1 − k) + k).

/// μ (1 − k) + k
fn below(mu: f64, k: f64) -> f64 {
    mu * (1.0 - k) + k
}

pub(super) fn visibility(mu_i: f64, mu_e: f64, k: f64) -> f64 {
    0.25 / (below(mu_i, k) * below(mu_e, k))
}

pub(super) fn masking([x, y]: [f64; 2], mu_e: f64, k: f64) -> f64 {
    2.0 / mu_e * below(mu_e, k) * (mu_e * (1.0 - k) * x + k * y)
}

pub(super) fn mirror(mu: f64, k: f64) -> f64 {
    (mu / below(mu, k)).powi(2)
}
