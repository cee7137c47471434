//! f against the subject's independent f64 reference: largest and root mean square relative error, and ULP. Where rounding
//! costs more at some settings than at others, each is held to its own.

use crate::verify::probe::{Probe, is_non_finite};
use crate::verify::{Angles, Property, Subject};

pub(super) struct Agreement {
    tolerance: f64,
    squares: f64,
    count: u64,
    ulp: f64,
    largest: f64,
}

impl Agreement {
    pub fn new(tolerance: f64) -> Self {
        Self { tolerance, squares: 0.0, count: 0, ulp: 0.0, largest: 0.0 }
    }
}

/// f below which errors are taken relative to this, sr⁻¹. A factor that underflows, Schlick's Fc = (1 − c)⁵ towards
/// c = 1, is off by up to 2⁻¹²⁶, and the narrowest lobe, α = 1e-6, multiplies that by up to 1/(4π α²) = 8e10:
/// 1e-27 in f, which is within 1e-6 of values from here on.
pub const FAINT: f64 = 1e-21;

impl Property for Agreement {
    fn name(&self) -> &'static str {
        "agreement"
    }

    fn limit(&self) -> f64 {
        self.tolerance
    }

    fn orbit(&self, input: Angles, orbit: &mut Vec<Angles>) {
        orbit.push(input);
    }

    fn judge(&mut self, subject: &dyn Subject, setting: &[f64], orbit: &[Angles], values: &[f32]) -> f64 {
        let Some(reference) = subject.reference(setting, &orbit[0]) else { return f64::NEG_INFINITY };
        let mut worst = f64::NEG_INFINITY;
        // As if all settings had the tolerance of the worst.
        let scale =
            subject.agreement_at(setting).map_or(1.0, |here| self.tolerance / here.min(self.tolerance));
        for (&value, exact) in values.iter().zip(reference) {
            if is_non_finite(value) || !exact.is_finite() {
                continue;
            }
            let error = (f64::from(value) - exact).abs();
            let relative = error / exact.abs().max(subject.faint());
            self.squares += relative * relative;
            self.count += 1;
            self.ulp = self.ulp.max(error / ulp(exact.abs().max(subject.faint())));
            self.largest = self.largest.max(relative);
            worst = worst.max(scale * relative);
        }
        worst
    }

    fn say(&self, deviation: f64, _: &Probe) -> String {
        let rms = (self.squares / self.count.max(1) as f64).sqrt();
        let share = match deviation > self.largest {
            true => format!(", {:.2} of what rounding may cost where it is most", deviation / self.tolerance),
            false => String::new(),
        };
        format!(
            "within {:.1e} relative of the f64 reference, rms {rms:.1e}, {:.1} ULP at most{share}",
            self.largest, self.ulp
        )
    }
}

/// The spacing of f32 at a positive value.
fn ulp(value: f64) -> f64 {
    value.log2().floor().exp2() * f64::from(f32::EPSILON)
}
