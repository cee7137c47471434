// Ward 1992: f = exp(−tan²θm/α²) / (4π α² √(μi μe)).

/// The exponential as the square of its root, in units of 2⁻³⁰: it may leave f32's range where f does not, and so no
/// order in which a driver multiplies does.
fn lobe(p: Pair, a: Azimuth, alpha: real, row: real) -> real2 {
    let h = half_vector(p, a);
    let root = SCALE * exp_neg(real4(0.5 * h.ht2 / (alpha * alpha * p.hz2))).x;
    return real2((row * root) * root, 0.0);
}

/// In units of 2⁶⁰.
fn lobe_row(p: Pair, alpha: real) -> real {
    return 0.25 * UNIT * INV_PI / (alpha * alpha * sqrt(p.mu_i * p.mu_e));
}
const SCALE: real = 1073741824.0; // 2³⁰
const UNIT: real = 8.673617379884035e-19; // 2⁻⁶⁰
