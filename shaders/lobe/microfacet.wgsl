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
// without cancellation.

/// One azimuth of ωm: (c, t_max, 1/t_max, weight).
alias SlopeAzimuth = vec4<real>;

/// The integrand at r, times w dv/dr. `visibility` is G2/(4 μi μe).
fn slope_integrand(r: real, azimuth: SlopeAzimuth, mu_e: real, alpha: real) -> real2 {
    let map = ndf_map(r, alpha);
    let t = map.x;
    let cos2_m = 1.0 / (1.0 + t * t);
    let projected = 1.0 + azimuth.x * t;
    let mu_i = max(cos2_m * mu_e * (azimuth.y - t) * (t + azimuth.z), 0.0);
    let g2 = 4.0 * mu_i * mu_e * visibility(mu_i, mu_e, alpha);
    let c = min(mu_e * projected * sqrt(cos2_m), 1.0);
    return fresnel(c, 1.0 - c) * (g2 * projected * map.y);
}

/// α → 0 at fixed μ: the ideal mirror's.
fn mirror_limit(mu_e: real) -> real2 {
    return fresnel(mu_e, 1.0 - mu_e);
}
