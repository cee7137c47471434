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
