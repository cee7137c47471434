//! Directions for a diffuse lobe times factors: Gauss–Legendre in θ up to 60°, and from there in asinh(μ/δ), in which
//! the factors are analytic; panels end at kinks.

use crate::integrate::scale::Scale;
use crate::model::directions::{Fixed, Sample};
use crate::model::panels::{SPLIT, directions};

/// A diffuse lobe's own rule.
#[derive(Clone, Copy)]
pub(crate) struct Nodes {
    /// In θe and in δφ, in each panel, for a tolerance.
    pub counts: fn(tolerance: f64) -> [usize; 2],
    /// Whether f has kinks at θe = θi, and where ωi and ωe are perpendicular in azimuth.
    pub kinked: bool,
}

impl Nodes {
    /// Nodes of a panel in μ: an e-fold of asinh(μ/δ) takes one or two where the lobe alone takes few.
    fn counts(&self, scale: &Scale, tolerance: f64) -> [usize; 3] {
        let [theta, phi] = (self.counts)(tolerance);
        let folds = (SPLIT / scale.turns_at()).asinh();
        let per_fold = 0.5 - 0.25 * tolerance.log10();
        [theta + 4, theta + 4 + (folds * per_fold) as usize, phi]
    }

    pub fn most(&self, scale: &Scale, tolerance: f64) -> usize {
        let [theta, mu, phi] = self.counts(scale, tolerance);
        (2 + scale.most_kinks()) * (theta + mu) * phi * 2
    }

    /// Directions for a fixed cosine, which weigh cos θ dω.
    pub fn samples(&self, fixed: &Fixed, scale: &Scale, tolerance: f64) -> Vec<Sample> {
        let mut kinks = fixed.kinks.clone();
        kinks.extend(self.kinked.then_some(fixed.mu));
        directions(fixed, scale.turns_at(), &kinks, self.counts(scale, tolerance), self.kinked)
    }
}
