// Schlick 1994, eq. 15, split by what multiplies F0 and F90: F = F0 (1 − Fc) + F90 Fc.

/// (1 − Fc, Fc), Fc = x⁵, for c = ωi·ωm and x = 1 − c. By products, as pow loses fifty ulp here; and
/// 1 − x⁵ = c (1 + x + x² + x³ + x⁴), as the difference loses every digit where c is small.
fn fresnel(c: real, x: real) -> real2 {
    let x2 = x * x;
    return real2(c * (1.0 + x + x2 * (1.0 + x + x2)), x2 * x2 * x);
}

/// For integrals: A + B …
fn fresnel_whole(c: real4) -> real4 {
    return real4(1.0);
}

/// … and what of it is not A, which is B. Absolute error counts here.
fn fresnel_complement(c: real4) -> real4 {
    let x = 1.0 - c;
    let x2 = x * x;
    return x2 * x2 * x;
}
