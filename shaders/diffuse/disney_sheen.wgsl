// Burley 2012, disney.brdf: the sheen is Schlick's Fc = (1 − ωi·ωm)⁵.

fn lobe(p: Pair, a: Azimuth, alpha: real, row: real) -> real2 {
    let h = half_vector(p, a);
    return real2(fresnel(h.c, h.one_minus_c).y, 0.0);
}

fn lobe_row(p: Pair, alpha: real) -> real {
    return 0.0;
}
