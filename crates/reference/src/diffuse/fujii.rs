//! Oren and Nayar's model without its ring.

use crate::diffuse::sines;
use crate::directions::Pair;
use crate::measure::Measure;
use crate::setting::Setting;
use crate::{Angles, Reference, definition};
use std::f64::consts::{FRAC_PI_2, PI};

/// Fujii, *A tiny improvement of Oren-Nayar reflectance model* (mimosa-pudica.net), the second of its two pairs
/// of A and B, in which σ' ∈ [0, 1] is the share of the non-diffuse term:
///
/// A = A₀ + B₀ s/t, s = ωi·ωe − μi μe, t = 1 where s ≤ 0, else max(μi, μe),
/// A₀ = 1/(π + (π/2 − 2/3) σ'), B₀ = σ' A₀.
pub static FUJII: &dyn Reference = &Fujii;

struct Fujii;

impl Reference for Fujii {
    fn measure(&self) -> Measure {
        Measure::Roughness
    }

    fn brdf(&self, angles: &Angles, setting: &Setting) -> Option<[f64; 2]> {
        Some([value(angles, setting.alpha), 0.0])
    }

    fn rho_dh(&self, mu: f64, setting: &Setting) -> [f64; 2] {
        definition::rho_dh_kinked(|angles| [value(angles, setting.alpha), 0.0], mu, setting)
    }
}

pub(super) fn value(angles: &Angles, sigma: f64) -> f64 {
    let pair = Pair::new(angles);
    let [s_i, s_e] = sines(&pair);
    let (mu_i, mu_e) = (pair.mu_i, pair.mu_e);
    let cos_phi = -angles.delta_phi.cos();
    // 1 + s/t. Where s < 0, 1 + s = (1 − si se) + si se (1 + cos φ) with half angles for the second bracket and
    // ((si − se)² + μi² + μe²)/2 for the first: as it stands it vanishes where both graze, with all its digits.
    let one_plus = if cos_phi > 0.0 {
        1.0 + s_i * s_e * cos_phi / mu_i.max(mu_e)
    } else {
        let across = 0.5 * ((s_i - s_e).powi(2) + mu_i * mu_i + mu_e * mu_e);
        across + 2.0 * s_i * s_e * (0.5 * angles.delta_phi).sin().powi(2)
    };
    ((1.0 - sigma) + sigma * one_plus) / (PI + (FRAC_PI_2 - 2.0 / 3.0) * sigma)
}
