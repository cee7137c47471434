// The map that makes D cos θm dωm flat in the azimuth, for tolerances below 1e-6: tan θm = α r,
// D cos θm dωm = w dr dφ / 2π with w = 2 r e^(−r²), cut where the rest, e^(−r²), is 1e-13.

/// r at which tan θm reaches `tan_max`.
fn ndf_map_end(tan_max: real, alpha: real4) -> real4 {
    return min(tan_max / alpha, real4(5.5));
}

/// `tan_scale` is NDF_MAP_TAN α.
fn ndf_map(r: real4, tan_scale: real4) -> Map {
    return Map(tan_scale * r, real4(1.0), r * exp_neg(r * r), real4(1.0));
}
const NDF_MAP_TAN: real = 1.0;
const NDF_MAP_WEIGHT: real = 2.0;
