// Blinn 1977, as a BRDF that reflects all at the normal: f = (n + 2)(n + 4) / (8π (n + 2^(−n/2))) cosⁿθm.

fn lobe(p: Pair, a: Azimuth, alpha: real, row: real) -> real2 {
    let root = root_of_power(half_vector(p, a), p.hz2, alpha);
    return real2((row * root) * root, 0.0);
}

/// With n = 2 (1 − α²)/α²: (1 + α²) / (2π α² (2 (1 − α²) + α² 2^(−n/2))), in units of 2⁶⁰.
fn lobe_row(p: Pair, alpha: real) -> real {
    let a2 = alpha * alpha;
    let rest = (1.0 - alpha) * (1.0 + alpha);
    let power = exp_neg(real4(0.6931471805599453 * rest / a2)).x;
    return 0.5 * UNIT * INV_PI * (1.0 + a2) / (a2 * fma(a2, power, 2.0 * rest));
}
