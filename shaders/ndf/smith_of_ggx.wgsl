// What maskings ask of an NDF, of GGX's normals.

/// Smith's Λ of these normals (Heitz 2014, eq. 72), in the form that has no tangent:
/// (1 + 2Λ) μ = √(α² + (1 − α²) μ²).
fn smith_root(mu: real, alpha: real) -> real {
    return sqrt(alpha * alpha + (1.0 - alpha * alpha) * mu * mu);
}

/// What `smith_root_at` needs of the fixed direction.
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

/// y (1 + 2Λ) μi at μi = μe x/y: without a division.
fn smith_root_at(x: real4, y: real4, e: Masked) -> real4 {
    return sqrt(fma(e.a2, y * y, e.b2 * (x * x)));
}
