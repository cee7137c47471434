// Blinn's Phong as a distribution of normals: Walter et al. 2007, eq. 30.

/// D(ωm), in units of NDF_UNIT sr⁻¹: (p + 2)/2π cos^p θm, p = 2/α² − 2, with cos^p θm = exp(−p/2 ln(1 + tan²θm)), as
/// the square of its root: D may leave f32's range where f, which divides it by μi μe, does not.
fn ndf(h: Half, hz2: real, alpha: real) -> real {
    let exponent = (1.0 - alpha) * (1.0 + alpha) / (alpha * alpha); // p/2
    let x = 0.5 * exponent * log1p_quotient(real4(h.ht2), real4(hz2)).x;
    let q = SCALE / alpha * exp_neg(real4(x)).x;
    return q * q;
}
const SCALE: real = 18487.364273692878; // 2¹⁵/√π
const NDF_UNIT: real = 9.313225746154785e-10; // 2⁻³⁰

/// Smith's Λ of Beckmann with the same α, as Walter et al. take it: (1 + 2Λ) μ = μ erf a + α s e^(−a²)/√π,
/// a = μ/(α s).
fn smith_roots(mu: real4, alpha: real4) -> real4 {
    let scale = alpha * sqrt((1.0 - mu) * (1.0 + mu));
    // What is beyond the largest exponent is 0, also where s = 0.
    let a = mu / max(scale, 1e-3 * mu);
    let tail = exp_neg(a * a);
    return mu + tail * (0.5641895835477563 * scale - mu * erfcx(mu, scale));
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
