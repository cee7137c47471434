// Beckmann: Beckmann & Spizzichino 1963, as Walter et al. 2007, eq. 25, have it.

/// D(ωm), in units of NDF_UNIT sr⁻¹: exp(−tan²θm/α²) / (π α² cos⁴θm), as the square of its root: D may leave f32's
/// range where f, which divides it by μi μe, does not.
fn ndf(h: Half, hz2: real, alpha: real) -> real {
    let x = h.ht2 / (alpha * alpha * hz2);
    let q = exp_neg(real4(0.5 * x)).x * (SCALE / alpha * (h.h2 / hz2));
    return q * q;
}
const SCALE: real = 605793952.5203682; // 2³⁰/√π
const NDF_UNIT: real = 8.673617379884035e-19; // 2⁻⁶⁰
