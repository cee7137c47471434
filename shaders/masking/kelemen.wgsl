// Kelemen & Szirmay-Kalos 2001: G2 = μi μe / (ωi·ωm)², of which f keeps 1 / |ωi + ωe|².

/// Nothing is shared by all azimuths.
fn visibility(i: Toward, e: Toward) -> real {
    return 0.25;
}

/// G2 / (4 μi μe)
fn visibility_of_normal(share: real, p: Pair, h: Half) -> real {
    return share / h.h2;
}

/// G2 of the mirror that α → 0 tends to.
fn mirror_masking(mu: real) -> real {
    return 1.0;
}
