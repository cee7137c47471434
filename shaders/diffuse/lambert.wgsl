// Lambert 1760: f = albedo / π; here with albedo 1.

fn lobe(p: Pair, a: Azimuth, alpha: real) -> real2 {
    return real2(INV_PI, 0.0);
}
