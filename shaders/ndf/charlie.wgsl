// Charlie: Estevez & Kulla 2017, *Production Friendly Microfacet Sheen BRDF*, eq. 2 and section 3.

/// α below it is taken as this: see the Rust twin.
const ALPHA_LEAST: real = 0.005;

/// D(ωm), in units of NDF_UNIT sr⁻¹: (2 + 1/α) sin^(1/α) θm / 2π, with sin^(1/α) θm = exp(−ln(1 + cot²θm)/2α), as the
/// square of its root: D may leave f32's range where f, which divides it by μi μe, does not.
fn ndf(h: Half, hz2: real, alpha: real) -> real {
    let inverse = 1.0 / max(alpha, ALPHA_LEAST);
    let x = 0.25 * inverse * log1p_quotient(real4(hz2), real4(h.ht2)).x;
    let q = select(SCALE * sqrt(2.0 + inverse) * exp_neg(real4(x)).x, 0.0, h.ht2 == 0.0);
    return q * q;
}
const SCALE: real = 13072.540644194147; // 2¹⁵/√(2π)
const NDF_UNIT: real = 9.313225746154785e-10; // 2⁻³⁰

/// Λ's fit, eq. 3 and 4: L(x) = a/(1 + b x^c) + d x + e, of x and 1 − x.
fn charlie_fit(x: real4, rest: real4, t: real4) -> real4 {
    let power = select(exp_neg((0.19823 - 0.03022 * t) * log1p_quotient(rest, x)), real4(), x <= real4());
    let a = 21.5473 + 3.7772 * t;
    let b = 3.82987 - 0.50552 * t;
    return a / (1.0 + b * power) + ((0.70367 * t - 1.9776) * x - (4.32054 + 0.53913 * t));
}

/// (1 + 2Λ) μ, with Λ = exp(L(μ)) below μ = 1/2 and exp(2 L(1/2) − L(1 − μ)) above.
fn smith_roots(mu: real4, alpha: real4) -> real4 {
    let rough = 1.0 - max(alpha, real4(ALPHA_LEAST));
    let t = rough * rough;
    let rest = 1.0 - mu;
    let half = real4(0.5);
    let is_low = mu < half;
    let fit = charlie_fit(select(rest, mu, is_low), select(mu, rest, is_low), t);
    let exponent = select(2.0 * charlie_fit(half, half, t) - fit, fit, is_low);
    // a + e < 21: what exp_neg takes is ≥ 0.
    return mu + mu * (2.0 * EXP_21) * exp_neg(21.0 - exponent);
}
const EXP_21: real = 1318815734.4832146;
