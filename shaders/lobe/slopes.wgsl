// ρ = ∫ f cos θi dωi over slopes of ωm about ωe, with φ the azimuth of ωm from that of ωe,
// t = tan θm, c = tan θe cos φ:
//     ρ = 1/2π ∫dφ ∫ F · G2 · (ωe·ωm)/(μe cos θm) · w dv,   (ωe·ωm)/(μe cos θm) = 1 + c t
// up to the horizon of ωi, t_max = c + √(c² + 1), where
//     cos θi = cos²θm μe (t_max − t)(t + 1/t_max)
// without cancellation. Four α share one azimuth; with t = p/m nothing is divided but once, and the
// factors that no node changes are left to the end.

/// One azimuth of ωm: (μe c, t_max, 1/t_max, weight).
alias SlopeAzimuth = vec4<real>;

/// What a map makes of r: tan θm = p/m, and w dv/dr / m = NDF_MAP_WEIGHT weight/divisor.
struct Map {
    p: real4,
    m: real4,
    weight: real4,
    divisor: real4,
}

/// The integrand at r, times w dv/dr and a node's weight: of A + B, and what of that is not A. Both over
/// 2 NDF_MAP_WEIGHT.
struct Slope {
    all: real4,
    grazing: real4,
}

fn slope_term(r: real4, weight: real, azimuth: SlopeAzimuth, e: Masked, tan_scale: real4) -> Slope {
    let map = ndf_map(r, tan_scale);
    let projected = fma(real4(azimuth.x), map.p, e.mu * map.m); // ωe·ωm √y
    let y = fma(map.m, map.m, map.p * map.p);
    let x = fma(real4(azimuth.y), map.m, -map.p) * fma(real4(azimuth.z), map.m, map.p); // cos θi = μe x/y
    let root = sqrt(y);
    let below = masking(x, y, e) * map.divisor;
    let inverse = 1.0 / (root * below);
    let all = x * projected * (map.weight * weight) * (root * inverse);
    let c = clamp(projected * (below * inverse), real4(), real4(1.0));
    return Slope(all * fresnel_whole(c), all * fresnel_complement(c));
}
