// A microfacet lobe of unequal α: the tangent plane is stretched by √(αy/αx) and its inverse, and D is then that of
// the equal α = √(αx αy) (Heitz 2014, eq. 86 and 88); towards a direction of azimuth φ masking sees
// √(αx² cos²φ + αy² sin²φ) (eq. 80).

fn lobe(p: Pair, a: Azimuth, alpha: real, row: real) -> real2 {
    let axes = axes_of(alpha);
    let h = half_vector(p, a);
    // Of h the tangential part.
    let x = p.st * a.cp + p.dt * a.cm;
    let y = p.st * a.sp + p.dt * a.sm;
    let stretched = Half(x * x * (axes.y / axes.x) + y * y * (axes.x / axes.y), h.h2, h.c, h.one_minus_c);
    let d = ndf(stretched, p.hz2, sqrt(axes.x * axes.y));
    let i = Toward(p.mu_i, length(axes * real2(a.cp + a.cm, a.sp + a.sm)));
    let e = Toward(p.mu_e, length(axes * real2(a.cp - a.cm, a.sp - a.sm)));
    let share = visibility(i, e) * NDF_UNIT;
    return fresnel(h.c, h.one_minus_c) * (d * visibility_of_normal(share, p, h));
}

/// Nothing is shared by all azimuths.
fn lobe_row(p: Pair, alpha: real) -> real {
    return 0.0;
}

/// (αx, αy) of α: the host has √aspect and its inverse, and strength².
fn axes_of(least: real) -> real2 {
    let alpha = select(least, max(least, 1e-6), parameter(1u) > 0.0);
    let x = alpha * parameter(0u);
    return real2(x + (1.0 - x) * parameter(1u), alpha * parameter(2u));
}
