//! Isotropy, f of φe − φi alone; and bilateral symmetry, f of a pair's mirror image.

use crate::verify::probe::{Probe, is_non_finite};
use crate::verify::reciprocity::{difference, relative};
use crate::verify::{Angles, FLOOR, Property, Subject};

/// A turn about the normal rounds both directions anew, which a narrow lobe amplifies. So two bundles are
/// compared, and only what separates them is anisotropy. The pairs of a bundle are turned a little against
/// each other, so that they round differently, and displaced by more than rounding does: however the lobe
/// amplifies it, f scatters within a bundle by more than rounding can be worth.
pub(super) struct Isotropy {
    pub tolerance: f64,
    /// Whether the other bundle is a mirror image as well: bilateral symmetry about a plane of no symmetry.
    pub mirrored: bool,
}

/// Displacements of (θi, θe, φe) in a bundle, in units of [`ROUNDING`].
const BUNDLE: [[f64; 3]; 5] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
/// What rounding a unit vector to f32 turns it by is below 2⁻²⁴ √3 = 1.03e-7 rad; two of them.
const ROUNDING: f64 = 2.1e-7;
/// The turn from pair to pair of a bundle, rad: enough to round anew, too little for anisotropy to show.
const STEP: f64 = 1.3e-4;
/// The bundle that an input is compared with: no axis, no diagonal.
const TURN: f64 = 0.7;
/// Bundles that are apart by more of their scatter than this are not of one distribution.
const SCATTER: f64 = 3.0;

impl Property for Isotropy {
    fn name(&self) -> &'static str {
        if self.mirrored { "bilateral" } else { "isotropy" }
    }

    fn limit(&self) -> f64 {
        self.tolerance
    }

    fn orbit(&self, input: Angles, orbit: &mut Vec<Angles>) {
        // Away from the horizon, so that θ stays a zenith angle.
        let away = |theta: f64, step: f64| if theta < 1.0 { theta + step } else { theta - step };
        let side = if self.mirrored { -1.0 } else { 1.0 };
        for (side, from) in [(1.0, 0.0), (side, TURN - side * input.phi_i)] {
            for (k, steps) in BUNDLE.iter().enumerate() {
                let turn = from + k as f64 * STEP;
                let [i, e, across] = steps.map(|step| step * ROUNDING);
                orbit.push(Angles {
                    theta_i: away(input.theta_i, i),
                    phi_i: side * input.phi_i + turn,
                    theta_e: away(input.theta_e, e),
                    phi_e: side * (input.phi_e + across) + turn,
                });
            }
        }
    }

    fn judge(&mut self, _: &dyn Subject, _: &[f64], _: &[Angles], values: &[f32]) -> f64 {
        if values.iter().any(|&v| is_non_finite(v)) {
            return f64::NEG_INFINITY;
        }
        let channels = values.len() / (2 * BUNDLE.len());
        let (here, there) = values.split_at(values.len() / 2);
        (0..channels)
            .map(|c| {
                let [(mean, scatter), (other, more)] = [here, there].map(|bundle| {
                    let bundle = bundle.iter().skip(c).step_by(channels).map(|&v| f64::from(v));
                    let (low, high) =
                        bundle.clone().fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(v), b.max(v)));
                    (bundle.sum::<f64>() / BUNDLE.len() as f64, high - low)
                });
                let size = mean.abs().max(other.abs()).max(FLOOR);
                ((mean - other).abs() - SCATTER * (scatter + more)).max(0.0) / size
            })
            .fold(f64::NEG_INFINITY, f64::max)
    }

    fn say(&self, deviation: f64, _: &Probe) -> String {
        match deviation {
            _ if self.mirrored => {
                format!(
                    "f of a pair and of its mirror image in a plane of incidence differ by {deviation:.1e} relative"
                )
            }
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
        format!("f of a pair and of its mirror image, φ → −φ, {}", relative(deviation))
    }
}
