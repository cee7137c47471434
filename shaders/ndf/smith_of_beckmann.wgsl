// Smith's Λ of Beckmann's normals.

/// Walter et al. 2007, after eq. 25, exactly: with a = μ / (α s), s = sin θ,
/// (1 + 2Λ) μ = μ erf a + α s e^(−a²)/√π, and erf a = 1 − e^(−a²) erfcx a.
fn smith_roots(mu: real4, alpha: real4) -> real4 {
    let scale = alpha * sqrt((1.0 - mu) * (1.0 + mu));
    // What is beyond the largest exponent is 0, also where s = 0.
    let a = mu / max(scale, 1e-3 * mu);
    let tail = exp_neg(a * a);
    return mu + tail * (INV_SQRT_PI * scale - mu * erfcx(mu, scale));
}
const INV_SQRT_PI: real = 0.5641895835477563;
