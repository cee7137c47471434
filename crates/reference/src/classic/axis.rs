//! Cosine lobes about an axis that is not the normal, and their hemispherical integrals in polar coordinates about it.

use crate::directions::{MIN_MU, Pair, sin_of};
use crate::measure::Measure;
use crate::quadrature::integrate;
use crate::setting::Setting;
use crate::{Angles, Reference};
use std::f64::consts::{FRAC_PI_2, PI};

/// (n + 2)/(2π) `scale` cosⁿγ, γ from the axis, 0 beyond 90°.
pub(crate) struct AboutAxis {
    /// f at a pair of directions, for α > 0.
    pub value: fn(&Pair, &Setting) -> f64,
    /// The axis of a direction with this cosine and sine.
    pub axis: fn(f64, f64, &Setting) -> Axis,
}

pub(crate) struct Axis {
    /// Of its angle to the normal.
    pub sin: f64,
    pub cos: f64,
    /// In proportion to what the lobe is; of α = 0 its limit.
    pub scale: f64,
}

/// The absolute error that ρ_dh reaches.
const FINEST: f64 = 1e-11;

/// The integral over γ is noise to the one over ψ, so it has to be finer.
const FINER: f64 = 0.1;

/// n of α: 1 and more.
pub(super) fn exponent(alpha: f64) -> f64 {
    2.0 / (alpha * alpha) - 1.0
}

/// (n + 2)/(2π) cosⁿγ, from 1 − cos γ and from cos γ: each has its digits where it is the smaller. 0 where cos γ ≤ 0.
pub(super) fn cosine_lobe(n: f64, one_minus_cos: f64, cos: f64) -> f64 {
    let ln_cos = match one_minus_cos {
        ..0.5 => (-one_minus_cos).ln_1p(),
        _ if cos > 0.0 => cos.ln(),
        _ => return 0.0,
    };
    (n + 2.0) / (2.0 * PI) * (n * ln_cos).exp()
}

impl AboutAxis {
    fn rho(&self, mu: f64, s: &Setting, tolerance: f64, factor: &dyn Fn(f64) -> f64) -> [f64; 2] {
        let mu = mu.clamp(MIN_MU, 1.0);
        let axis = (self.axis)(mu, sin_of(mu), s);
        if axis.scale == 0.0 {
            return [0.0; 2];
        }
        // Of a delta all is at the axis.
        let rho = if s.alpha == 0.0 {
            axis.cos * factor(axis.cos)
        } else {
            about(&axis, s.alpha, tolerance, factor)
        };
        [axis.scale * rho, 0.0]
    }
}

impl Reference for AboutAxis {
    fn measure(&self) -> Measure {
        Measure::ALPHA
    }

    fn brdf(&self, angles: &Angles, s: &Setting) -> Option<[f64; 2]> {
        (s.alpha != 0.0).then(|| [(self.value)(&Pair::new(angles), s), 0.0])
    }

    fn rho_dh(&self, mu: f64, s: &Setting) -> [f64; 2] {
        self.rho(mu, s, s.tolerance(FINEST), &|_| 1.0)
    }

    /// 2 ∫ ρ μ dμ with μ = w². ρ changes where μ ~ α, as the lobe meets the horizon, and where an axis of another length
    /// than ωi's leaves the normal or the horizon, θ or μ ~ α/√(1 − C²): that is on any scale from α on. As the mean weighs
    /// ρ with 2μ, it may be the coarser the smaller μ is.
    fn rho_hh(&self, s: &Setting) -> [f64; 2] {
        // None below 1e-7, where a mean has nothing.
        let scales =
            || std::iter::successors(Some(s.alpha.max(1e-7)), |x| Some(5.0 * x)).take_while(|&x| x < 0.5);
        let near = scales().map(f64::sqrt);
        let mut far: Vec<_> = scales().map(f64::cos).map(f64::sqrt).collect();
        far.reverse();
        let breaks: Vec<_> = [0.0].into_iter().chain(near).chain(far).chain([1.0]).collect();
        let tolerance = s.tolerance(10.0 * FINEST);
        let weighted =
            |w: f64| self.rho(w * w, s, 0.1 * tolerance / (w * w), &|_| 1.0).map(|rho| 4.0 * w.powi(3) * rho);
        integrate(weighted, &breaks, tolerance).value_or_nan()
    }

    fn rho_dh_times(&self, mu: f64, s: &Setting, factor: &dyn Fn(f64) -> f64) -> [f64; 2] {
        self.rho(mu, s, s.tolerance(10.0 * FINEST), factor)
    }
}

/// (n + 2)/(2π) ∫ cosⁿγ cos θe `factor`(cos θe) dωe over the directions within 90° of the axis and above the horizon. With ψ
/// from the azimuth in which the horizon is nearest, cos θe = cos γ cos θ − sin γ sin θ cos ψ and dωe = sin γ dγ dψ.
fn about(&Axis { sin, cos, .. }: &Axis, alpha: f64, tolerance: f64, factor: &dyn Fn(f64) -> f64) -> f64 {
    let n = exponent(alpha);
    let slice = |cos_psi: f64| {
        let integrand = |gamma: f64| {
            let (sin_gamma, cos_gamma) = gamma.sin_cos();
            let mu_e = cos_gamma * cos - sin_gamma * sin * cos_psi;
            if mu_e <= 0.0 {
                return [0.0; 2];
            }
            // cosⁿγ = (1 − sin²γ)^(n/2), which keeps its digits at large n.
            let power = (0.5 * n * (-sin_gamma * sin_gamma).ln_1p()).exp();
            [(n + 2.0) / (2.0 * PI) * power * mu_e * factor(mu_e) * sin_gamma, 0.0]
        };
        let end = if cos_psi > 0.0 { cos.atan2(sin * cos_psi) } else { FRAC_PI_2 };
        let widths = [1.0, 3.0, 9.0].map(|multiple| multiple * alpha);
        let inside = widths.into_iter().filter(|&x| x < end);
        let breaks: Vec<_> = [0.0].into_iter().chain(inside).chain([end]).collect();
        integrate(integrand, &breaks, FINER * tolerance).value_or_nan()
    };
    // ψ = π/2 ∓ x, x = c sinh u: the horizon leaves the lobe within c = cot θ of π/2.
    let scale = (cos / sin).clamp(1e-9, 1.0);
    let reach = (FRAC_PI_2 / scale).asinh();
    let breaks: Vec<_> = (0..=6).map(|k| reach * f64::from(k) / 6.0).collect();
    let half = |sign: f64| {
        let turned = |u: f64| {
            let weight = 2.0 * scale * u.cosh();
            slice(sign * (scale * u.sinh()).sin()).map(|part| weight * part)
        };
        integrate(turned, &breaks, 0.5 * tolerance).value_or_nan()[0]
    };
    half(1.0) + half(-1.0)
}
