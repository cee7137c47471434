// What Schlick's masking is for either k.

/// G2 / (4 μi μe)
fn visibility(i: Toward, e: Toward) -> real {
    return 0.25 / (schlick_below(i) * schlick_below(e));
}

fn schlick_below(w: Toward) -> real {
    let k = schlick_k(w.alpha);
    return w.mu * (1.0 - k) + k;
}

/// G2 = 2 μe x / masking(x, y), for μi = μe x/y.
fn masking(x: real4, y: real4, e: Masked) -> real4 {
    let k = schlick_ks(e.a2);
    let rest = e.mu * (1.0 - k);
    return (2.0 / e.mu) * (rest + k) * fma(x, rest, k * y);
}

/// G2 of the mirror that α → 0 tends to.
fn mirror_masking(mu: real) -> real {
    let k = schlick_k(0.0);
    let g1 = mu / (mu * (1.0 - k) + k);
    return g1 * g1;
}

/// No more than that: it does not depend on ωm.
fn visibility_of_normal(share: real, p: Pair, h: Half) -> real {
    return share;
}
