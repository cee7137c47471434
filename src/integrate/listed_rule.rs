//! Integrals over directions that the host finds for each texel: the model maps nodes to where its lobe is, whatever the
//! lobe's shape. The rule is for models that need no kernel with a map; a direction takes 100 ns on the host.

use crate::base::tolerance::{FACTOR_SHARE, FINEST};
use crate::integrate::product_rule::DiffuseRule;
use crate::integrate::scale::LobeScale;
use crate::model::directions::{Fixed, Map, Sample};
use crate::model::parameters::Setting;
use crate::model::{Facet, FacetSum, Model};
use rayon::prelude::*;

/// The inner integrals over listed directions, one for each (setting, fixed direction).
#[derive(Clone)]
pub(crate) struct ListedRule {
    source: ListedSource,
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
pub(crate) enum ListedSource {
    /// The map of the model.
    Map(Map),
    /// The product rule of a diffuse lobe.
    Product(DiffuseRule),
    /// The one direction of a delta: (A, B) in closed form.
    Delta(fn(mu: f64, &Setting) -> [f64; 2]),
}

/// An inner integral: a sum over directions, or (A, B) in closed form.
pub(crate) enum ListedSum {
    Samples(Vec<Sample>),
    Limit([f64; 2]),
}

/// An inner integral's setting, its fixed direction with the factors' kinks, and the factors.
pub(crate) struct At {
    pub setting: Setting,
    pub fixed: Fixed,
    pub scale: LobeScale,
}

impl ListedRule {
    pub fn new(source: ListedSource, fixed: Vec<Fixed>, settings: Vec<Setting>, tolerance: f64) -> Self {
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

    /// The inner integral of an index, in which the fixed direction turns fastest, as directions.
    pub fn integral(&self, index: usize) -> ListedSum {
        let At { setting, fixed, scale } = &self.at(index);
        let sum = match self.source {
            ListedSource::Map(map) => match (map.limit)(fixed.mu, setting) {
                Some(limit) => ListedSum::Limit(limit),
                None => ListedSum::Samples((map.samples)(fixed, setting, self.tolerance)),
            },
            ListedSource::Product(rule) => ListedSum::Samples(rule.samples(fixed, scale, self.tolerance)),
            ListedSource::Delta(limit) => ListedSum::Limit(limit(fixed.mu, setting)),
        };
        if scale.is_one() {
            return sum;
        }
        match sum {
            ListedSum::Limit(limit) => {
                ListedSum::Limit(limit.map(|x| x * self.factor(scale, fixed, fixed.mu)))
            }
            ListedSum::Samples(mut samples) => {
                samples.iter_mut().for_each(|s| s.weight *= self.factor(scale, fixed, s.pair.mu_e));
                ListedSum::Samples(samples)
            }
        }
    }

    /// The inner integral of an index of a lobe, by its facets if it has them.
    pub fn sum(&self, index: usize, model: &Model) -> [f64; 2] {
        let mut sum = [0.0; 2];
        let mut add = |weight: f64, [a, b]: [f64; 2]| sum = [sum[0] + weight * a, sum[1] + weight * b];
        if let Some(facets) = self.facets(index, model) {
            let At { setting, fixed, scale } = &self.at(index);
            (facets.visit)(fixed, setting, self.tolerance, None, &mut |Facet { c, mu_e, weight }| {
                let factor = if scale.is_one() { 1.0 } else { self.factor(scale, fixed, mu_e) };
                add(factor * weight, (facets.fresnel)(c, 1.0 - c, setting));
            });
            return sum;
        }
        match self.integral(index) {
            ListedSum::Limit(limit) => return limit,
            ListedSum::Samples(samples) => {
                let setting = &self.settings[self.place(index)[0]];
                for Sample { pair, azimuth, weight } in &samples {
                    add(*weight, (model.lobe)(pair, azimuth, setting));
                }
            }
        }
        sum
    }

    /// How a lobe's facets are visited, where its integral of an index has facets.
    pub fn facets(&self, index: usize, model: &Model) -> Option<&'static FacetSum> {
        let facets = model.microfacet?.facets.as_ref()?;
        let ListedSource::Map(map) = self.source else { return None };
        let [row, column] = self.place(index);
        (map.limit)(self.fixed[column].mu, &self.settings[row]).is_none().then_some(facets)
    }

    /// The places of an index's setting and fixed direction.
    fn place(&self, index: usize) -> [usize; 2] {
        [index / self.fixed.len(), index % self.fixed.len()]
    }

    /// What an inner integral of an index has.
    pub fn at(&self, index: usize) -> At {
        let [row, column] = self.place(index);
        let scale = self.scales.get(row).cloned().unwrap_or_default();
        let fixed = &self.fixed[column];
        let fixed = Fixed { kinks: scale.kinks(fixed.mu), ..fixed.clone() };
        At { setting: self.settings[row], fixed, scale }
    }

    /// The factors at the cosine of the other direction.
    fn factor(&self, scale: &LobeScale, fixed: &Fixed, other: f64) -> f64 {
        match self.fixed_is_exitant {
            true => scale.value(other, fixed.mu),
            false => scale.value(fixed.mu, other),
        }
    }

    /// The inner integrals of a range of indices, on all cores.
    pub fn integrals(&self, range: std::ops::Range<usize>) -> Vec<ListedSum> {
        range.into_par_iter().map(|index| self.integral(index)).collect()
    }

    /// The largest number of evaluations of an inner integral.
    pub fn max_cost(&self) -> usize {
        let cost = |(row, setting): (usize, &Setting)| match self.source {
            ListedSource::Map(map) => {
                // Each kink makes two more panels in each azimuth, and factors take twice the nodes in both dimensions.
                let factored = self.fixed.iter().any(|fixed| fixed.factored);
                let panels = 1 + 2 * self.scales.get(row).map_or(0, LobeScale::max_kinks);
                let nodes = if factored { 4 } else { 1 };
                panels * nodes * (map.most)(setting, self.tolerance)
            }
            ListedSource::Product(rule) => {
                rule.max_cost(&self.scales.get(row).cloned().unwrap_or_default(), self.tolerance)
            }
            ListedSource::Delta(_) => 1,
        };
        self.settings.iter().enumerate().map(cost).max().unwrap_or(1)
    }
}
