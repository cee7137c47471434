// V-shaped grooves: Torrance & Sparrow 1967; Cook & Torrance 1982, section 4:
// G2 = min(1, 2 cos θm μi / (ωi·ωm), 2 cos θm μe / (ωi·ωm)).

/// Unmasked.
fn visibility(i: Toward, e: Toward) -> real {
    return 0.25 / (i.mu * e.mu);
}

/// G2 / (4 μi μe), with cos θm / (ωi·ωm) = hz/|h|².
fn visibility_of_normal(share: real, p: Pair, h: Half) -> real {
    return share * min(1.0, 2.0 * min(p.mu_i, p.mu_e) * sqrt(p.hz2) / h.h2);
}

/// G2 of the mirror that α → 0 tends to.
fn mirror_masking(mu: real) -> real {
    return 1.0;
}
