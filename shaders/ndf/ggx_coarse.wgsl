// The map that makes D cos θm dωm flat, for tolerances down to 1e-6: tan θm = α sinh v,
// D cos θm dωm = w dv dφ / 2π with w = 2 tanh v sech² v, and v = 4 artanh r. All of it is rational in
// r ∈ [0, 1): with a = 1 + r², b = 1 − r² and s = a² + 4r²,
//     sinh v = 4ra/b²,  cosh v = s/b²,  dv/dr = 4/b.
// (2 artanh stalls.)

/// r at which tan θm reaches `tan_max`.
fn ndf_map_end(tan_max: real, alpha: real4) -> real4 {
    let sinh_v = min(tan_max / alpha, real4(TAN_CAP));
    let cosh_2 = sqrt(0.5 + 0.5 * sqrt(1.0 + sinh_v * sinh_v)); // cosh(v/2)
    return 0.5 * sinh_v / (cosh_2 * (1.0 + cosh_2));
}

/// `tan_scale` is NDF_MAP_TAN α.
fn ndf_map(r: real4, tan_scale: real4) -> Map {
    let r2 = r * r;
    let b = 1.0 - r2;
    let ra = fma(r, r2, r);
    let s = fma(r2, r2 + 6.0, real4(1.0));
    return Map(tan_scale * ra, b * b, ra * b, s * s * s);
}
const NDF_MAP_TAN: real = 4.0;
const NDF_MAP_WEIGHT: real = 32.0;
