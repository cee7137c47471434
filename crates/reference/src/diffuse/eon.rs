//! Oren and Nayar's model with what it loses.

use crate::diffuse::{fujii, sines};
use crate::directions::Pair;
use crate::measure::Measure;
use crate::setting::Setting;
use crate::{Angles, Reference, definition};
use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI};

/// Portsmouth, Kutz & Hill 2025, *EON: A Practical Energy-Preserving Rough Diffuse BRDF*, JCGT 14 (1),
/// listing 1 with the exact albedo. The parameter is ρ, the albedo of a facet; r the roughness:
///
/// A = ρ f₁ + (ρₘ/π) (1 − E(μi)) (1 − E(μe)) / (1 − Ē), f₁ Fujii's form at σ' = r, ρₘ = ρ² Ē/(1 − ρ (1 − Ē)),
/// E = A₁ + (r A₁/π) G(μ), G = S (θ − S μ) + 2/3 (S (1 − S³)/μ − S), S = sin θ,
/// Ē = A₁ (1 + (2/3 − 28/(15π)) r), A₁ = 1/(1 + (1/2 − 2/(3π)) r).
pub static EON: &dyn Reference = &Eon;

struct Eon;

impl Reference for Eon {
    fn measure(&self) -> Measure {
        Measure::Roughness
    }

    fn brdf(&self, angles: &Angles, setting: &Setting) -> Option<[f64; 2]> {
        Some(value(angles, setting))
    }

    fn rho_dh(&self, mu: f64, setting: &Setting) -> [f64; 2] {
        definition::rho_dh_kinked(|angles| value(angles, setting), mu, setting)
    }
}

fn value(angles: &Angles, setting: &Setting) -> [f64; 2] {
    let (r, rho) = (setting.alpha, setting.parameters.albedo);
    let pair = Pair::new(angles);
    let [s_i, s_e] = sines(&pair);
    let a1 = 1.0 / (1.0 + K1 * r);
    // 1 = A₁ (1 + K₁ r), so that 1 − E = r A₁ (K₁ − G/π) and 1 − Ē = r A₁ (K₁ − K₂): no 0/0 at r = 0.
    let [lost_i, lost_e] = [(pair.mu_i, s_i), (pair.mu_e, s_e)].map(|(mu, s)| k1_minus_g_over_pi(mu, s));
    let mean = a1 * (1.0 + K2 * r);
    let rho_m = rho * rho * mean / (1.0 - rho * (1.0 - mean));
    let more = rho_m * FRAC_1_PI * r * a1 * lost_i * lost_e / (K1 - K2);
    [rho * fujii::value(angles, r) + more, 0.0]
}

const K1: f64 = 0.5 - 2.0 / (3.0 * PI);
const K2: f64 = 2.0 / 3.0 - 28.0 / (15.0 * PI);

/// K₁ − G(μ)/π, which vanishes at grazing: with γ = π/2 − θ, 1 − S = 2 sin²(γ/2) and (1 − S)/μ = tan(γ/2),
/// π K₁ − G = (π/2 − 2/3)(1 − S) + S γ + S² μ − 2/3 S (1 − S³)/μ.
fn k1_minus_g_over_pi(mu: f64, s: f64) -> f64 {
    let gamma = mu.atan2(s);
    let half = 0.5 * gamma;
    let vanishing = (FRAC_PI_2 - 2.0 / 3.0) * 2.0 * half.sin().powi(2);
    let cubes = half.tan() * (1.0 + s + s * s);
    FRAC_1_PI * (vanishing + s * gamma + s * s * mu - 2.0 / 3.0 * s * cubes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rewriting above is the published formula: to 1e-13 away from grazing, where that keeps its digits.
    #[test]
    fn the_loss_is_the_published_one() {
        for theta in (1..150).map(|k| 0.01 * f64::from(k)) {
            let (s, mu) = theta.sin_cos();
            let g = s * (theta - s * mu) + 2.0 / 3.0 * ((s / mu) * (1.0 - s.powi(3)) - s);
            let error = (k1_minus_g_over_pi(mu, s) - (K1 - g / PI)).abs();
            assert!(error < 1e-13, "θ = {theta}: off by {error:e}");
        }
    }
}
