//! Isotropy, f of φe − φi alone; and bilateral symmetry, f of a pair's mirror image.

use super::probe::{Probe, is_non_finite};
use super::reciprocity::{difference, relative};
use super::{Angles, FLOOR, Property, Subject};

/// A turn about the normal rounds both directions anew, which a narrow lobe amplifies. So two bundles of
/// turns are compared: f over one scatters by what rounding is worth there, and only what separates the
/// bundles is anisotropy.
pub(super) struct Isotropy {
    pub tolerance: f64,
}

/// Turns in a bundle, and how far apart, rad: enough to round anew, too little for anisotropy to show.
const BUNDLE: usize = 4;
const STEP: f64 = 1.3e-4;
/// The bundle that an input is compared with: no axis, no diagonal.
const TURN: f64 = 0.7;
/// Scatter of two bundles of four that is not the scatter of one distribution.
const SCATTER: f64 = 4.0;

impl Property for Isotropy {
    fn name(&self) -> &'static str {
        "isotropy"
    }

    fn limit(&self) -> f64 {
        self.tolerance
    }

    fn orbit(&self, input: Angles, orbit: &mut Vec<Angles>) {
        let turned = |turn: f64| Angles { phi_i: input.phi_i + turn, phi_e: input.phi_e + turn, ..input };
        let bundle = |from: f64| (0..BUNDLE).map(move |k| turned(from + k as f64 * STEP));
        orbit.extend(bundle(0.0).chain(bundle(TURN - input.phi_i)));
    }

    fn judge(&mut self, _: &dyn Subject, _: &[f64], _: &[Angles], values: &[f32]) -> f64 {
        if values.iter().any(|&v| is_non_finite(v)) {
            return f64::NEG_INFINITY;
        }
        let channels = values.len() / (2 * BUNDLE);
        let (here, there) = values.split_at(values.len() / 2);
        (0..channels)
            .map(|c| {
                let [(mean, scatter), (other, more)] = [here, there].map(|bundle| {
                    let bundle = bundle.iter().skip(c).step_by(channels).map(|&v| f64::from(v));
                    let (low, high) =
                        bundle.clone().fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(v), b.max(v)));
                    (bundle.sum::<f64>() / BUNDLE as f64, high - low)
                });
                let size = mean.abs().max(other.abs()).max(FLOOR);
                ((mean - other).abs() - SCATTER * (scatter + more)).max(0.0) / size
            })
            .fold(f64::NEG_INFINITY, f64::max)
    }

    fn say(&self, deviation: f64, _: &Probe) -> String {
        match deviation {
            0.0 => "a common turn of both directions changes f by no more than their rounding".into(),
            _ => format!("a common turn of both directions changes f by {deviation:.1e} relative"),
        }
    }
}

/// f(θi, φi, θe, φe) = f(θi, −φi, θe, −φe): for an isotropic BRDF, no telling left from right.
pub(super) struct Bilateral {
    pub tolerance: f64,
}

impl Property for Bilateral {
    fn name(&self) -> &'static str {
        "bilateral"
    }

    fn limit(&self) -> f64 {
        self.tolerance
    }

    fn orbit(&self, input: Angles, orbit: &mut Vec<Angles>) {
        orbit.extend([input, Angles { phi_i: -input.phi_i, phi_e: -input.phi_e, ..input }]);
    }

    fn judge(&mut self, _: &dyn Subject, _: &[f64], _: &[Angles], values: &[f32]) -> f64 {
        let (left, right) = values.split_at(values.len() / 2);
        difference(left, right)
    }

    fn say(&self, deviation: f64, _: &Probe) -> String {
        format!("f of a pair and of its mirror image, φ → −φ, differ by {} at most", relative(deviation))
    }
}
