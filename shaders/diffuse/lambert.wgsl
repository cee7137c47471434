// Lambert 1760: f = albedo / π; here with albedo 1.

fn lobe(p: Pair, a: Azimuth, alpha: real, row: real) -> real2 {
    return real2(INV_PI, 0.0);
}

fn lobe_row(p: Pair, alpha: real) -> real {
    return 0.0;
}
