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
use std::iter::successors;

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
/// The integral over r is noise to the one over χ, so it has to be finer by this factor.
const FINER: f64 = 0.1;
/// ρ_dh is noise to its mean over φ; its own error is far below what it is asked for.
const FINER_OF_MEAN: f64 = 0.3;
/// The integrand varies on the scale 1 in v.
const PANEL: f64 = 3.0;
/// A quarter of a turn varies on the scale 1 in u.
const QUARTER: f64 = 5.0;
/// The ratio of neighbouring breaks about the edge of the disc.
const GRADE: f64 = 8.0;
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
        let axes @ [x, y] = axes(setting);
        if axes == [0.0; 2] {
            return self.fresnel.mean(&setting.parameters);
        }
        // ωo sees another α within this of the axis of the larger one: δφ = ratio sinh u. The quarters are mirror images.
        let (ratio, sharp) = if x < y { (x / y, 0.0) } else { (y / x, FRAC_PI_2) };
        let breaks = even_breaks(0.0, (FRAC_PI_2 / ratio).asinh(), QUARTER);
        let mean = |mu: f64, tolerance: f64| {
            let integrand = |u: f64| {
                let phi = (sharp - ratio * u.sinh()).abs();
                let weight = ratio * u.cosh() / FRAC_PI_2;
                let tolerance = FINER_OF_MEAN * tolerance / weight.max(FINER);
                self.rho_dh_within(tolerance, mu, phi, setting).map(|rho| weight * rho)
            };
            integrate(integrand, &breaks, tolerance).value_or_nan()
        };
        definition::rho_hh_within(setting.tolerance(FINEST_MEAN), x.max(y), mean)
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

    /// ρ over the slopes p = tan θm (cos φm, sin φm) that reflect ωo above the horizon, which are the disc
    /// |p − tan θo ô| ≤ 1/μ, with ô the azimuth of ωo as a vector: p = r (αx cos χ, αy sin χ), in which D depends on r alone.
    fn rho_dh_within(&self, tolerance: f64, mu: f64, phi: f64, setting: &Setting) -> [f64; 2] {
        let mu = mu.clamp(MIN_MU, 1.0);
        let axes @ [x, y] = axes(setting);
        if axes == [0.0; 2] {
            return self.fresnel.weights(mu, 1.0 - mu, &setting.parameters);
        }
        let (sin_phi, cos_phi) = phi.sin_cos();
        // The edge of the disc passes the origin where p is perpendicular to ô, the closer the more ωo grazes: r falls there
        // from the far side's to 1 within this width.
        let edge = (x * cos_phi).atan2(-y * sin_phi);
        let at_edge = (x * edge.cos()).hypot(y * edge.sin());
        let width = at_edge.min(1.0) * mu / (sin_of(mu) * alpha_towards(axes, phi)).max(f64::MIN_POSITIVE);
        // Less than the tolerance lies within so much of χ.
        let width = width.max(FINER * tolerance);
        let widths = successors(Some(width), |width| Some(GRADE * width)).take_while(|&w| w < 1.0);
        let widths: Vec<_> = widths.collect();
        let half = |edge: f64| {
            let offsets =
                widths.iter().flat_map(|&width| [-width, width]).chain([-FRAC_PI_2, 0.0, FRAC_PI_2]);
            let mut breaks: Vec<_> = offsets.map(|offset| edge + offset).collect();
            breaks.sort_by(f64::total_cmp);
            let slice = |chi: f64| self.slice(FINER * tolerance, mu, [cos_phi, sin_phi], chi, setting);
            integrate(slice, &breaks, 0.5 * tolerance).value_or_nan()
        };
        let ([a, b], [c, d]) = (half(edge), half(edge + PI));
        [a + c, b + d]
    }

    /// The integral over r = sinh v at an azimuth χ: per unit of v, D changes by a bounded factor.
    fn slice(&self, tolerance: f64, mu: f64, towards: [f64; 2], chi: f64, setting: &Setting) -> [f64; 2] {
        let [x, y] = axes(setting);
        let (sin_chi, cos_chi) = chi.sin_cos();
        let e = [x * cos_chi, y * sin_chi];
        // α along p, as 1/α² = cos²φm/αx² + sin²φm/αy².
        let alpha = e[0].hypot(e[1]);
        let sin = sin_of(mu);
        let wo = DVec3::new(sin * towards[0], sin * towards[1], mu);
        let lambda = |w: DVec3| {
            let sin2 = w.x * w.x + w.y * w.y;
            let tan2 = sin2 / (w.z * w.z);
            // Eq. 80, by the components of w in place of its azimuth, of which the normal has none.
            let seen = (x * w.x).powi(2) + (y * w.y).powi(2);
            let alpha = if sin2 > 0.0 { (seen / sin2).sqrt() } else { x };
            (self.ndf.lambda(tan2, alpha, &setting.parameters), alpha)
        };
        let (lambda_o, alpha_o) = lambda(wo);
        let integrand = |v: f64| {
            let r = v.sinh();
            let p = [r * e[0], r * e[1]];
            let tan2_m = p[0] * p[0] + p[1] * p[1];
            let cos2_m = 1.0 / (1.0 + tan2_m);
            let cos_m = cos2_m.sqrt();
            let wm = DVec3::new(p[0] * cos_m, p[1] * cos_m, cos_m);
            let cos_d = wo.dot(wm);
            let mut wi = 2.0 * cos_d * wm - wo;
            wi.z = wi.z.clamp(0.0, 1.0);
            let (lambda_i, alpha_i) = lambda(wi);
            let facet = Facet {
                mu: [wi.z, mu],
                lambda: [lambda_i, lambda_o],
                cos_d,
                cos_m,
                alpha: [alpha_i, alpha_o],
            };
            let g2 = self.masking.g2(&facet);
            // Heitz 2014, eq. 83 and 85, and dωm = cos³θm dp, dp = αx αy r dr dχ.
            let d = self.ndf.d(cos2_m, tan2_m, alpha, &setting.parameters) * alpha * alpha;
            let solid_angle = cos2_m * cos_m * r * (1.0 + r * r).sqrt();
            let value = d * g2 * cos_d / mu * solid_angle;
            self.fresnel.weights(cos_d, 1.0 - cos_d, &setting.parameters).map(|fresnel| value * fresnel)
        };
        // |p − tan θo ô| = 1/μ: μ α² r² − 2 s (e·ô) r − μ = 0.
        let along = sin * (e[0] * towards[0] + e[1] * towards[1]);
        let root = along.hypot(mu * alpha);
        let end = if along > 0.0 { (along + root) / (mu * alpha * alpha) } else { mu / (root - along) };
        integrate(integrand, &even_breaks(0.0, end.asinh(), PANEL), tolerance).value_or_nan()
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
