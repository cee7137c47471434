//! Schlick's masking, whatever its k: G1 = μ / (μ (1 − k) + k). Twin of `shaders/masking/schlick.wgsl`.

use crate::model::Term;
use crate::model::masking::{Masking, MaskingCounts, Toward};
use crate::model::ndf::Ndf;
use crate::model::parameters::Setting;

/// A choice of k.
pub(crate) trait SchlickMasking {
    const TERM: Term;

    const UNBOUNDED_OFF_PEAK: Option<&'static str> = None;

    /// In [0, 1/2].
    fn k(alpha: f64) -> f64;
}

impl<S: SchlickMasking> Masking for S {
    const TERM: Term = S::TERM;
    const UNBOUNDED_OFF_PEAK: Option<&'static str> = S::UNBOUNDED_OFF_PEAK;

    const COUNTS: Option<MaskingCounts> = Some(|correlated, _| correlated.map(|counts| counts.more(1.25)));
    const SPREADS: bool = true;

    fn visibility<N: Ndf>(i: &Toward, e: &Toward) -> f64 {
        let below = |w: &Toward| below(w.mu, S::k(w.setting.alpha));
        0.25 / (below(i) * below(e))
    }

    fn masking<N: Ndf>(x: f64, y: f64, mu_e: f64, s: &Setting) -> f64 {
        let k = S::k(s.alpha);
        2.0 / mu_e * below(mu_e, k) * (mu_e * (1.0 - k) * x + k * y)
    }

    fn mirror(mu: f64) -> f64 {
        (mu / below(mu, S::k(0.0))).powi(2)
    }
}

/// μ (1 − k) + k
fn below(mu: f64, k: f64) -> f64 {
    mu * (1.0 - k) + k
}
