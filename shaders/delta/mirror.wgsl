// The ideal mirror, f = F δ(θi − θe) δ(δφ) / (cos θi sin θi): a delta, with no value.

/// Its mean over a cell of directions, for the grid rule alone: F over the cell's projected solid
/// angle where the cell holds the mirror direction. The grid's sum is then F exactly.
fn lobe(p: Pair, a: Azimuth, alpha: real, row: real) -> real2 {
    return fresnel(p.mu_i, 1.0 - p.mu_i) * (p.bin * a.bin);
}

fn lobe_row(p: Pair, alpha: real) -> real {
    return 0.0;
}

/// ρ(μ), analytic.
fn directional(mu: real, alpha: real) -> real2 {
    return fresnel(mu, 1.0 - mu);
}
