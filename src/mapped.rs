//! Integrals by directions that the host finds, each texel its own: whatever a lobe's shape, its model says where it
//! lives. For models that no kernel with a map of its own is worth: a direction takes 100 ns here.

use crate::factor::{Scale, product::Nodes};
use crate::models::{FINEST, SlopeCounts};
use crate::pair::{Azimuth, Frame, Pair};
use crate::quadrature::Node;
use crate::setting::Setting;
use rayon::prelude::*;

/// Where a model's lobe lives.
#[derive(Clone, Copy)]
pub struct Map {
    /// Directions whose weighted values add up to ρ, for the fixed one.
    pub samples: fn(&Fixed, &Setting, tolerance: f64) -> Vec<Sample>,
    /// At most so many of them.
    pub most: fn(&Setting, tolerance: f64) -> usize,
    /// μ and weights of the mean ρ_hh = ∫ ρ 2μ dμ, if they are its own.
    pub mean: Option<fn(tolerance: f64) -> Vec<Node>>,
    /// ρ in closed form where the lobe is a delta.
    pub limit: fn(mu: f64, &Setting) -> Option<[f64; 2]>,
}

/// The direction that an integral leaves alone.
#[derive(Debug, Clone, PartialEq)]
pub struct Fixed {
    /// cos θ ≥ 2⁻²⁴
    pub mu: f64,
    /// φ, rad: what an isotropic lobe does not tell.
    pub phi: f64,
    /// Whether the lobe is multiplied with factors of the cosines, which take more nodes than it does …
    pub factored: bool,
    /// … and cosines of the other direction at which they have kinks: panels end there.
    pub kinks: Vec<f64>,
}

impl Fixed {
    pub(crate) fn sin(&self) -> f64 {
        ((1.0 - self.mu) * (1.0 + self.mu)).sqrt()
    }

    /// What a lobe takes that takes so much without factors: twice of both.
    pub(crate) fn counts(&self, SlopeCounts { azimuths, nodes }: SlopeCounts) -> SlopeCounts {
        let more = if self.factored { 2 } else { 1 };
        SlopeCounts { azimuths: more * azimuths, nodes: more * nodes }
    }
}

/// A direction of the integral: f there, times a weight that has its cosine and its solid angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    pub(crate) pair: Pair,
    pub(crate) azimuth: Azimuth,
    pub(crate) weight: f64,
}

/// Numbers of a sample, and where its cosines and its weight are among them.
pub(crate) const POINT: usize = 16;
pub(crate) const POINT_MUS: [usize; 2] = [4, 5];
pub(crate) const POINT_WEIGHT: usize = 9;

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
        let tolerance = (0.01 * self.tolerance).max(FINEST);
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

impl Sample {
    /// The direction (θe, δφ), rad, of an integral with a fixed θi, and its weight cos θe dωe.
    pub fn new(theta_i: f64, theta_e: f64, delta_phi: f64, weight: f64) -> Self {
        Self { pair: Pair::new(theta_i, theta_e), azimuth: Azimuth::new(delta_phi), weight }
    }

    /// As the shader lays it out.
    pub(crate) fn to_array(self) -> [f64; POINT] {
        let Self { pair: Pair { hz2, dt2, ss, sd, mu_i, mu_e, st, dt, .. }, azimuth, weight } = self;
        let Azimuth { sin2, cos2, back, frame: Frame { cp, cm, sp, sm }, .. } = azimuth;
        [hz2, dt2, ss, sd, mu_i, mu_e, sin2, cos2, back, weight, st, dt, cp, cm, sp, sm]
    }
}
