// What the forms of Oren and Nayar's model share. s = ωi·ωe − μi μe = sin θi sin θe cos(φi − φe), and t is
// max(μi, μe) where s > 0, else 1.

/// max(0, s)/t = sin α tan β max(0, cos(φi − φe)), α the larger and β the smaller of θi and θe: no angle, no
/// tangent.
fn retro(p: Pair, a: Azimuth) -> real {
    return p.ss * a.back / max(p.mu_i, p.mu_e);
}

/// 1 + s/t ≥ 0. Where s < 0 it is (1 − sin θi sin θe) + 2 sin θi sin θe sin²(δ/2), and what is in brackets
/// 2 sin²((θi − θe)/2) + μi μe: the difference loses every digit where both graze.
fn one_plus_s_over_t(p: Pair, a: Azimuth) -> real {
    let ahead = 2.0 * (p.sd + p.ss * a.sin2) + p.mu_i * p.mu_e;
    return select(ahead, 1.0 + retro(p, a), a.back > 0.0);
}
