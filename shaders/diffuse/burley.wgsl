// Burley 2012, section 5.3: f = scatter(μi) scatter(μe)/π, F90 = 0.5 + 2 roughness cos² θd.

/// 1/√π, once for each direction: drivers move a constant 1/π into one of the factors, and which one changes the
/// last bit.
const INV_SQRT_PI: real = 0.5641895835477563;

fn lobe(p: Pair, a: Azimuth, alpha: real, row: real) -> real2 {
    let f90 = 0.5 + 2.0 * alpha * cos2_d(p, a);
    return real2((INV_SQRT_PI * scatter(p.mu_i, f90)) * (INV_SQRT_PI * scatter(p.mu_e, f90)), 0.0);
}

fn lobe_row(p: Pair, alpha: real) -> real {
    return 0.0;
}
