//! Azimuths of the microfacet normal about ωe, and the horizon of ωi at each.

use crate::base::quadrature::Node;
use crate::base::tolerance::is_fine;
use std::f64::consts::{FRAC_PI_2, PI};

/// An azimuth φ of ωm from that of ωe, and the horizon of ωi there.
pub(crate) struct Turn {
    pub sin: f64,
    pub cos: f64,
    /// tan θe cos φ
    pub c: f64,
    /// tan θm of the normal that reflects ωe onto the horizon.
    pub t_max: f64,
    /// dφ/2π, of all azimuths that it stands for: where one half mirrors the other, dφ/π.
    pub weight: f64,
}

impl Turn {
    /// t_max = c + √(c² + 1), without cancellation where c < 0.
    pub fn new(tan: f64, [cos, sin]: [f64; 2], weight: f64) -> Self {
        let c = tan * cos;
        let root = c.hypot(1.0);
        let t_max = if c > 0.0 { c + root } else { 1.0 / (root - c) };
        Self { sin, cos, c, t_max, weight }
    }
}

/// Azimuths φ = π/2 ∓ d sinh u of ωm from ωe's, u ∈ [0, asinh(π/2d)]: the horizon turns within μ of
/// φ = π/2.
pub(crate) fn turns(mu: f64, sign: f64, rule: &[Node], d: f64) -> impl Iterator<Item = Turn> {
    let tan = ((1.0 - mu) * (1.0 + mu)).sqrt() / mu;
    let u_max = (FRAC_PI_2 / d).asinh();
    rule.iter().map(move |node| {
        let u = u_max * node.x;
        let (sin_turned, cos_turned) = (d * u.sinh()).sin_cos();
        Turn::new(tan, [sign * sin_turned, cos_turned], node.weight * u_max * d * u.cosh() / PI)
    })
}

/// u/u_max of the azimuth where tan θe cos φ is c > 0, if there is one.
pub(crate) fn turn_of(mu: f64, c: f64, d: f64) -> Option<f64> {
    let cos = c * mu / ((1.0 - mu) * (1.0 + mu)).sqrt();
    (cos < 1.0).then(|| (cos.asin() / d).asinh() / (FRAC_PI_2 / d).asinh())
}

/// d for the kernel. Found by search: smaller wastes nodes on a turn that contributes nothing, larger misses it.
pub(crate) fn turn_scale(mu: f64, tolerance: f64) -> f64 {
    mu.max(if is_fine(tolerance) { 1e-3 } else { 0.1 })
}

/// [`turns`] as the kernel takes them: (μe c, t_max, 1/t_max, weight).
pub(crate) fn side(mu: f64, sign: f64, rule: &[Node], tolerance: f64) -> impl Iterator<Item = [f64; 4]> {
    turns(mu, sign, rule, turn_scale(mu, tolerance))
        .map(move |turn| [mu * turn.c, turn.t_max, 1.0 / turn.t_max, turn.weight])
}
