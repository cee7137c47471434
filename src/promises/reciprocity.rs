//! Helmholtz reciprocity: f(ωi, ωe) = f(ωe, ωi).

use super::probe::Probe;
use super::{Angles, FLOOR, Property, Subject};

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

    fn judge(&mut self, _: &dyn Subject, _: &[f64], _: &[Angles], values: &[f32]) -> f64 {
        let (there, back) = values.split_at(values.len() / 2);
        difference(there, back)
    }

    fn say(&self, deviation: f64, _: &Probe) -> String {
        format!("f(ωi, ωe) and f(ωe, ωi) {}", relative(deviation))
    }
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
        0.0 => "are equal, bit for bit".into(),
        _ => format!("differ by {deviation:.1e} relative at most"),
    }
}
