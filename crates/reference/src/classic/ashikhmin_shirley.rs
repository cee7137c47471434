//! Ashikhmin & Shirley 2000, *An Anisotropic Phong BRDF Model*, with nu = nv.

use crate::classic::Classic;
use crate::classic::blinn::{exponent, power};
use crate::directions::Pair;
use crate::fresnel::schlick;
use crate::setting::Setting;
use crate::{Angles, Reference, definition};
use std::f64::consts::PI;

/// ρs = √((nu + 1)(nv + 1))/(8π) (n·h)ⁿ / ((h·k) max(n·k1, n·k2)) F(k·h), by what F's Rs and 1 weigh.
pub static ASHIKHMIN_SHIRLEY: &dyn Reference = &Classic {
    value: |pair, alpha| {
        let n = exponent(alpha);
        let s = (n + 1.0) / (8.0 * PI) * power(pair, n) / (pair.cos_d * pair.mu_i.max(pair.mu_e));
        schlick::weights(pair.cos_d, pair.one_minus_cos_d).map(|weight| s * weight)
    },
    smooth: |mu| schlick::weights(mu, 1.0 - mu),
};

/// ρd = 28 Rd/(23π) (1 − Rs) (1 − (1 − n·k1/2)⁵)(1 − (1 − n·k2/2)⁵), over Rd (1 − Rs).
pub static ASHIKHMIN_SHIRLEY_DIFFUSE: &dyn Reference = &Diffuse;

struct Diffuse;

impl Reference for Diffuse {
    fn brdf(&self, angles: &Angles, _: &Setting) -> Option<[f64; 2]> {
        Some(diffuse(angles))
    }

    fn rho_dh(&self, mu: f64, setting: &Setting) -> [f64; 2] {
        definition::rho_dh(diffuse, mu, setting)
    }
}

fn diffuse(angles: &Angles) -> [f64; 2] {
    let pair = Pair::new(angles);
    [28.0 / (23.0 * PI) * through(pair.mu_i) * through(pair.mu_e), 0.0]
}

/// 1 − (1 − μ/2)⁵ = −expm1(5 ln(1 − μ/2)).
fn through(mu: f64) -> f64 {
    -(5.0 * (-0.5 * mu).ln_1p()).exp_m1()
}
