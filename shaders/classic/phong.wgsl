// Phong 1975 as Lafortune & Willems 1994 have it: f = (n + 2)/(2π) cosⁿγ, γ from the mirror direction to ωe.

/// cos γ = μi μe + sin θi sin θe cos δ; 1 − cos γ = 2 sin²((θi − θe)/2) + 2 sin θi sin θe sin²(δ/2).
fn lobe(p: Pair, a: Azimuth, alpha: real, row: real) -> real2 {
    let cosine = p.mu_i * p.mu_e + p.ss * (a.cos2 - a.sin2);
    return power_about_axis(cosine, 2.0 * (p.sd + p.ss * a.sin2), alpha, row);
}
