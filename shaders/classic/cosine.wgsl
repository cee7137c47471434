// cosⁿθm, n = 2/α² − 2.

/// Its root, in units of 2⁻³⁰: the power may leave f32's range where f does not. The rest of f is in units of 2⁶⁰, so that
/// no order in which a driver multiplies leaves it either. cos θm = (1 + tan²θm)^(−1/2), and n/2 = (1 − α²)/α².
fn root_of_power(h: Half, hz2: real, alpha: real) -> real {
    let n_half = (1.0 - alpha) * (1.0 + alpha) / (alpha * alpha);
    return SCALE * exp_neg(0.5 * n_half * log1p_quotient(real4(h.ht2), real4(hz2))).x;
}
const SCALE: real = 1073741824.0; // 2³⁰
const UNIT: real = 8.673617379884035e-19; // 2⁻⁶⁰
