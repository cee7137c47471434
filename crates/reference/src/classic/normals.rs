//! Hemispherical integrals over the half vector.

use crate::directions::{MIN_MU, Pair, sin_of};
use crate::quadrature::{even_breaks, integrate};
use std::f64::consts::FRAC_PI_2;

/// The integral over θm is noise to the one over φ, so it has to be finer by this factor.
const FINER: f64 = 0.1;

/// In both variables the integrands vary on the scale 1.
const PANEL: f64 = 3.0;

/// ρ = ∫ f cos θe dωe, dωe = 4 (ωi·ωm) dωm, over the normals ωm that reflect ωi above the horizon, for a lobe of normals
/// about as wide as tan θm = `width`: tan θm = `width` sinh v resolves its peak and its tails.
///
/// With ωi at azimuth 0, φ = π/2 + μ sinh u: the horizon falls as φ passes π/2, on the scale μ.
pub(super) fn rho_dh(f: impl Fn(&Pair) -> [f64; 2], tolerance: f64, mu: f64, width: f64) -> [f64; 2] {
    let mu = mu.clamp(MIN_MU, 1.0);
    let sin = sin_of(mu);
    let reach = (FRAC_PI_2 / mu).asinh();
    let slice = |u: f64| {
        // cos (π/2 + x) = −sin x; twice, for the other half of the azimuth.
        let cos_phi = -(mu * u.sinh()).sin();
        let weight = 2.0 * mu * u.cosh();
        let integrand = |v: f64| {
            let tan_m = width * v.sinh();
            let cos2_m = 1.0 / (1.0 + tan_m * tan_m);
            let cos_m = cos2_m.sqrt();
            // ωi·ωm, and cos θe = 2 (ωi·ωm) cos θm − cos θi
            let cos_d = cos_m * (sin * cos_phi * tan_m + mu);
            let mu_e = 2.0 * cos_d * cos_m - mu;
            if mu_e <= 0.0 {
                return [0.0; 2];
            }
            let tan2 = |mu: f64| (sin_of(mu.min(1.0)) / mu).powi(2);
            let pair = Pair {
                mu_i: mu,
                mu_e,
                tan2_i: tan2(mu),
                tan2_e: tan2(mu_e),
                cos2_m,
                tan2_m: tan_m * tan_m,
                cos_d,
                one_minus_cos_d: 1.0 - cos_d,
                tangential_cos: f64::NAN,
                // Lobes of the normal do not look at these and at the azimuth.
                h: glam::DVec3::NAN,
                d: glam::DVec3::NAN,
            };
            // dωm = sin θm dθm dφ, dθm = cos²θm dtan θm
            let solid_angle = tan_m * cos_m * cos2_m * width * v.cosh();
            f(&pair).map(|f| f * mu_e * 4.0 * cos_d * solid_angle * weight)
        };
        let horizon = (tan_horizon(mu, sin * cos_phi) / width).asinh();
        let mut breaks = even_breaks(0.0, horizon, PANEL);
        // Both cosines are the same where tan θm = tan θi cos φ: the larger has a kink there, which costs an adaptive rule
        // more than it knows (3e-8 of 1e-11).
        let same = (sin * cos_phi / mu / width).asinh();
        if 0.0 < same && same < horizon {
            breaks.push(same);
            breaks.sort_by(f64::total_cmp);
        }
        integrate(integrand, &breaks, FINER * tolerance).value_or_nan()
    };
    let mut breaks = even_breaks(-reach, reach, PANEL);
    // Where the normals of equal cosines pass through the peak, tan θi |cos φ| ~ width.
    let near = |multiple: f64| (multiple * width / sin).min(1.0).asin() / mu;
    for u in [1.0, 5.0, 25.0].map(|multiple| near(multiple).asinh()) {
        breaks.extend([-u, u].into_iter().filter(|u| u.abs() < reach));
    }
    breaks.sort_by(f64::total_cmp);
    integrate(slice, &breaks, tolerance).value_or_nan()
}

/// The positive root of μ tan² − 2 x tan − μ = 0, where cos θe = 0.
fn tan_horizon(mu: f64, x: f64) -> f64 {
    let root = x.hypot(mu);
    if x > 0.0 { (x + root) / mu } else { mu / (root - x) }
}
