// Oren & Nayar 1994, the qualitative model: f = (A + B max(0, cos(φi − φe)) sin α tan β)/π, alpha being σ.

fn lobe(p: Pair, a: Azimuth, alpha: real, row: real) -> real2 {
    let s2 = alpha * alpha;
    let b = 0.45 * s2 / (s2 + 0.09);
    return real2(INV_PI * (row + b * retro(p, a)), 0.0);
}

/// A = 1 − 0.5 σ²/(σ² + 0.33), which is 1 at σ = 0 however a device divides.
fn lobe_row(p: Pair, alpha: real) -> real {
    let s2 = alpha * alpha;
    return 1.0 - 0.5 * s2 / (s2 + 0.33);
}
