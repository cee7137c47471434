// Student's t-distribution of slopes: Ribardière, Bringier, Meneveaux & Simonot 2017, *STD: Student's t-Distribution of
// Slopes for Microfacet Based BSDFs*. The host has n = γ − 1 for γ, K = Γ(n + 1/2)/(√π Γ(n)) and κ = 2K/(2n − 1).

/// D(ωm), in units of NDF_UNIT sr⁻¹: (1 + tan²θm/(n α²))^(−γ) / (π α² cos⁴θm), as the square of its root, and the power in two
/// factors: it may leave f32's range where f, which has 1/cos⁴θm and is divided by μi μe, does not.
fn ndf(h: Half, hz2: real, alpha: real) -> real {
    let n = parameter(0u);
    let log = log1p_quotient(real4(h.ht2), real4(n * alpha * alpha * hz2)).x;
    let power = exp_neg(real4(0.25 * (n + 1.0) * log)).x;
    let q = power * (SCALE / alpha * (h.h2 / hz2)) * power;
    return q * q;
}
const SCALE: real = 605793952.5203682; // 2³⁰/√π
const NDF_UNIT: real = 8.673617379884035e-19; // 2⁻⁶⁰

/// Two turns of the continued fraction (c − 1)/F(a, 1; c; z) = c − 1 − a (c − 1) z/(c − 1 (c − a) z/(c + 1 − …)), from its
/// end: DLMF 15.7.5.
fn student_turns(v: real4, m: real, a: real, c: real4, z: real4) -> real4 {
    let w = (c + (2.0 * m - 2.0)) - m * (c - a + (m - 1.0)) * z / v;
    return (c + (2.0 * m - 3.0)) - (a + (m - 1.0)) * (c + (m - 2.0)) * z / w;
}

/// (1 + 2Λ) μ, with Smith's Λ of these normals. With B = μ² + n α² sin²θ, x = μ²/B and y = 1 − x it is √B g,
/// g = √x I_x(1/2, n) + κ yⁿ: what the facets cover as seen from ωi. The incomplete beta is by Gauss's hypergeometric
/// function, K √x yⁿ 2x F(n + 1/2, 1; 3/2; x), or from its other end 1 − K yⁿ √x/n F(n + 1/2, 1; n + 1; y): its continued
/// fraction, cut after 24 turns, is right to 1e-13.
fn smith_roots(mu: real4, alpha: real4) -> real4 {
    let n = parameter(0u);
    let k = parameter(1u);
    let kappa = parameter(2u);
    let across = n * alpha * alpha * ((1.0 - mu) * (1.0 + mu));
    let along = mu * mu;
    let both = along + across;
    let x = along / both;
    let y = across / both;
    let is_low = x < real4(min(0.5, 4.0 / (n + 3.0)));
    let a = n + 0.5;
    let c = select(real4(n + 1.0), real4(1.5), is_low);
    let z = select(y, x, is_low);
    var v = c + 23.0;
    v = student_turns(v, 12.0, a, c, z);
    v = student_turns(v, 11.0, a, c, z);
    v = student_turns(v, 10.0, a, c, z);
    v = student_turns(v, 9.0, a, c, z);
    v = student_turns(v, 8.0, a, c, z);
    v = student_turns(v, 7.0, a, c, z);
    v = student_turns(v, 6.0, a, c, z);
    v = student_turns(v, 5.0, a, c, z);
    v = student_turns(v, 4.0, a, c, z);
    v = student_turns(v, 3.0, a, c, z);
    v = student_turns(v, 2.0, a, c, z);
    v = student_turns(v, 1.0, a, c, z);
    let power = select(exp_neg(n * log1p_quotient(along, across)), real4(), across == real4());
    let share = k * x / v;
    return sqrt(both) * (power * (kappa + select(-share, share, is_low)) + select(sqrt(x), real4(), is_low));
}
