//! Fresnel's equations for a conductor.

use crate::fresnel::complex::Complex;
use crate::fresnel::{Fresnel, mean};
use crate::setting::Parameters;

/// Born & Wolf 1999, section 14.2: as for a dielectric (section 1.5.2, eq. 21), with n = η + ik in place of the
/// index and, by Snell's law, n cos θt = √(n² − sin²θ).
pub(crate) struct Conductor;

impl Fresnel for Conductor {
    fn weights(&self, cos_d: f64, _one_minus_cos_d: f64, p: &Parameters) -> [f64; 2] {
        let n = Complex { re: p.eta, im: p.k };
        let (one, c) = (Complex::from(1.0), Complex::from(cos_d));
        if n == one {
            return [0.0; 2]; // no surface, also where g + c = 0
        }
        let e = (n - one) * (n + one); // n² − 1
        let g = (e + c * c).sqrt(); // n cos θt, as n² − sin²θ = n² − 1 + cos²θ
        // c − g = (c² − g²)/(c + g), which keeps its digits as n → 1.
        let r_s = (Complex::from(0.0) - e) / ((c + g) * (c + g));
        let r_p = (n * n * c - g) / (n * n * c + g);
        [0.5 * (r_s.norm2() + r_p.norm2()), 0.0]
    }

    fn mean(&self, p: &Parameters) -> [f64; 2] {
        let (eta, k) = (p.eta, p.k);
        let e = Complex { re: (eta - 1.0) * (eta + 1.0) - k * k, im: 2.0 * eta * k };
        mean(|mu| self.weights(mu, 1.0 - mu, p), e.norm2().sqrt().sqrt())
    }
}
