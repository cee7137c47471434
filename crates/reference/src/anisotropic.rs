//! Microfacet models whose slopes differ along the tangent and the bitangent.

use crate::directions::{MIN_MU, Pair, sin_of};
use crate::fresnel::Fresnel;
use crate::masking::{Facet, Masking};
use crate::measure::Measure;
use crate::ndf::Ndf;
use crate::quadrature::{even_breaks, integrate};
use crate::setting::Setting;
use crate::{Angles, Factors, Reference, definition};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// A rough surface of small mirrors, αx along the tangent and αy along the bitangent.
///
/// `alpha` is √(αx αy) at strength 0 and `aspect` αx/αy there; `strength` is that by whose square αx is mixed with 1.
pub(crate) struct Anisotropic {
    pub ndf: &'static dyn Ndf,
    pub masking: &'static dyn Masking,
    pub fresnel: &'static dyn Fresnel,
}

/// The absolute error that ρ_dh reaches.
const FINEST: f64 = 1e-9;
/// The absolute error that ρ_hh reaches.
const FINEST_MEAN: f64 = 1e-7;
/// The integral over θm is noise to the one over φ, so it has to be finer by this factor.
const FINER: f64 = 0.1;
/// The integrands vary on the scale 1 in u and in v.
const PANEL: f64 = 3.0;
/// Azimuths of a mean over a quarter of a turn, of which the others are mirror images: the trapezoid's error is that of
/// harmonic 2 · 32 of φ.
const AZIMUTHS: u32 = 16;

impl Reference for Anisotropic {
    fn measure(&self) -> Measure {
        self.ndf.measure()
    }

    /// Walter et al. 2007, eq. 20: f = F D G2 / (4 μi μe).
    fn brdf(&self, angles: &Angles, setting: &Setting) -> Option<[f64; 2]> {
        let pair = Pair::new(angles);
        let Factors { d, g2, f } = self.factors(angles, setting)?;
        let s = d * g2 / (4.0 * pair.mu_i * pair.mu_e);
        Some(f.map(|weight| s * weight))
    }

    fn rho_dh(&self, mu: f64, setting: &Setting) -> [f64; 2] {
        self.rho_dh_at(mu, 0.0, setting)
    }

    fn rho_dh_at(&self, mu: f64, phi: f64, setting: &Setting) -> [f64; 2] {
        self.rho_dh_within(setting.tolerance(FINEST), mu, phi, setting)
    }

    fn rho_hh(&self, setting: &Setting) -> [f64; 2] {
        let mean = |mu: f64, tolerance: f64| {
            let term = |k: u32| {
                let phi = FRAC_PI_2 * f64::from(k) / f64::from(AZIMUTHS);
                let weight = if k == 0 || k == AZIMUTHS { 0.5 } else { 1.0 } / f64::from(AZIMUTHS);
                self.rho_dh_within(tolerance, mu, phi, setting).map(|rho| weight * rho)
            };
            (0..=AZIMUTHS).map(term).fold([0.0; 2], |sum, rho| [sum[0] + rho[0], sum[1] + rho[1]])
        };
        definition::rho_hh_within(setting.tolerance(FINEST_MEAN), setting.alpha, mean)
    }

    fn factors(&self, angles: &Angles, setting: &Setting) -> Option<Factors> {
        let axes = axes(setting);
        if axes.contains(&0.0) {
            return None;
        }
        let pair = Pair::new(angles);
        // In the pair's frame ωi has azimuth π.
        let turn = angles.phi_i - PI;
        let phi_m = pair.h.y.atan2(pair.h.x) + turn;
        let phi_e = angles.phi_i + PI + angles.delta_phi;
        let alpha = [alpha_towards(axes, angles.phi_i), alpha_towards(axes, phi_e)];
        let lambda = |tan2, alpha| self.ndf.lambda(tan2, alpha, &setting.parameters);
        let facet = Facet {
            mu: [pair.mu_i, pair.mu_e],
            lambda: [lambda(pair.tan2_i, alpha[0]), lambda(pair.tan2_e, alpha[1])],
            cos_d: pair.cos_d,
            cos_m: pair.cos2_m.sqrt(),
            alpha,
        };
        Some(Factors {
            d: self.d(pair.cos2_m, pair.tan2_m, phi_m, axes, setting),
            g2: self.masking.g2(&facet),
            f: self.fresnel.weights(pair.cos_d, pair.one_minus_cos_d, &setting.parameters),
        })
    }
}

impl Anisotropic {
    /// Heitz 2014, eq. 83 and 85: tan²θm/α² becomes tan²θm (cos²φm/αx² + sin²φm/αy²), and α² before it αx αy.
    fn d(&self, cos2: f64, tan2: f64, phi: f64, axes: [f64; 2], setting: &Setting) -> f64 {
        let alpha = alpha_along(axes, phi);
        self.ndf.d(cos2, tan2, alpha, &setting.parameters) * alpha * alpha / (axes[0] * axes[1])
    }

    /// As [`Microfacet`](crate::Microfacet)'s, once around.
    fn rho_dh_within(&self, tolerance: f64, mu: f64, phi: f64, setting: &Setting) -> [f64; 2] {
        let mu = mu.clamp(MIN_MU, 1.0);
        let axes = axes(setting);
        if axes == [0.0; 2] {
            return self.fresnel.weights(mu, 1.0 - mu, &setting.parameters);
        }
        let ratio = (axes[0] / axes[1]).min(axes[1] / axes[0]);
        let narrow = if axes[0] < axes[1] { FRAC_PI_2 } else { 0.0 };
        // About the axis of the larger α, D falls with the square of the azimuth from the width of its peak on: a rule that
        // is asked for little would not see so thin a layer, and its tails are percents.
        let widths = || std::iter::successors(Some(ratio), |width| Some(6.0 * width)).take_while(|&width| width < 1.0);
        // φm − φ = ±π/2 + μ sinh u: the horizon turns there.
        let reach = (FRAC_PI_2 / mu).asinh();
        let mut sum = [0.0; 2];
        for centre in [FRAC_PI_2, -FRAC_PI_2] {
            let mut breaks = even_breaks(-reach, reach, PANEL);
            for turn in [-2.0, -1.0, 0.0, 1.0, 2.0] {
                for width in widths().flat_map(|width| [-width, width]) {
                    let offset = narrow + turn * PI - phi + width - centre;
                    if offset.abs() < FRAC_PI_2 {
                        breaks.push((offset / mu).asinh());
                    }
                }
            }
            breaks.sort_by(f64::total_cmp);
            let slice = |u: f64| {
                let turn = centre + mu * u.sinh();
                self.slice(FINER * tolerance, mu * u.cosh(), mu, turn, phi, setting)
            };
            let [a, b] = integrate(slice, &breaks, tolerance).value_or_nan();
            sum = [sum[0] + a, sum[1] + b];
        }
        sum
    }

    /// The integral over θm at an azimuth φm = φ + turn of ωm, times `weight`, with tan θm = α(φm) sinh v.
    fn slice(
        &self,
        tolerance: f64,
        weight: f64,
        mu: f64,
        turn: f64,
        phi: f64,
        setting: &Setting,
    ) -> [f64; 2] {
        let axes = axes(setting);
        let (sin_turn, cos_turn) = turn.sin_cos();
        let alpha = alpha_along(axes, phi + turn);
        let wo = DVec3::new(sin_of(mu), 0.0, mu);
        let lambda = |tan2: f64, alpha: f64| self.ndf.lambda(tan2, alpha, &setting.parameters);
        let alpha_o = alpha_towards(axes, phi);
        let lambda_o = lambda((wo.x / wo.z).powi(2), alpha_o);
        let integrand = |v: f64| {
            let sinh = v.sinh();
            let tan_m = alpha * sinh;
            let cos_m = 1.0 / (1.0 + tan_m * tan_m).sqrt();
            let sin_m = tan_m * cos_m;
            let wm = DVec3::new(sin_m * cos_turn, sin_m * sin_turn, cos_m);
            let cos_d = wo.dot(wm);
            let wi = 2.0 * cos_d * wm - wo;
            let mu_i = f64::clamp(wi.z, 0.0, 1.0);
            let alpha_i = alpha_towards(axes, phi + wi.y.atan2(wi.x));
            let lambda_i = lambda((sin_of(mu_i) / mu_i).powi(2), alpha_i);
            let facet = Facet {
                mu: [mu_i, mu],
                lambda: [lambda_i, lambda_o],
                cos_d,
                cos_m,
                alpha: [alpha_i, alpha_o],
            };
            let g2 = self.masking.g2(&facet);
            let d = self.d(cos_m * cos_m, tan_m * tan_m, phi + turn, axes, setting);
            let solid_angle = sin_m * cos_m * cos_m * alpha * (1.0 + sinh * sinh).sqrt();
            let value = d * g2 * cos_d / mu * solid_angle * weight;
            self.fresnel.weights(cos_d, 1.0 - cos_d, &setting.parameters).map(|fresnel| value * fresnel)
        };
        // cos θi = 0: μ tan² − 2 s cos φ tan − μ = 0.
        let x = sin_of(mu) * cos_turn;
        let root = x.hypot(mu);
        let tan_max = if x > 0.0 { (x + root) / mu } else { mu / (root - x) };
        integrate(integrand, &even_breaks(0.0, (tan_max / alpha).asinh(), PANEL), tolerance).value_or_nan()
    }
}

/// [αx, αy].
fn axes(&Setting { alpha, parameters, .. }: &Setting) -> [f64; 2] {
    let [aspect, strength] = [parameters.aspect, parameters.strength];
    // With a strength, no α is below 1e-6.
    let alpha = if strength > 0.0 { alpha.max(1e-6) } else { alpha };
    let along = alpha * aspect.sqrt();
    [along * (1.0 - strength * strength) + strength * strength, alpha / aspect.sqrt()]
}

/// α of slopes along an azimuth.
fn alpha_along([x, y]: [f64; 2], phi: f64) -> f64 {
    1.0 / (phi.cos() / x).hypot(phi.sin() / y)
}

/// α that Λ sees from an azimuth: Heitz 2014, eq. 80.
fn alpha_towards([x, y]: [f64; 2], phi: f64) -> f64 {
    (phi.cos() * x).hypot(phi.sin() * y)
}
