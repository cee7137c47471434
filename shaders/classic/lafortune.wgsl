// Lafortune, Foo, Torrance & Greenberg 1997: f = (n + 2)/(2π) (Cx ux vx + Cy uy vy + Cz uz vz)ⁿ, Cx = Cy, u = ωi, v = ωe.

const CXY = 0u;
const CZ = 1u;
const ONE_MINUS_CXY = 2u;
const ONE_PLUS_CXY = 3u;
const ONE_MINUS_CZ = 4u;

/// ux vx + uy vy = −sin θi sin θe cos δ. With cos δ = cos²(δ/2) − sin²(δ/2) and 1 = μi μe + sin θi sin θe cos δ + 1 − cos γ
/// of the mirror direction, the complement is a sum of what is not negative, as |Cx| ≤ 1 and Cz ≤ 1.
fn lobe(p: Pair, a: Azimuth, alpha: real, row: real) -> real2 {
    let mu2 = p.mu_i * p.mu_e;
    let cosine = parameter(CZ) * mu2 - parameter(CXY) * (p.ss * (a.cos2 - a.sin2));
    let turned = parameter(ONE_MINUS_CXY) * a.sin2 + parameter(ONE_PLUS_CXY) * a.cos2;
    let complement = 2.0 * p.sd + parameter(ONE_MINUS_CZ) * mu2 + p.ss * turned;
    return power_about_axis(cosine, complement, alpha, row);
}
