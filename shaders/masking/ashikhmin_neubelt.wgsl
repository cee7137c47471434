// Neubelt & Pettineo 2013, after Ashikhmin & Premože 2007: f = D F / (4 (μi + μe − μi μe)).

/// G2 / (4 μi μe), by the smaller cosine first: either order is the same to the bit.
fn visibility(i: Toward, e: Toward) -> real {
    let small = min(i.mu, e.mu);
    let large = max(i.mu, e.mu);
    return 0.25 / (large + small * (1.0 - large));
}

/// G2 = 2 μe x / masking(x, y), for μi = μe x/y: G2 = μe x / (y + x (1 − μe)).
fn masking(x: real4, y: real4, e: Masked) -> real4 {
    return 2.0 * fma(x, real4(1.0 - e.mu), y);
}

/// G2 of the mirror that α → 0 tends to.
fn mirror_masking(mu: real) -> real {
    return mu / (2.0 - mu);
}

/// No more than that: it does not depend on ωm.
fn visibility_of_normal(share: real, p: Pair, h: Half) -> real {
    return share;
}
