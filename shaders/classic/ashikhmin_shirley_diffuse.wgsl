// Ashikhmin & Shirley 2000: f = 28/(23π) (1 − (1 − μi/2)⁵)(1 − (1 − μe/2)⁵).

fn lobe(p: Pair, a: Azimuth, alpha: real, row: real) -> real2 {
    return real2((ROOT * through(p.mu_i)) * (ROOT * through(p.mu_e)), 0.0);
}
const ROOT: real = 0.6225011546399677; // √(28/(23π)), once for each direction

fn lobe_row(p: Pair, alpha: real) -> real {
    return 0.0;
}

/// 1 − x⁵ with x = 1 − μ/2, as (1 − x)(1 + x + x² + x³ + x⁴): the difference loses its digits where μ is small.
fn through(mu: real) -> real {
    let x = 1.0 - 0.5 * mu;
    let x2 = x * x;
    return 0.5 * mu * (1.0 + x + x2 * (1.0 + x + x2));
}
