// A microfacet lobe: Torrance & Sparrow 1967; Walter et al. 2007, eq. 20: f = F D G2 / (4 μi μe).

fn lobe(p: Pair, a: Azimuth, alpha: real, row: real) -> real2 {
    let h = half_vector(p, a);
    return fresnel(h.c, h.one_minus_c) * (ndf(h, p.hz2, alpha) * visibility_of_normal(row, p, h));
}

/// What all azimuths share. It has the unit of D with it, so that what `visibility_of_normal` makes of it is in proportion.
fn lobe_row(p: Pair, alpha: real) -> real {
    return visibility(Toward(p.mu_i, alpha), Toward(p.mu_e, alpha)) * NDF_UNIT;
}

/// α → 0 at fixed μ: the ideal mirror's, as far as the masking lets it.
fn mirror_limit(mu_e: real) -> real2 {
    return mirror_masking(mu_e) * fresnel(mu_e, 1.0 - mu_e);
}
