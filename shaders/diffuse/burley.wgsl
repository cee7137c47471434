// Burley 2012, section 5.3: f = scatter(μi) scatter(μe)/π, F90 = 0.5 + 2 roughness cos² θd.

fn lobe(p: Pair, a: Azimuth, alpha: real, row: real) -> real2 {
    let f90 = 0.5 + 2.0 * alpha * cos2_d(p, a);
    return real2(INV_PI * (scatter(p.mu_i, f90) * scatter(p.mu_e, f90)), 0.0);
}

fn lobe_row(p: Pair, alpha: real) -> real {
    return 0.0;
}
