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
