// cosⁿθm, n = 2/α² − 2.

/// Its root: the power may leave f32's range where f does not. cos θm = (1 + tan²θm)^(−1/2), and n/2 = (1 − α²)/α².
fn root_of_power(h: Half, hz2: real, alpha: real) -> real {
    let n_half = (1.0 - alpha) * (1.0 + alpha) / (alpha * alpha);
    return exp_neg(0.5 * n_half * log1p_quotient(real4(h.ht2), real4(hz2))).x;
}
