// Burley 2012, disney.brdf: f = 1.25/π (scatter(μi) scatter(μe) (1/(μi + μe) − 1/2) + 1/2), F90 = roughness cos² θd.

fn lobe(p: Pair, a: Azimuth, alpha: real, row: real) -> real2 {
    let f90 = alpha * cos2_d(p, a);
    return real2((1.25 * INV_PI) * (scatter(p.mu_i, f90) * scatter(p.mu_e, f90) * row + 0.5), 0.0);
}

/// 1/(μi + μe) − 1/2 = (1 − m)/2m with the mean m of both: not negative.
fn lobe_row(p: Pair, alpha: real) -> real {
    let m = 0.5 * (p.mu_i + p.mu_e);
    return (1.0 - m) / (2.0 * m);
}
