// Fresnel's equations for a dielectric of index η ≥ 1, unpolarised. Walter et al. 2007, eq. 22, with
// e = η² − 1, g = √(e + c²), s² = 1 − c²:
//     F = (r_s² + r_p²)/2,  r_s = (c − g)/(c + g) = −e/(g + c)²,  r_p = r_s (cg − s²)/(cg + s²)
// g − c would lose every digit as η → 1, and η² − 1 of a rounded η too: the host makes e. What r_p cancels at
// Brewster's angle is small beside r_s.

/// (F, 0) for c = ωi·ωm and x = 1 − c.
fn fresnel(c: real, x: real) -> real2 {
    let e = parameter(4u); // in place of η
    let g = sqrt(e + c * c);
    let sum = max(g + c, NO_SURFACE);
    let r = e / (sum * sum);
    let cg = c * g;
    let s2 = x * (1.0 + c);
    let q = (cg - s2) / (cg + s2);
    return real2(0.5 * (r * r) * (1.0 + q * q), 0.0);
}

/// For integrals: F …
fn fresnel_whole(c: real4) -> real4 {
    let e = parameter(4u);
    let g = sqrt(e + c * c);
    let sum = max(g + c, real4(NO_SURFACE));
    let r = e / (sum * sum);
    let cg = c * g;
    let s2 = (1.0 - c) * (1.0 + c);
    let q = (cg - s2) / (cg + s2);
    return 0.5 * (r * r) * (1.0 + q * q);
}

/// … and what of it is not A: nothing.
fn fresnel_complement(c: real4) -> real4 {
    return real4();
}

/// Far below any g + c but that of η = 1 at c = 0, where 0/0 is 0; its square is a normal number.
const NO_SURFACE: real = 1e-18;
