// EON, Portsmouth, Kutz & Hill 2025: f = ρ f₁ + ρₘ (1 − Ei)(1 − Ee)/(π (1 − Ē)), f₁ Fujii's form, E its
// albedo, Ē their mean, ρₘ = ρ² Ē/(1 − ρ (1 − Ē)). With alpha = o = σ/(1 − σ), k₁ = 1/2 − 2/(3π), k₂ = 2/3 −
// 28/(15π), N = 1/(1 + (1 + k₁) o): 1 − E = N o (k₁ − G/π), Ē = N (1 + (1 + k₂) o), 1 − Ē = N o (k₁ − k₂): no
// difference of what is nearly equal.

const ONE_PLUS_K1: real = 1.2877934092108063;
const ONE_PLUS_K2: real = 1.072488212456924;
const K1_MINUS_K2: real = 0.21530519675388227;
const PI_MINUS_4_3: real = 1.8082593202564599;

fn lobe(p: Pair, a: Azimuth, alpha: real, row: real) -> real2 {
    let n = INV_PI / (1.0 + ONE_PLUS_K1 * alpha);
    return real2(parameter(0u) * n * (1.0 + alpha * one_plus_s_over_t(p, a)) + row, 0.0);
}

/// What is scattered more than once.
fn lobe_row(p: Pair, alpha: real) -> real {
    let rho = parameter(0u);
    let n = 1.0 / (1.0 + ONE_PLUS_K1 * alpha);
    let lost = n * alpha * K1_MINUS_K2; // 1 − Ē
    let mean = n * (1.0 + ONE_PLUS_K2 * alpha); // Ē
    let rho_m = rho * rho * mean / (1.0 - rho * lost);
    let scale = rho_m * n * alpha * (INV_PI * INV_PI * INV_PI / K1_MINUS_K2);
    return scale * (lost_at(p.mu_i) * lost_at(p.mu_e));
}

/// π k₁ − G(μ), G = S (θ − S μ) + 2/3 (S (1 − S³)/μ − S), S = sin θ. With y = tan(γ/2) = μ/(1 + S), γ = π/2 −
/// θ: (1 − S³)/μ = y (1 + S + S²), and what does not vanish with μ cancels in the formula, not in the
/// arithmetic.
fn lost_at(mu: real) -> real {
    let s = sqrt((1.0 - mu) * (1.0 + mu));
    let y = mu / (1.0 + s);
    let y2 = y * y;
    let gamma = 4.0 * arctangent(y / (1.0 + sqrt(1.0 + y2)));
    return PI_MINUS_4_3 * y2 / (1.0 + y2) + s * gamma + s * s * mu - (2.0 / 3.0) * s * y * (1.0 + s + s * s);
}

/// atan u on [0, tan(π/8)], to 7e-17 relative: interpolated at Chebyshev's nodes in u².
fn arctangent(u: real) -> real {
    let z = u * u;
    var p = real(0.02113537315769324);
    p = p * z - 0.04348052215716462;
    p = p * z + 0.0568834922680901;
    p = p * z - 0.06640233930429408;
    p = p * z + 0.07689953496306857;
    p = p * z - 0.09090773074808414;
    p = p * z + 0.11111106180455946;
    p = p * z - 0.14285714180976467;
    p = p * z + 0.1999999999885511;
    p = p * z - 0.3333333333332844;
    return u * (p * z + 1.0);
}
