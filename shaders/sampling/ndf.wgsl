// Directions in proportion to D cos θm.

fn facet(a: real4, b: real4, e: Masked, s: real, alpha: real4) -> Facet {
    return ndf_facet(a, b, e, s, alpha);
}

/// G2 (ωe·ωm) / (μ cos θm) = 2 μ z q / (m masking)
fn facet_weight(q: real4, m: real4, e: Masked) -> real4 {
    return 2.0 * e.mu * q / m;
}
