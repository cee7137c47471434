// A microfacet lobe: Torrance & Sparrow 1967; Walter et al. 2007, eq. 20: f = F D G2 / (4 μi μe).

fn lobe(p: Pair, a: Azimuth, alpha: real) -> real2 {
    let h = half_vector(p, a);
    return fresnel(h.c, h.one_minus_c) * (ndf(h, p.hz2, alpha) * visibility(p.mu_i, p.mu_e, alpha));
}

// ρ = ∫ f cos θi dωi over slopes of ωm about ωe, with φ the azimuth of ωm from that of ωe,
// t = tan θm, c = tan θe cos φ:
//     ρ = 1/2π ∫dφ ∫ F · G2 · (ωe·ωm)/(μe cos θm) · w dv,   (ωe·ωm)/(μe cos θm) = 1 + c t
// up to the horizon of ωi, t_max = c + √(c² + 1), where
//     cos θi = cos²θm μe (t_max − t)(t + 1/t_max)
// without cancellation. Four α share one azimuth; with t = p/m nothing is divided but once.

/// One azimuth of ωm: (c, t_max, 1/t_max, weight).
alias SlopeAzimuth = vec4<real>;

/// The integrand at r, times w dv/dr: without Fresnel, and its part that F90 weighs.
struct Slope {
    all: real4,
    grazing: real4,
}

fn slope_integrand(r: real4, azimuth: SlopeAzimuth, e: Masked, alpha: real4) -> Slope {
    let map = ndf_map(r, alpha);
    let projected = map.m + azimuth.x * map.p;
    let sec2 = map.m * map.m + map.p * map.p;
    let mu_i = e.mu * max((azimuth.y * map.m - map.p) * (map.p + azimuth.z * map.m), real4());
    let all = 2.0 * e.mu * mu_i * projected * map.weight / (masking(mu_i, sec2, e) * map.m * map.divisor);
    let c = min(e.mu * projected * inverseSqrt(sec2), real4(1.0));
    return Slope(all, all * fresnel_grazing(1.0 - c));
}

/// α → 0 at fixed μ: the ideal mirror's.
fn mirror_limit(mu_e: real) -> real2 {
    return fresnel(mu_e, 1.0 - mu_e);
}
