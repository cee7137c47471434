// Smith's masking-shadowing of GGX, height-correlated: Heitz 2014, eq. 99; in the form that has no
// tangent: 1 + 2Λ(ω) = √(α² + (1 − α²) μ²) / μ.

fn smith_root(mu: real, alpha: real) -> real {
    return sqrt(alpha * alpha + (1.0 - alpha * alpha) * mu * mu);
}

/// G2 / (4 μi μe)
fn visibility(mu_i: real, mu_e: real, alpha: real) -> real {
    return 0.5 / (mu_i * smith_root(mu_e, alpha) + mu_e * smith_root(mu_i, alpha));
}

/// What `masking` needs of the fixed direction.
struct Masked {
    mu: real,
    root: real4, // (1 + 2Λ) μ
    a2: real4,   // α²
    b2: real4,   // (1 − α²) μ²
}

fn masked(mu: real, alpha: real4) -> Masked {
    let a2 = alpha * alpha;
    let b2 = (1.0 - a2) * (mu * mu);
    return Masked(mu, sqrt(a2 + b2), a2, b2);
}

/// G2 = 2 μe x / masking(x, y), for μi = μe x/y: no division until the end.
fn masking(x: real4, y: real4, e: Masked) -> real4 {
    return fma(x, e.root, sqrt(fma(e.a2, y * y, e.b2 * (x * x))));
}
