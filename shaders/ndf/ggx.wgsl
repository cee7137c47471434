// GGX: Trowbridge & Reitz 1975; Walter et al. 2007, eq. 33.

/// D(ωm), sr⁻¹: ((ht² + hz²) / (α hz² + ht²/α))² / π, also right at hz = 0.
fn ndf(h: Half, hz2: real, alpha: real) -> real {
    let q = h.h2 / (alpha * hz2 + h.ht2 / alpha);
    return q * q * INV_PI;
}

// The map that makes D cos θm dωm flat: tan θm = α sinh v, D cos θm dωm = w dv dφ / 2π with
// w = 2 tanh v sech² v, and v = 8 artanh r. All of it is rational in r ∈ [0, 1): with a = 1 + r²,
// b = 1 − r², s = a² + 4r², q = 8ras and S = s² + (4ra)²,
//     sinh v = q/b⁴,  tanh v = q/S,  sech v = b⁴/S,  dv/dr = 8/b.
// (4 artanh needs a few nodes less at 1e-4, and twice as many at 1e-9; 2 artanh stalls.)

/// r at which tan θm reaches `tan_max`. Beyond TAN_CAP · α the lobe holds 1e-18 of its weight;
/// without the cap the square overflows as α → 0.
fn ndf_map_end(tan_max: real, alpha: real4) -> real4 {
    let sinh_v = min(tan_max / alpha, real4(TAN_CAP));
    let cosh_2 = sqrt(0.5 + 0.5 * sqrt(1.0 + sinh_v * sinh_v)); // cosh(v/2)
    let cosh_4 = sqrt(0.5 + 0.5 * cosh_2);                      // cosh(v/4)
    return 0.25 * sinh_v / (cosh_2 * cosh_4 * (1.0 + cosh_4));
}
const TAN_CAP: real = 1e9;

/// tan θm = p/m and w dv/dr = weight/divisor, at r.
struct Map {
    p: real4,
    m: real4,
    weight: real4,
    divisor: real4,
}

fn ndf_map(r: real4, alpha: real4) -> Map {
    let r2 = r * r;
    let a = 1.0 + r2;
    let b = 1.0 - r2;
    let ra = 4.0 * r * a;
    let s = a * a + 4.0 * r2;
    let q = 2.0 * ra * s;
    let b2 = b * b;
    let b4 = b2 * b2;
    let cosh = s * s + ra * ra;
    return Map(alpha * q, b4, 16.0 * q * b4 * b2 * b, cosh * cosh * cosh);
}
