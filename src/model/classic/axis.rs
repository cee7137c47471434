//! (n + 2)/(2π) cosⁿγ about an axis in the plane of incidence, n = 2/α² − 1: Phong's lobe and Lafortune's. Twin of
//! `shaders/classic/axis.wgsl`; and where such a lobe lives.

use crate::base::half_angle::{Azimuth, Pair};
use crate::base::quadrature::gauss_legendre;
use crate::base::tolerance::decade;
use crate::model::directions::{Fixed, Sample};
use crate::model::parameters::Setting;
use crate::model::{Part, part};
use std::f64::consts::{FRAC_PI_2, TAU};

pub(super) const PART: Part = part!("classic/axis", "elementary");

/// The relative error of such a lobe's values in f32, in units of 2⁻²⁴, where f is above [`FAINT`]: the 40 of every lobe;
/// of the exponent −n ln cos γ, which is 34 at most there, seventeen roundings (four of n, seven of both cosines, six of
/// the logarithm); and where cos γ, a difference, is small, its four roundings, which count most at n = 1: (3/2π) 4/FAINT.
pub(super) const AXIS_F32: f64 = (40.0 + 17.0 * 34.0 + 4.0 * 3.0 / TAU / FAINT) / (1 << 24) as f64;

/// f below which errors are absolute, sr⁻¹: towards γ = 90° cos γ is 0 by cancellation, of no structure that angles have.
pub(crate) const FAINT: f64 = 1e-3;

/// α below which the lobe is a delta to the last tolerance: ρ is off by less than α.
const NARROW: f64 = 1e-10;

pub(super) fn is_narrow(s: &Setting) -> bool {
    s.alpha < NARROW
}

/// The lobe, of cos γ and 1 − cos γ; 0 behind the axis.
pub(super) fn power(cosine: f64, complement: f64, &Setting { alpha, .. }: &Setting) -> [f64; 2] {
    if cosine <= 0.0 {
        return [0.0; 2];
    }
    let a2 = alpha * alpha;
    let root = (-0.5 * (2.0 - a2) / a2 * (complement / cosine).ln_1p()).exp();
    [(2.0 + a2) / (TAU * a2) * root * root, 0.0]
}

/// Lafortune's matrix C with Cx = Cy; Cu is the axis of ωi = u.
pub(super) struct LobeAxis {
    pub cxy: f64,
    pub cz: f64,
}

impl LobeAxis {
    /// Phong's.
    pub const MIRROR: Self = Self { cxy: -1.0, cz: 1.0 };

    /// Sine and cosine of the angle of Cu to the normal.
    fn of(&self, mu: f64, sin: f64) -> [f64; 2] {
        let (x, z) = (self.cxy.abs() * sin, self.cz * mu);
        let length = x.hypot(z);
        // C = 0 has no axis, and no lobe.
        if length > 0.0 { [x / length, z / length] } else { [0.0, 1.0] }
    }

    /// ρ_dh of the narrowest lobe: all of it is there where |Cu| = 1, by 1 − |Cu|², and none where it is less.
    pub fn narrow(&self, mu: f64) -> f64 {
        let Self { cxy, cz } = *self;
        let across = (1.0 - cxy) * (1.0 + cxy) * (1.0 - mu) * (1.0 + mu);
        if across + (1.0 - cz) * (1.0 + cz) * mu * mu > 0.0 { 0.0 } else { cz * mu }
    }
}

/// Directions and what they weigh. With w across the plane of incidence, q = √(1 − w²), and β in it from the axis towards the
/// normal, cos γ = q cos β, cos θe = q cos (θ − β) and dω = dβ dw, θ the axis' angle: the integrand is a product,
///
/// ```text
/// cosⁿγ cos θe dω = qⁿ⁺¹ dw · cosⁿβ cos(θ − β) dβ,   β from θ − π/2, the horizon, to π/2
/// ```
///
/// and cosⁿ⁺¹β = e^(−r²), qⁿ⁺² = e^(−t²) are analytic maps of both for any n, up to where the rest is small.
pub(super) fn samples(fixed: &Fixed, axis: &LobeAxis, alpha: f64, tolerance: f64) -> Vec<Sample> {
    let (mu, sin) = (fixed.mu, fixed.sin());
    let normal = axis.of(mu, sin);
    let [sin_axis, cos_axis] = normal;
    // k = 2/(n + 1), l = 2/(n + 2)
    let k = alpha * alpha;
    let l = 2.0 * k / (2.0 + k);
    let edge = -(REST * tolerance).ln();
    // cos β = sin θ at the horizon
    let horizon = (-(-cos_axis * cos_axis).ln_1p() / k).min(edge).sqrt();
    let edge = edge.sqrt();
    let [across, along] = counts(tolerance).map(|count| if fixed.factored { 2 * count } else { count });
    let (across, along) = (gauss_legendre(across), gauss_legendre(along));
    let mut samples = Vec::new();
    for node in across {
        let t = edge * node.x;
        let q = (-0.5 * l * t * t).exp();
        let w = (-(-l * t * t).exp_m1()).sqrt();
        // dw = l t q²/w dt, of both halves
        let dw = 2.0 * l * t * q * q / w * edge * node.weight;
        let stops = stops(fixed, q, k, normal, [-horizon, edge]);
        for panel in stops.windows(2) {
            let (start, width) = (panel[0], panel[1] - panel[0]);
            for node in &along {
                let r = start + width * node.x;
                let cos = (-0.5 * k * r * r).exp();
                let sin_beta = (-(-k * r * r).exp_m1()).sqrt().copysign(r);
                // dβ = k r cot β dr
                let slope = if sin_beta == 0.0 { alpha } else { k * r * cos / sin_beta };
                let mu_e = q * (cos_axis * cos + sin_axis * sin_beta);
                let x = q * (sin_axis * cos - cos_axis * sin_beta);
                if mu_e <= 0.0 {
                    continue;
                }
                let sin_e = x.hypot(w);
                let [sin2, cos2] = half_angle(x, w, sin_e);
                let mut pair = Pair::of_cosines_and_sines([mu, mu_e], [sin, sin_e]);
                if axis.cxy.abs() == axis.cz {
                    // What is left of 1 − cos γ: of cosines that nearly agree it would have no digits.
                    let complement = -(-0.5 * (k * r * r + l * t * t)).exp_m1();
                    pair.sd = (0.5 * complement - pair.ss * sin2).max(0.0);
                }
                // The axis is where the mirror direction is, or where ωi is.
                let [sin2, cos2] = if axis.cxy > 0.0 { [cos2, sin2] } else { [sin2, cos2] };
                let delta = 2.0 * sin2.sqrt().atan2(cos2.sqrt());
                let azimuth = Azimuth { sin2, cos2, ..Azimuth::at(fixed.phi, delta) };
                samples.push(Sample { pair, azimuth, weight: dw * slope * width * node.weight * mu_e });
            }
        }
    }
    samples
}

/// sin² and cos² of half the angle from the first axis to (x, w), whose length is `s`.
fn half_angle(x: f64, w: f64, s: f64) -> [f64; 2] {
    if s == 0.0 {
        return [0.0, 1.0];
    }
    let small = 0.5 * (w / s) * (w / (s + x.abs()));
    if x < 0.0 { [1.0 - small, small] } else { [small, 1.0 - small] }
}

/// r from the first end to the last, and between where factors have kinks: q cos(θ − β) is one of their cosines there.
fn stops(fixed: &Fixed, q: f64, k: f64, [sin, cos]: [f64; 2], [first, last]: [f64; 2]) -> Vec<f64> {
    let theta = sin.atan2(cos);
    let beta = |&kink: &f64| [-1.0, 1.0].map(|side| theta + side * (kink / q).min(1.0).acos());
    let inside =
        fixed.kinks.iter().filter(|&&kink| kink < q).flat_map(beta).filter(|beta| beta.abs() < FRAC_PI_2);
    let r = |beta: f64| (-2.0 * beta.cos().ln() / k).sqrt().copysign(beta);
    let mut stops: Vec<_> =
        inside.map(r).filter(|r| (first..last).contains(r)).chain([first, last]).collect();
    stops.sort_by(f64::total_cmp);
    stops
}

/// The share of the tolerance that is beyond the last r and t.
const REST: f64 = 0.05;

/// Nodes in t, of half the plane, and in r, for tolerances 1e-1 … 1e-10, measured: the error of each count alone, and that
/// of the next, worst over θ and α, is below 0.4 of the tolerance.
fn counts(tolerance: f64) -> [usize; 2] {
    const COUNTS: [[usize; 2]; 10] =
        [[3, 5], [4, 8], [6, 11], [7, 13], [9, 16], [10, 19], [12, 21], [13, 26], [14, 30], [16, 34]];
    COUNTS[decade(tolerance)]
}

/// At most so many.
pub(super) fn most(tolerance: f64) -> usize {
    counts(tolerance).iter().product()
}
