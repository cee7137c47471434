// Schlick 1994, eq. 15, with another exponent, as MaterialX's generalized_schlick: F = F0 (1 − xᵖ) + F90 xᵖ, x = 1 − c.

/// (1 − xᵖ, xᵖ) for c = ωi·ωm and x = 1 − c. With y = p ln 1/x = p ln(1 + c/x), which has its digits where c is small
/// and where x is, xᵖ = e^(−y) and 1 − xᵖ, of a small y by (1 − e^(−y))/y;
/// the former as a square, as the exponential ends where f32 does, which a narrow lobe makes large.
fn fresnel(c: real, x: real) -> real2 {
    let y = parameter(4u) * log1p_quotient(real4(c), real4(max(x, LEAST))).x;
    let root = exp_neg(real4(0.5 * y)).x;
    let power = root * root;
    return real2(select(1.0 - power, y * mean_exp_neg(y), y < 0.5), power);
}

/// For integrals: A + B …
fn fresnel_whole(c: real4) -> real4 {
    return real4(1.0);
}

/// … and what of it is not A, which is B. Absolute error counts here.
fn fresnel_complement(c: real4) -> real4 {
    return exp_neg(parameter(4u) * log1p_quotient(c, max(1.0 - c, real4(LEAST))));
}

/// No x is less, so that no quotient leaves f32: xᵖ is 0 there.
const LEAST: real = 1e-35;
