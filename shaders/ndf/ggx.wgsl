// GGX: Trowbridge & Reitz 1975; Walter et al. 2007, eq. 33.

/// D(ωm), sr⁻¹: ((ht² + hz²) / (α hz² + ht²/α))² / π, also right at hz = 0.
fn ndf(h: Half, hz2: real, alpha: real) -> real {
    let q = h.h2 / (alpha * hz2 + h.ht2 / alpha);
    return q * q * INV_PI;
}

// The map that makes D cos θm dωm flat: tan θm = α sinh v, D cos θm dωm = w dv dφ / 2π with
// w = 2 tanh v sech² v, and v = 4 artanh r, so that all of it is rational in r ∈ [0, 1).

/// r at which tan θm reaches `tan_max`. Beyond TAN_CAP · α the lobe holds 1e-18 of its weight;
/// without the cap the square overflows as α → 0.
fn ndf_map_end(tan_max: real, alpha: real) -> real {
    let sinh_v = min(tan_max / alpha, TAN_CAP);
    let cosh_v = sqrt(1.0 + sinh_v * sinh_v);
    let tanh_half = sinh_v / (1.0 + cosh_v);
    return tanh_half / (1.0 + sqrt(2.0 / (1.0 + cosh_v)));
}
const TAN_CAP: real = 1e9;

/// (tan θm, w dv/dr) at r.
fn ndf_map(r: real, alpha: real) -> real2 {
    let r2 = r * r;
    let q = 2.0 * r / (1.0 + r2);               // tanh(v/2)
    let g = (1.0 - r2) / (1.0 + r2);            // sech(v/2)
    let sech = g * g / (1.0 + q * q);           // sech v
    let tan_m = alpha * 2.0 * q / (g * g);      // α sinh v
    let tanh = 2.0 * q / (1.0 + q * q);
    return real2(tan_m, 8.0 * tanh * sech * sech / (1.0 - r2));
}
