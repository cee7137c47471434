// Smith's masking and shadowing as if independent: Walter et al. 2007, eq. 23: G2 = G1(ωi) G1(ωe), with
// G1 = 1 / (1 + Λ) = 2μ / (μ + (1 + 2Λ) μ).

/// G2 / (4 μi μe)
fn visibility(i: Toward, e: Toward) -> real {
    return 1.0 / ((i.mu + smith_root(i.mu, i.alpha)) * (e.mu + smith_root(e.mu, e.alpha)));
}

/// G2 = 2 μe x / masking(x, y), for μi = μe x/y.
fn masking(x: real4, y: real4, e: Masked) -> real4 {
    let inverse_g1 = 0.5 + 0.5 * e.root / e.mu; // of ωe: no node changes it
    return inverse_g1 * fma(x, real4(e.mu), smith_root_at(x, y, e));
}

/// G2 of the mirror that α → 0 tends to.
fn mirror_masking(mu: real) -> real {
    return 1.0;
}

/// No more than that: it does not depend on ωm.
fn visibility_of_normal(share: real, p: Pair, h: Half) -> real {
    return share;
}
