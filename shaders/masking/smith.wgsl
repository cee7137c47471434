// Smith's masking-shadowing of GGX, height-correlated: Heitz 2014, eq. 99; in the form that has no
// tangent: 1 + 2Λ(ω) = √(α² + (1 − α²) μ²) / μ.

fn smith_root(mu: real, alpha: real) -> real {
    return sqrt(alpha * alpha + (1.0 - alpha * alpha) * mu * mu);
}

/// G2 / (4 μi μe)
fn visibility(mu_i: real, mu_e: real, alpha: real) -> real {
    return 0.5 / (mu_i * smith_root(mu_e, alpha) + mu_e * smith_root(mu_i, alpha));
}
