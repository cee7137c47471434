// Beckmann: Beckmann & Spizzichino 1963, as Walter et al. 2007, eq. 25, have it.

/// D(ωm), in units of NDF_UNIT sr⁻¹: exp(−tan²θm/α²) / (π α² cos⁴θm), as the square of its root: D may leave f32's
/// range where f, which divides it by μi μe, does not.
fn ndf(h: Half, hz2: real, alpha: real) -> real {
    let x = h.ht2 / (alpha * alpha * hz2);
    let q = exp_neg(real4(0.5 * x)).x * (SCALE / alpha * (h.h2 / hz2));
    return q * q;
}
const INV_SQRT_PI: real = 0.5641895835477563;
const SCALE: real = 605793952.5203682; // 2³⁰/√π
const NDF_UNIT: real = 8.673617379884035e-19; // 2⁻⁶⁰

/// Smith's Λ of these normals (Walter et al. 2007, after eq. 25, exactly): with a = μ / (α s), s = sin θ,
/// (1 + 2Λ) μ = μ erf a + α s e^(−a²)/√π, and erf a = 1 − e^(−a²) erfcx a.
fn smith_roots(mu: real4, alpha: real4) -> real4 {
    let scale = alpha * sqrt((1.0 - mu) * (1.0 + mu));
    // What is beyond the largest exponent is 0, also where s = 0.
    let a = mu / max(scale, 1e-3 * mu);
    let tail = exp_neg(a * a);
    return mu + tail * (INV_SQRT_PI * scale - mu * erfcx(mu, scale));
}

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
