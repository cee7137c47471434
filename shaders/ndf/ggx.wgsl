// GGX: Trowbridge & Reitz 1975; Walter et al. 2007, eq. 33.

/// D(ωm), in units of NDF_UNIT sr⁻¹: (α h² / (α² hz² + ht²))² / π, also right at hz = 0.
fn ndf(h: Half, hz2: real, alpha: real) -> real {
    let q = (INV_SQRT_PI * alpha) * h.h2 / (alpha * alpha * hz2 + h.ht2);
    return q * q;
}
const INV_SQRT_PI: real = 0.5641895835477563;
const NDF_UNIT: real = 1.0;

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

/// Beyond it, in units of α, the lobe holds 1e-18 of its weight; the maps' squares would overflow as α → 0.
const TAN_CAP: real = 1e9;
