//! f is finite, and f ≥ 0: what the probe counts among all values, hunted where it may be near.

use crate::verify::probe::{Probe, is_non_finite};
use crate::verify::{Angles, Property, Subject};

pub(super) const FINITE: &str = "finite";

/// No value is NaN or infinite. The search climbs on f itself, since what overflows grows first.
pub(super) struct Finite;

impl Property for Finite {
    fn name(&self) -> &'static str {
        FINITE
    }

    fn limit(&self) -> f64 {
        f32::MAX.into()
    }

    fn orbit(&self, input: Angles, orbit: &mut Vec<Angles>) {
        orbit.push(input);
    }

    fn judge(&mut self, _: &dyn Subject, _: &[f64], _: &[Angles], values: &[f32]) -> f64 {
        let size = |&v: &f32| if is_non_finite(v) { f64::INFINITY } else { f64::from(v).abs() };
        values.iter().map(size).fold(0.0, f64::max)
    }

    fn say(&self, deviation: f64, probe: &Probe) -> String {
        match probe.non_finite_extent.broken {
            0 => format!(
                "none of {} pairs is NaN or infinite; largest f {deviation:.3e} sr⁻¹",
                probe.evaluated
            ),
            _ => "NaN or infinite".into(),
        }
    }
}

/// No value is below zero.
pub(super) struct NonNegative;

impl Property for NonNegative {
    fn name(&self) -> &'static str {
        "non-negative"
    }

    fn limit(&self) -> f64 {
        0.0
    }

    fn orbit(&self, input: Angles, orbit: &mut Vec<Angles>) {
        orbit.push(input);
    }

    fn judge(&mut self, _: &dyn Subject, _: &[f64], _: &[Angles], values: &[f32]) -> f64 {
        let depth = |&v: &f32| if is_non_finite(v) { f64::NEG_INFINITY } else { -f64::from(v) };
        values.iter().map(depth).fold(f64::NEG_INFINITY, f64::max)
    }

    fn say(&self, deviation: f64, probe: &Probe) -> String {
        // Plus zero: no "-0".
        let lowest = 0.0 - deviation;
        match probe.negative.broken {
            0 if probe.noise > 0.0 => {
                format!("0 to rounding: down to {:.0e} sr⁻¹, far below an ULP of f elsewhere", -probe.noise)
            }
            0 => format!("none of {} pairs is negative; smallest f {lowest:.3e} sr⁻¹", probe.evaluated),
            _ => format!("negative, down to {lowest:.3e} sr⁻¹"),
        }
    }
}
