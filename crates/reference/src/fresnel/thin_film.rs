//! A thin film on a base, by the phases of what it reflects.

use crate::fresnel::{Fresnel, mean};
use crate::setting::Parameters;
use std::f64::consts::{PI, TAU};

/// Belcour & Barla 2017, with the approximations of KHR_materials_iridescence ("Iridescence Fresnel", ratified 2022):
/// Schlick's reflectances, phases of 0 or π, two orders of interference, the eye's response by four Gaussians.
///
/// Two departures, where the specification has kinks: R12 R23 is not clamped to [1e-5, 0.9999], and in place of
/// max(I, 0) stands (I + √(I² + ε²))/2, ε = 1/256.
pub(crate) struct ThinFilm;

impl Fresnel for ThinFilm {
    fn weights(&self, cos_d: f64, one_minus_cos_d: f64, p: &Parameters) -> [f64; 2] {
        let film = Film::new(p);
        let cos_film = (film.contrast() + cos_d * cos_d).sqrt() / film.eta; // Snell: η cosθ₂ = √(η² − sin²θ₁)
        let path = 2.0 * film.eta * film.thickness * cos_film; // nm

        // What the interfaces reflect, with its phase: a half turn where light comes from the denser side.
        let half_turn = |it: bool| if it { PI } else { 0.0 };
        let r12 = schlick(film.reflectance(1.0, film.eta), one_minus_cos_d);
        let r23 = schlick(film.reflectance(film.eta, film.base), 1.0 - cos_film);
        let phase = half_turn(film.eta >= 1.0) + half_turn(film.base < film.eta);

        // The mean over phases, and the amplitude that every turn within the film multiplies by z (eq. 8 and 9).
        let loss = 1.0 - r12;
        let within = (1.0 - r12 * r23).max(f64::MIN_POSITIVE);
        let inner = loss * loss * r23 / within;
        let amplitude = (r12 * r23).sqrt();
        let [mut i, mut power] = [r12 + inner, 1.0];
        for m in 1..=2 {
            power *= amplitude;
            let seen = film.seen(f64::from(m) * path, f64::from(m) * phase);
            i += 2.0 * (inner - loss) * power * seen;
        }
        [0.5 * (i + i.hypot(FLOOR)), 0.0]
    }

    fn mean(&self, p: &Parameters) -> [f64; 2] {
        let turn = Film::new(p).contrast().sqrt();
        mean(|mu| self.weights(mu, 1.0 - mu, p), turn)
    }
}

struct Film {
    thickness: f64,
    over: f64,
    eta: f64,
    base: f64,
    channel: f64,
}

impl Film {
    fn new(p: &Parameters) -> Self {
        let &Parameters { thickness, film_eta, f0, channel, .. } = p;
        // "Force iridescenceIor -> outsideIor when thickness -> 0": smoothstep(0, 0.03, thickness).
        let t = (thickness / 0.03).clamp(0.0, 1.0);
        let over = (film_eta - 1.0) * (t * t * (3.0 - 2.0 * t));
        // "Assume air interface for top"; 1e-4 is the specification's.
        let root = (f0 + 1e-4).min(1.0).sqrt();
        let base = (1.0 + root) / (1.0 - root);
        Self { thickness, over, eta: 1.0 + over, base, channel }
    }

    /// η² − 1.
    fn contrast(&self) -> f64 {
        self.over * (self.eta + 1.0)
    }

    /// ((n₂ − n₁)/(n₂ + n₁))², also where n₂ is infinite.
    fn reflectance(&self, from: f64, to: f64) -> f64 {
        if to.is_infinite() { 1.0 } else { ((to - from) / (to + from)).powi(2) }
    }

    /// What a channel sees of cos(2π path/λ + phase), path in nm: the Fourier transform of its response over wave
    /// numbers, in units of its response to white (eq. 10 and the supplemental fit).
    fn seen(&self, path: f64, phase: f64) -> f64 {
        let angle = TAU * path * 1e-9;
        let gaussian = |value: f64, peak: f64, variance: f64| {
            value * (TAU * variance).sqrt() * (-angle * angle * variance).exp() * (peak * angle + phase).cos()
                / 1.0685e-7
        };
        let x = gaussian(5.4856e-13, 1.6810e6, 4.3278e9) + gaussian(9.7470e-14, 2.2399e6, 4.5282e9);
        let y = gaussian(4.4201e-13, 1.7953e6, 9.3046e9);
        let z = gaussian(5.2481e-13, 2.2084e6, 6.6121e9);
        let rgb = XYZ_TO_REC709.map(|row| row[0] * x + row[1] * y + row[2] * z);
        let (from, share) = if self.channel < 1.0 { (0, self.channel) } else { (1, self.channel - 1.0) };
        (1.0 - share) * rgb[from] + share * rgb[from + 1]
    }
}

/// F0 + (1 − F0)(1 − c)⁵.
fn schlick(f0: f64, one_minus_c: f64) -> f64 {
    f0 + (1.0 - f0) * one_minus_c.powi(5)
}

const FLOOR: f64 = 1.0 / 256.0;

const XYZ_TO_REC709: [[f64; 3]; 3] = [
    [3.2404542, -1.5371385, -0.4985314],
    [-0.9692660, 1.8760108, 0.0415560],
    [0.0556434, -0.2040259, 1.0572252],
];
