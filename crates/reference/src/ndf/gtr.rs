//! GTR: Trowbridge and Reitz's normals with another exponent.

use crate::measure::Measure;
use crate::ndf::Ndf;
use crate::ndf::ggx::Ggx;
use crate::setting::Parameters;
use std::f64::consts::PI;

/// Burley 2012.
pub(crate) struct Gtr;

impl Ndf for Gtr {
    /// Burley 2012, appendix B: D = c / (α² cos²θm + sin²θm)^γ, with c such that ∫ D cos θm dωm = 1: eq. 2, and eq. 4 for
    /// γ = 1. Both are quotients of small differences near γ = 1 and α = 1, where this takes the limits: with l = ln 1/α²,
    /// c = (1 − α²)/(π l) · g/(e^g − 1), g = (γ − 1) l.
    fn d(&self, cos2_m: f64, tan2_m: f64, alpha: f64, p: &Parameters) -> f64 {
        let alpha2 = alpha * alpha;
        if alpha == 1.0 {
            return 1.0 / PI;
        }
        let log = -2.0 * if alpha < 0.5 { alpha.ln() } else { (alpha - 1.0).ln_1p() };
        let g = (p.gamma - 1.0) * log;
        let share = if g == 0.0 { 1.0 } else { g / g.exp_m1() };
        let c = (1.0 - alpha) * (1.0 + alpha) / (PI * log) * share;
        c / (cos2_m * (alpha2 + tan2_m)).powf(p.gamma)
    }

    /// GGX's of the same α, as Burley 2012, section 5.6, has it.
    fn lambda(&self, tan2: f64, alpha: f64, parameters: &Parameters) -> f64 {
        Ggx.lambda(tan2, alpha, parameters)
    }

    /// α = max(0.001, roughness²): `disney.brdf` of BRDF Explorer has `max(.001, sqr(roughness)/aspect)`.
    fn measure(&self) -> Measure {
        Measure::Alpha { least: 1e-3 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// γ = 2 is GGX, and γ → 1 goes over into the logarithm of γ = 1, also below the least α of Disney's.
    #[test]
    fn limits_of_the_exponent() {
        let gamma = |gamma| Parameters::named([("gamma", gamma)]).unwrap();
        for alpha in [1e-6, 1e-3, 0.1, 0.7, 1.0] {
            for tan2_m in [0.0, 1e-14, 1e-6, 0.3, 1e4] {
                let d = |p: &Parameters| Gtr.d(1.0 / (1.0 + tan2_m), tan2_m, alpha, p);
                let ggx = Ggx.d(1.0 / (1.0 + tan2_m), tan2_m, alpha, &Parameters::DEFAULT);
                assert!((d(&gamma(2.0)) / ggx - 1.0).abs() < 1e-11, "{alpha}, {tan2_m}");
                assert!((d(&gamma(1.0 + 1e-9)) / d(&gamma(1.0)) - 1.0).abs() < 1e-6, "{alpha}, {tan2_m}");
            }
        }
    }
}
