// Smith's masking-shadowing at correlated heights: Heitz 2014, eq. 99: G2 = 1 / (1 + Λ(ωi) + Λ(ωe)).

/// G2 / (4 μi μe)
fn visibility(i: Toward, e: Toward) -> real {
    return 0.5 / (i.mu * smith_root(e.mu, e.alpha) + e.mu * smith_root(i.mu, i.alpha));
}

/// G2 = 2 μe x / masking(x, y), for μi = μe x/y: no division until the end.
fn masking(x: real4, y: real4, e: Masked) -> real4 {
    return fma(x, e.root, smith_root_at(x, y, e));
}

/// G2 of the mirror that α → 0 tends to.
fn mirror_masking(mu: real) -> real {
    return 1.0;
}

/// No more than that: it does not depend on ωm.
fn visibility_of_normal(share: real, p: Pair, h: Half) -> real {
    return share;
}
