//! Student's t-distribution of slopes.

use crate::ndf::Ndf;
use crate::setting::Parameters;
use libm::tgamma;
use std::f64::consts::PI;

/// Ribardière, Bringier, Meneveaux & Simonot 2017.
pub(crate) struct StudentT;

impl Ndf for StudentT {
    /// Eq. 12 there: D = (γ − 1)^γ α^(2γ − 2) / (π cos⁴θm ((γ − 1) α² + tan²θm)^γ), by its logarithm, as α^(2γ) underflows.
    fn d(&self, cos2_m: f64, tan2_m: f64, alpha: f64, p: &Parameters) -> f64 {
        let alpha2 = alpha * alpha;
        let power = (-p.gamma * (tan2_m / ((p.gamma - 1.0) * alpha2)).ln_1p()).exp();
        power / (PI * alpha2 * cos2_m * cos2_m)
    }

    /// Λ = ∫ (q/c − 1) P(q) dq over slopes q > c = cot θ, P(q) = K b^n/(b + q²)^(n + 1/2), n = γ − 1, b = n α²:
    /// K b^n (b + c²)^(1/2 − n)/((2n − 1) c) − I_y(n, 1/2)/2 with y = b/(b + c²).
    fn lambda(&self, tan2: f64, alpha: f64, p: &Parameters) -> f64 {
        let n = p.gamma - 1.0;
        let b_tan2 = n * alpha * alpha * tan2;
        let (x, y) = (1.0 / (1.0 + b_tan2), b_tan2 / (1.0 + b_tan2));
        // y = 1 where θ is the horizon's.
        let y = if b_tan2.is_infinite() { 1.0 } else { y };
        let k = tgamma(n + 0.5) / (PI.sqrt() * tgamma(n));
        let mean = k * y.powf(n) / ((2.0 * n - 1.0) * x.sqrt());
        (mean - 0.5 * incomplete_beta(n, 0.5, y, x)).max(0.0)
    }
}

/// I_x(a, b) with y = 1 − x: DLMF 8.17.22, by Lentz's method, from the end at which it converges.
fn incomplete_beta(a: f64, b: f64, x: f64, y: f64) -> f64 {
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - incomplete_beta(b, a, y, x);
    }
    if x == 0.0 {
        return 0.0;
    }
    // 1/(1 + t₁/(1 + t₂/(1 + …))), from its beginning.
    let mut d = 1.0 / (1.0 - (a + b) * x / (a + 1.0));
    let (mut c, mut fraction) = (1.0, d);
    for m in (1..1000).map(f64::from) {
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let before = fraction;
        for term in [even, odd] {
            d = 1.0 / (1.0 + term * d);
            c = 1.0 + term / c;
            fraction *= c * d;
        }
        if (fraction - before).abs() <= 1e-16 * fraction.abs() {
            break;
        }
    }
    let scale = tgamma(a + b) / (tgamma(a) * tgamma(b));
    x.powf(a) * y.powf(b) * scale / a * fraction
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ndf::ggx::Ggx;

    /// γ = 2 is GGX.
    #[test]
    fn two_is_ggx() {
        let two = Parameters::named([("gamma", 2.0)]).unwrap();
        for alpha in [1e-6, 1e-3, 0.1, 0.7, 1.0] {
            for tan2 in [0.0, 1e-14, 1e-6, 0.3, 1e4, 1e12] {
                let d = |ndf: &dyn Ndf| ndf.d(1.0 / (1.0 + tan2), tan2, alpha, &two);
                assert!((d(&StudentT) / d(&Ggx) - 1.0).abs() < 1e-12, "D, {alpha}, {tan2}");
                let g1 = |ndf: &dyn Ndf| 1.0 / (1.0 + ndf.lambda(tan2, alpha, &two));
                assert!((g1(&StudentT) / g1(&Ggx) - 1.0).abs() < 1e-12, "G1, {alpha}, {tan2}");
            }
        }
    }
}
