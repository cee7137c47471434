// Lagarde & de Rousiers 2014: Burley's lobe with F90 = roughness (0.5 + 2 cos² θd), times 1 … 1/1.51.

fn lobe(p: Pair, a: Azimuth, alpha: real, row: real) -> real2 {
    let f90 = alpha * (0.5 + 2.0 * cos2_d(p, a));
    return real2(row * (scatter(p.mu_i, f90) * scatter(p.mu_e, f90)), 0.0);
}

/// The factor that renormalises, over π.
fn lobe_row(p: Pair, alpha: real) -> real {
    return INV_PI * (1.0 - alpha * (0.51 / 1.51));
}
