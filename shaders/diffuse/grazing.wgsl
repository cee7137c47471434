// What Burley's diffuse lobe and Frostbite's share.

/// ωi·ωm squared, cos² θd.
fn cos2_d(p: Pair, a: Azimuth) -> real {
    return p.dt2 + p.ss * a.sin2 + p.hz2;
}

/// 1 + (F90 − 1)(1 − μ)⁵, Schlick's from 1 to F90 at grazing, as (1 − x⁵) + F90 x⁵ with 1 − x⁵ = μ (1 + x +
/// x² + x³ + x⁴): the difference loses every digit where F90 and μ are small.
fn scatter(mu: real, f90: real) -> real {
    let x = 1.0 - mu;
    let x2 = x * x;
    return mu * (1.0 + x + x2 * (1.0 + x + x2)) + f90 * (x2 * x2 * x);
}
