// GTR, generalised Trowbridge–Reitz: Burley 2012, *Physically-Based Shading at Disney*, appendix B.

/// D(ωm), in units of NDF_UNIT sr⁻¹: c / (α² cos²θm + sin²θm)^γ. From its peak, with nothing that cancels or leaves
/// f32: D = D₀ exp(−γ ln(1 + (1 − α²) sin²θm/α²)), D₀ = (1 − α²)/(π α² l) · g/(1 − e^(−g)), l = ln 1/α²,
/// g = (γ − 1) l: right at γ = 1 and at α = 1.
fn ndf(h: Half, hz2: real, alpha: real) -> real {
    let gamma = parameter(0u);
    let a2 = alpha * alpha;
    let flat = (1.0 - alpha) * (1.0 + alpha);
    let logs = log1p_quotient(real4(flat, flat * h.ht2, 0.0, 0.0), real4(a2, a2 * h.h2, 1.0, 1.0));
    let peak = select(flat / logs.x, 1.0, flat == 0.0) / mean_exp_neg((gamma - 1.0) * logs.x);
    let q = SCALE / alpha * sqrt(peak) * exp_neg(real4(0.5 * gamma * logs.y)).x;
    return q * q;
}
const SCALE: real = 18487.364273692878; // 2¹⁵/√π
const NDF_UNIT: real = 9.313225746154785e-10; // 2⁻³⁰

/// Smith's (1 + 2Λ) μ of GGX with the same α, which is these normals' own at γ = 2.
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
