// Hammon 2017, *PBR Diffuse Lighting for GGX+Smith Microsurfaces*: correlated Smith of GGX's normals with
// (1 − α) μ + α in place of √(α² + (1 − α²) μ²): V = 1/2 / mix(2 μi μe, μi + μe, α).

/// G2 / (4 μi μe)
fn visibility(i: Toward, e: Toward) -> real {
    return 0.5 / (i.mu * hammon_root(e) + e.mu * hammon_root(i));
}

/// (1 − α) μ + α
fn hammon_root(w: Toward) -> real {
    return w.mu + w.alpha * (1.0 - w.mu);
}

/// G2 = 2 μe x / masking(x, y), for μi = μe x/y. Of α the NDF keeps the square.
fn masking(x: real4, y: real4, e: Masked) -> real4 {
    let alpha = sqrt(e.a2);
    return fma(x, e.mu + alpha * (1.0 - e.mu), e.mu * x + alpha * (y - e.mu * x));
}

/// G2 of the mirror that α → 0 tends to.
fn mirror_masking(mu: real) -> real {
    return 1.0;
}

/// No more than that: it does not depend on ωm.
fn visibility_of_normal(share: real, p: Pair, h: Half) -> real {
    return share;
}
