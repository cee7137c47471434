//! Integrals over directions that the host finds for each texel: the model maps nodes to where its lobe is, whatever the
//! lobe's shape. The rule is for models that need no kernel with a map; a direction takes 100 ns on the host.

use crate::base::tolerance::{FACTOR_SHARE, FINEST};
use crate::integrate::product_rule::DiffuseRule;
use crate::integrate::scale::LobeScale;
use crate::model::directions::{Fixed, Map, Sample};
use crate::model::parameters::Setting;
use rayon::prelude::*;

/// The inner integrals over listed directions, one for each (setting, fixed direction).
#[derive(Clone)]
pub(crate) struct DirectionRule {
    source: DirectionSource,
    pub fixed: Vec<Fixed>,
    pub settings: Vec<Setting>,
    pub tolerance: f64,
    /// The factors that multiply the lobe at each setting; empty where it has none.
    scales: Vec<LobeScale>,
    /// Whether the fixed direction is ωe.
    fixed_is_exitant: bool,
}

/// The origin of a rule's directions.
#[derive(Clone, Copy)]
pub(crate) enum DirectionSource {
    /// The map of the model.
    Map(Map),
    /// The product rule of a diffuse lobe.
    Product(DiffuseRule),
    /// The one direction of a delta: (A, B) in closed form.
    Delta(fn(mu: f64, &Setting) -> [f64; 2]),
}

/// An inner integral: a sum over directions, or (A, B) in closed form.
pub(crate) enum DirectionSum {
    Samples(Vec<Sample>),
    Limit([f64; 2]),
}

impl DirectionRule {
    pub fn new(source: DirectionSource, fixed: Vec<Fixed>, settings: Vec<Setting>, tolerance: f64) -> Self {
        Self { source, fixed, settings, tolerance, scales: Vec::new(), fixed_is_exitant: false }
    }

    /// The rule of the lobe times factors.
    pub fn times(self, scales: Vec<LobeScale>, fixed_is_exitant: bool) -> Self {
        // The counts of a map are for its lobe alone: at α = 1, a lobe times Turquin's factor is off by 9e-6 at 1e-6.
        let tolerance = (FACTOR_SHARE * self.tolerance).max(FINEST);
        Self { scales, fixed_is_exitant, tolerance, ..self }
    }

    /// Whether factors multiply the lobe.
    pub fn has_factors(&self) -> bool {
        !self.scales.is_empty()
    }

    /// The inner integral of an index, in which the fixed direction turns fastest.
    pub fn integral(&self, index: usize) -> DirectionSum {
        self.integral_by(index, &|fixed, setting| match self.source {
            DirectionSource::Map(map) => (map.samples)(fixed, setting, self.tolerance),
            DirectionSource::Product(_) | DirectionSource::Delta(_) => Vec::new(),
        })
    }

    /// The same over the directions that `map_samples` gives, of lobes that have a map.
    pub fn integral_by(
        &self,
        index: usize,
        map_samples: &dyn Fn(&Fixed, &Setting) -> Vec<Sample>,
    ) -> DirectionSum {
        let row = index / self.fixed.len();
        let (setting, fixed) = (&self.settings[row], &self.fixed[index % self.fixed.len()]);
        let scale = self.scales.get(row).cloned().unwrap_or_default();
        let fixed = &Fixed { kinks: scale.kinks(fixed.mu), ..fixed.clone() };
        let sum = match self.source {
            DirectionSource::Map(map) => match (map.limit)(fixed.mu, setting) {
                Some(limit) => DirectionSum::Limit(limit),
                None => DirectionSum::Samples(map_samples(fixed, setting)),
            },
            DirectionSource::Product(rule) => {
                DirectionSum::Samples(rule.samples(fixed, &scale, self.tolerance))
            }
            DirectionSource::Delta(limit) => DirectionSum::Limit(limit(fixed.mu, setting)),
        };
        if scale.is_one() {
            return sum;
        }
        let factor = |other: f64| match self.fixed_is_exitant {
            true => scale.value(other, fixed.mu),
            false => scale.value(fixed.mu, other),
        };
        match sum {
            DirectionSum::Limit(limit) => DirectionSum::Limit(limit.map(|x| x * factor(fixed.mu))),
            DirectionSum::Samples(mut samples) => {
                samples.iter_mut().for_each(|sample| sample.weight *= factor(sample.pair.mu_e));
                DirectionSum::Samples(samples)
            }
        }
    }

    /// The inner integrals of a range of indices, on all cores.
    pub fn integrals(&self, range: std::ops::Range<usize>) -> Vec<DirectionSum> {
        range.into_par_iter().map(|index| self.integral(index)).collect()
    }

    /// The largest number of evaluations of an inner integral.
    pub fn max_cost(&self) -> usize {
        let cost = |(row, setting): (usize, &Setting)| match self.source {
            DirectionSource::Map(map) => {
                // Each kink makes two more panels in each azimuth, and factors take twice the nodes in both dimensions.
                let factored = self.fixed.iter().any(|fixed| fixed.factored);
                let panels = 1 + 2 * self.scales.get(row).map_or(0, LobeScale::max_kinks);
                let nodes = if factored { 4 } else { 1 };
                panels * nodes * (map.most)(setting, self.tolerance)
            }
            DirectionSource::Product(rule) => {
                rule.max_cost(&self.scales.get(row).cloned().unwrap_or_default(), self.tolerance)
            }
            DirectionSource::Delta(_) => 1,
        };
        self.settings.iter().enumerate().map(cost).max().unwrap_or(1)
    }
}
