// Ward 1992: f = exp(−tan²θm/α²) / (4π α² √(μi μe)).

/// The exponential as the square of its root: it may leave f32's range where f does not.
fn lobe(p: Pair, a: Azimuth, alpha: real, row: real) -> real2 {
    let h = half_vector(p, a);
    let root = exp_neg(real4(0.5 * h.ht2 / (alpha * alpha * p.hz2))).x;
    return real2((row * root) * root, 0.0);
}

fn lobe_row(p: Pair, alpha: real) -> real {
    return 0.25 * INV_PI / (alpha * alpha * sqrt(p.mu_i * p.mu_e));
}
