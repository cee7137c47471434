// GGX: Trowbridge & Reitz 1975; Walter et al. 2007, eq. 33.

/// D(ωm), sr⁻¹: (α (ht² + hz²) / (α² hz² + ht²))² / π, also right at hz = 0.
fn ndf(h: Half, hz2: real, alpha: real) -> real {
    let q = alpha * h.h2 / (alpha * alpha * hz2 + h.ht2);
    return q * q * INV_PI;
}
