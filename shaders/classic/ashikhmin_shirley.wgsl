// Ashikhmin & Shirley 2000, isotropic: f = (n + 1)/(8π) cosⁿθm / ((ωi·ωm) max(μi, μe)) F(ωi·ωm).

fn lobe(p: Pair, a: Azimuth, alpha: real, row: real) -> real2 {
    let h = half_vector(p, a);
    let root = root_of_power(h, p.hz2, alpha);
    return fresnel(h.c, h.one_minus_c) * ((row / h.c * root) * root);
}

/// With n + 1 = (2 − α²)/α², in units of 2⁶⁰.
fn lobe_row(p: Pair, alpha: real) -> real {
    let a2 = alpha * alpha;
    return 0.125 * UNIT * INV_PI * (2.0 - a2) / (a2 * max(p.mu_i, p.mu_e));
}
