//! Integrals by directions that the host finds, each texel its own: whatever a lobe's shape, its model says where it
//! lives. For models that no kernel with a map of its own is worth: a direction takes 100 ns here.

use crate::base::tolerance::{FACTOR_SHARE, FINEST};
use crate::integrate::product_rule::Nodes;
use crate::integrate::scale::Scale;
use crate::model::directions::{Fixed, Map, Sample};
use crate::model::parameters::Setting;
use rayon::prelude::*;

/// Inner integrals for each (setting, fixed direction).
#[derive(Clone)]
pub(crate) struct MappedWork {
    source: Source,
    pub fixed: Vec<Fixed>,
    settings: Vec<Setting>,
    tolerance: f64,
    /// What the lobe is multiplied with at each setting, and whether it is ωe that is fixed; none: by nothing.
    scales: Vec<Scale>,
    fixed_is_exitant: bool,
}

/// Where directions come from.
#[derive(Clone, Copy)]
pub(crate) enum Source {
    Map(Map),
    /// A diffuse lobe's own rule.
    Product(Nodes),
    /// A delta has but one.
    Delta(fn(mu: f64, &Setting) -> [f64; 2]),
}

/// What a texel is: a sum over samples, or a limit in closed form.
pub(crate) enum Texel {
    Samples(Vec<Sample>),
    Limit([f64; 2]),
}

impl MappedWork {
    pub fn new(source: Source, fixed: Vec<Fixed>, settings: Vec<Setting>, tolerance: f64) -> Self {
        Self { source, fixed, settings, tolerance, scales: Vec::new(), fixed_is_exitant: false }
    }

    /// The same of a lobe times factors.
    pub fn times(self, scales: Vec<Scale>, fixed_is_exitant: bool) -> Self {
        // The counts of a map are for its lobe alone: at α = 1 a restored one is off by 9e-6 where 1e-6 is asked for.
        let tolerance = (FACTOR_SHARE * self.tolerance).max(FINEST);
        Self { scales, fixed_is_exitant, tolerance, ..self }
    }

    /// The result `at`, counting fixed directions first.
    pub fn texel(&self, at: usize) -> Texel {
        let row = at / self.fixed.len();
        let (setting, fixed) = (&self.settings[row], &self.fixed[at % self.fixed.len()]);
        let scale = self.scales.get(row).cloned().unwrap_or_default();
        let fixed = &Fixed { kinks: scale.kinks(fixed.mu), ..fixed.clone() };
        let texel = match self.source {
            Source::Map(map) => match (map.limit)(fixed.mu, setting) {
                Some(limit) => Texel::Limit(limit),
                None => Texel::Samples((map.samples)(fixed, setting, self.tolerance)),
            },
            Source::Product(nodes) => Texel::Samples(nodes.samples(fixed, &scale, self.tolerance)),
            Source::Delta(limit) => Texel::Limit(limit(fixed.mu, setting)),
        };
        if scale.is_one() {
            return texel;
        }
        let factor = |other: f64| match self.fixed_is_exitant {
            true => scale.at(other, fixed.mu),
            false => scale.at(fixed.mu, other),
        };
        match texel {
            Texel::Limit(limit) => Texel::Limit(limit.map(|x| x * factor(fixed.mu))),
            Texel::Samples(mut samples) => {
                samples.iter_mut().for_each(|sample| sample.weight *= factor(sample.pair.mu_e));
                Texel::Samples(samples)
            }
        }
    }

    /// The same of several, on all cores.
    pub fn texels(&self, range: std::ops::Range<usize>) -> Vec<Texel> {
        range.into_par_iter().map(|at| self.texel(at)).collect()
    }

    /// Evaluations that no result takes more of.
    pub fn most(&self) -> usize {
        let most = |(row, setting): (usize, &Setting)| match self.source {
            Source::Map(map) => {
                // Each kink has two, of an azimuth, and factors take twice the nodes.
                let factored = self.fixed.iter().any(|fixed| fixed.factored);
                let panels = 1 + 2 * self.scales.get(row).map_or(0, Scale::most_kinks);
                let nodes = if factored { 4 } else { 1 };
                panels * nodes * (map.most)(setting, self.tolerance)
            }
            Source::Product(nodes) => {
                nodes.most(&self.scales.get(row).cloned().unwrap_or_default(), self.tolerance)
            }
            Source::Delta(_) => 1,
        };
        self.settings.iter().enumerate().map(most).max().unwrap_or(1)
    }
}
