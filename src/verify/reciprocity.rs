//! Helmholtz reciprocity: f(ωi, ωe) = f(ωe, ωi).

use crate::verify::probe::Probe;
use crate::verify::{Angles, FLOOR, Property, Subject};

/// Where ωi and ωe are all but opposite, both grazing, h = ωi + ωe is what rounding leaves of a difference, and
/// ωi·h − ωe·h = (|ωi|² − |ωe|²)/|ωi + ωe| is up to 4 roundings over |ωi + ωe|, five times that in
/// Schlick's power. No BRDF of f32 vectors can do better there.
const HALF_VECTOR: f64 = 20.0;

pub(super) struct Reciprocity {
    pub tolerance: f64,
}

impl Property for Reciprocity {
    fn name(&self) -> &'static str {
        "reciprocity"
    }

    fn limit(&self) -> f64 {
        self.tolerance
    }

    fn orbit(&self, input: Angles, orbit: &mut Vec<Angles>) {
        let Angles { theta_i, phi_i, theta_e, phi_e } = input;
        orbit.extend([input, Angles { theta_i: theta_e, phi_i: phi_e, theta_e: theta_i, phi_e: phi_i }]);
    }

    fn judge(&mut self, subject: &dyn Subject, _: &[f64], orbit: &[Angles], values: &[f32]) -> f64 {
        let (there, back) = values.split_at(values.len() / 2);
        let difference = difference(there, back);
        let slack = HALF_VECTOR * subject.rounding() / sum(&orbit[0]).max(f64::MIN_POSITIVE);
        if difference <= slack { difference.min(0.0) } else { difference - slack }
    }

    fn say(&self, deviation: f64, _: &Probe) -> String {
        format!("f(ωi, ωe) and f(ωe, ωi) {}", relative(deviation))
    }
}

/// |ωi + ωe|
fn sum(angles: &Angles) -> f64 {
    let [i, e] = [(angles.theta_i, angles.phi_i), (angles.theta_e, angles.phi_e)]
        .map(|(theta, phi)| [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()]);
    (0..3).map(|k| (i[k] + e[k]).powi(2)).sum::<f64>().sqrt()
}

/// The largest difference over channels, relative to the larger value or to [`FLOOR`]. What is not finite
/// has no difference.
pub(super) fn difference(a: &[f32], b: &[f32]) -> f64 {
    let one = |(&a, &b): (&f32, &f32)| {
        let (a, b) = (f64::from(a), f64::from(b));
        let difference = (a - b).abs() / a.abs().max(b.abs()).max(FLOOR);
        if difference.is_finite() { difference } else { f64::NEG_INFINITY }
    };
    a.iter().zip(b).map(one).fold(f64::NEG_INFINITY, f64::max)
}

pub(super) fn relative(deviation: f64) -> String {
    match deviation {
        0.0 => "are equal, to rounding".into(),
        _ => format!("differ by {deviation:.1e} relative at most"),
    }
}
