// No masking: G2 = 1 above the horizon. f grows as 1/(μi μe) and ρ as 1/μ: both are unbounded at grazing.

/// G2 / (4 μi μe)
fn visibility(i: Toward, e: Toward) -> real {
    return 0.25 / (i.mu * e.mu);
}

/// G2 = 2 μe x / masking(x, y)
fn masking(x: real4, y: real4, e: Masked) -> real4 {
    return 2.0 * e.mu * x;
}

/// G2 of the mirror that α → 0 tends to.
fn mirror_masking(mu: real) -> real {
    return 1.0;
}

/// No more than that: it does not depend on ωm.
fn visibility_of_normal(share: real, p: Pair, h: Half) -> real {
    return share;
}
