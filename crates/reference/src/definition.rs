//! Hemispherical integrals as they are defined.

use crate::quadrature::integrate;
use crate::{Angles, MIN_MU, Setting};
use std::f64::consts::{FRAC_PI_2, PI};

/// The absolute error that an integral reaches.
const FINEST: f64 = 1e-10;
/// The inner integral of a nest is noise to the outer one, so it has to be finer by this factor.
const FINER: f64 = 0.01;
/// ρ_dh is noise to its mean; its own error is far below what it is asked for.
const MEAN_FINER: f64 = 0.3;

/// ρ_dh = ∫∫ f cos θe sin θe dθe dδφ, for an f without a peak that is even in δφ.
///
/// θi is where f has a scale to change: below it the half vector leans one way, above it the other.
pub(super) fn rho_dh(f: impl Fn(&Angles) -> [f64; 2], mu: f64, setting: &Setting) -> [f64; 2] {
    rho_dh_between(&[0.0, PI], f, mu, setting)
}

/// The same for an f with a kink where ωi and ωe are perpendicular in azimuth.
pub(super) fn rho_dh_kinked(f: impl Fn(&Angles) -> [f64; 2], mu: f64, setting: &Setting) -> [f64; 2] {
    rho_dh_between(&[0.0, FRAC_PI_2, PI], f, mu, setting)
}

fn rho_dh_between(azimuths: &[f64], f: impl Fn(&Angles) -> [f64; 2], mu: f64, setting: &Setting) -> [f64; 2] {
    let tolerance = setting.tolerance(FINEST);
    let theta_i = mu.clamp(MIN_MU, 1.0).acos();
    let ring = |theta_e: f64| {
        let integrand = |delta_phi| f(&Angles { theta_i, theta_e, delta_phi, phi_i: 0.0 });
        let weight = 2.0 * theta_e.cos() * theta_e.sin();
        integrate(integrand, azimuths, FINER * tolerance).value_or_nan().map(|ring| weight * ring)
    };
    integrate(ring, &[0.0, theta_i, FRAC_PI_2], tolerance).value_or_nan()
}

/// ρ_hh = 2 ∫ ρ_dh(μ) μ dμ, by μ = w²: at grazing ρ_dh is not smooth in μ. A microfacet lobe changes where
/// μ ~ α, hence the breaks.
///
/// `rho_dh` gets μ and the absolute error that it may have there: as the mean weighs it with 2μ, the more the smaller μ is.
pub fn rho_hh(setting: &Setting, alpha: f64, rho_dh: impl Fn(f64, f64) -> [f64; 2]) -> [f64; 2] {
    rho_hh_within(setting.tolerance(FINEST), alpha, rho_dh)
}

/// The same to a tolerance.
pub(super) fn rho_hh_within(tolerance: f64, alpha: f64, rho_dh: impl Fn(f64, f64) -> [f64; 2]) -> [f64; 2] {
    // The mean has μ² below μ: where that is less than the tolerance, nothing is worth nodes.
    let scales = [1.0, 5.0, 25.0].map(|multiple| multiple * alpha);
    let scales = [0.0].into_iter().chain(scales.into_iter().filter(|mu| mu * mu > tolerance));
    let breaks: Vec<f64> = scales.filter(|&mu| mu < 0.8).map(f64::sqrt).chain([1.0]).collect();
    let weighted = |w: f64| rho_dh(w * w, MEAN_FINER * tolerance / (w * w)).map(|rho| 4.0 * w.powi(3) * rho);
    integrate(weighted, &breaks, tolerance).value_or_nan()
}
