// The map of `ggx_coarse`, for tolerances below 1e-6: v = 8 artanh r, where 4 artanh takes twice as many
// nodes at 1e-9. With a = 1 + r², b = 1 − r², s = a² + 4r² and S = s² + (4ra)²,
//     sinh v = 8ras/b⁴,  cosh v = S/b⁴,  dv/dr = 8/b.

/// r at which tan θm reaches `tan_max`.
fn ndf_map_end(tan_max: real, alpha: real4) -> real4 {
    let sinh_v = min(tan_max / alpha, real4(1e12));
    let cosh_2 = sqrt(0.5 + 0.5 * sqrt(1.0 + sinh_v * sinh_v)); // cosh(v/2)
    let cosh_4 = sqrt(0.5 + 0.5 * cosh_2);                      // cosh(v/4)
    return 0.25 * sinh_v / (cosh_2 * cosh_4 * (1.0 + cosh_4));
}

/// `tan_scale` is NDF_MAP_TAN α.
fn ndf_map(r: real4, tan_scale: real4) -> Map {
    let r2 = r * r;
    let b = 1.0 - r2;
    let b2 = b * b;
    let ra = r + r * r2;
    let s = 1.0 + r2 * (6.0 + r2);
    let cosh = s * s + 16.0 * ra * ra;
    return Map(tan_scale * ra * s, b2 * b2, ra * s * b * b2, cosh * cosh * cosh);
}
const NDF_MAP_TAN: real = 8.0;
const NDF_MAP_WEIGHT: real = 128.0;
