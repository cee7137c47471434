// Burley 2012, section 5.6: separable Smith with GGX's Λ at α = 1/4, whatever α the normals have:
// G2 = G1(ωi) G1(ωe), G1 = 2μ / (μ + √(α² + (1 − α²) μ²)).

/// G2 / (4 μi μe)
fn visibility(i: Toward, e: Toward) -> real {
    return 1.0 / (clearcoat_below(i.mu) * clearcoat_below(e.mu));
}

fn clearcoat_below(mu: real) -> real {
    return mu + sqrt(0.0625 + 0.9375 * mu * mu);
}

/// G2 = 2 μe x / masking(x, y), for μi = μe x/y.
fn masking(x: real4, y: real4, e: Masked) -> real4 {
    let inverse_g1 = 0.5 * clearcoat_below(e.mu) / e.mu; // of ωe: no node changes it
    let mu = e.mu * x; // μi y
    return inverse_g1 * (mu + sqrt(fma(mu, 0.9375 * mu, 0.0625 * y * y)));
}

/// G2 of the mirror that α → 0 tends to.
fn mirror_masking(mu: real) -> real {
    let g1 = 2.0 * mu / clearcoat_below(mu);
    return g1 * g1;
}

/// No more than that: it does not depend on ωm.
fn visibility_of_normal(share: real, p: Pair, h: Half) -> real {
    return share;
}
