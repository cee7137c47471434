// The diffuse lobe of glTF 2.0, Appendix B: Kd = (1 − Fc)/π with Fc of the half vector, so that it
// is not Lambert.

fn lobe(p: Pair, a: Azimuth, alpha: real, row: real) -> real2 {
    let h = half_vector(p, a);
    return real2(fresnel(h.c, h.one_minus_c).x * INV_PI, 0.0);
}

fn lobe_row(p: Pair, alpha: real) -> real {
    return 0.0;
}
