//! The product rule of a diffuse lobe times factors: Gauss–Legendre in θ up to 60°, and from there in asinh(μ/δ), in
//! which the factors are analytic; panels end at kinks.

use crate::integrate::scale::LobeScale;
use crate::model::directions::{Fixed, Sample};
use crate::model::panels::{SPLIT, directions};

/// The node counts and the kinks of a diffuse lobe.
#[derive(Clone, Copy)]
pub(crate) struct DiffuseRule {
    /// The number of nodes in θe and in δφ of each panel, for a tolerance.
    pub counts: fn(tolerance: f64) -> [usize; 2],
    /// Whether f has kinks at θe = θi, and where ωi and ωe are perpendicular in azimuth.
    pub kinked: bool,
}

impl DiffuseRule {
    /// The number of nodes of a panel in θ, in asinh(μ/δ) and in δφ: each unit of asinh(μ/δ) takes one or two.
    fn counts(&self, scale: &LobeScale, tolerance: f64) -> [usize; 3] {
        let [theta, phi] = (self.counts)(tolerance);
        let folds = (SPLIT / scale.least_turn()).asinh();
        let per_fold = 0.5 - 0.25 * tolerance.log10();
        [theta + 4, theta + 4 + (folds * per_fold) as usize, phi]
    }

    /// The largest number of directions of an integral.
    pub fn max_cost(&self, scale: &LobeScale, tolerance: f64) -> usize {
        let [theta, mu, phi] = self.counts(scale, tolerance);
        (2 + scale.max_kinks()) * (theta + mu) * phi * 2
    }

    /// The directions for a fixed one, with weights cos θ dω.
    pub fn samples(&self, fixed: &Fixed, scale: &LobeScale, tolerance: f64) -> Vec<Sample> {
        let mut kinks = fixed.kinks.clone();
        kinks.extend(self.kinked.then_some(fixed.mu));
        directions(fixed, scale.least_turn(), &kinks, self.counts(scale, tolerance), self.kinked)
    }
}
