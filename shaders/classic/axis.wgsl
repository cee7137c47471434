// (n + 2)/(2π) cosⁿγ with γ from an axis that is not the normal, n = 2/α² − 1.

/// n + 2 = (2 + α²)/α²; in units of 2⁶⁰.
fn lobe_row(p: Pair, alpha: real) -> real {
    let a2 = alpha * alpha;
    return 0.5 * UNIT * INV_PI * (2.0 + a2) / a2;
}

/// cosⁿγ times `row`, of cos γ and its complement 1 − cos γ, each with its own digits; 0 behind the axis. As the square of
/// its root, in units of 2⁻³⁰: the power may leave f32's range where f does not, and so no order in which a driver
/// multiplies does.
fn power_about_axis(cosine: real, complement: real, alpha: real, row: real) -> real2 {
    let a2 = alpha * alpha;
    let n = (2.0 - a2) / a2;
    let ahead = max(cosine, 0.0);
    let root = SCALE * exp_neg(0.5 * n * log1p_quotient(real4(complement), real4(ahead))).x;
    return real2(select((row * root) * root, 0.0, cosine <= 0.0), 0.0);
}
const SCALE: real = 1073741824.0; // 2³⁰
const UNIT: real = 8.673617379884035e-19; // 2⁻⁶⁰
