// GGX: Trowbridge & Reitz 1975; Walter et al. 2007, eq. 33.

/// D(ωm), in units of NDF_UNIT sr⁻¹: (α h² / (α² hz² + ht²))² / π, also right at hz = 0.
fn ndf(h: Half, hz2: real, alpha: real) -> real {
    let q = (INV_SQRT_PI * alpha) * h.h2 / (alpha * alpha * hz2 + h.ht2);
    return q * q;
}
const INV_SQRT_PI: real = 0.5641895835477563;
const NDF_UNIT: real = 1.0;

/// Beyond it, in units of α, the lobe holds 1e-18 of its weight; the maps' squares would overflow as α → 0.
const TAN_CAP: real = 1e9;
