// What maskings ask of an NDF, by its `smith_roots`: (1 + 2Λ) μ.

fn smith_root(mu: real, alpha: real) -> real {
    return smith_roots(real4(mu), real4(alpha)).x;
}

/// What `smith_root_at` needs of the fixed direction.
struct Masked {
    mu: real,
    root: real4,  // (1 + 2Λ) μ
    a2: real4,    // α²
    alpha: real4,
}

fn masked(mu: real, alpha: real4) -> Masked {
    return Masked(mu, smith_roots(real4(mu), alpha), alpha * alpha, alpha);
}

/// y (1 + 2Λ) μi at μi = μe x/y.
fn smith_root_at(x: real4, y: real4, e: Masked) -> real4 {
    return y * smith_roots(clamp(e.mu * x / y, real4(), real4(1.0)), e.alpha);
}
