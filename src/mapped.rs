//! Integrals by directions that the host finds, each texel its own: whatever a lobe's shape, its model says where it
//! lives. For models that no kernel with a map of its own is worth: a direction takes 100 ns here.

use crate::pair::{Azimuth, Pair};
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
    /// What measure 0 tends to, where the lobe becomes a delta.
    pub limit: Option<fn(mu: f64, &Setting) -> [f64; 2]>,
}

/// The direction that an integral leaves alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fixed {
    /// cos θ ≥ 2⁻²⁴
    pub mu: f64,
}

/// A direction of the integral: f there, times a weight that has its cosine and its solid angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    pub(crate) pair: Pair,
    pub(crate) azimuth: Azimuth,
    pub(crate) weight: f64,
}

/// Numbers of a sample.
pub(crate) const POINT: usize = 10;

/// Inner integrals for each (setting, fixed direction).
#[derive(Clone)]
pub(crate) struct MappedWork {
    map: Map,
    pub fixed: Vec<Fixed>,
    settings: Vec<Setting>,
    tolerance: f64,
}

/// What a texel is: a sum over samples, or a limit in closed form.
pub(crate) enum Texel {
    Samples(Vec<Sample>),
    Limit([f64; 2]),
}

impl MappedWork {
    pub fn new(map: Map, fixed: Vec<Fixed>, settings: Vec<Setting>, tolerance: f64) -> Self {
        Self { map, fixed, settings, tolerance }
    }

    /// The result `at`, counting fixed directions first.
    pub fn texel(&self, at: usize) -> Texel {
        let (setting, fixed) = (&self.settings[at / self.fixed.len()], &self.fixed[at % self.fixed.len()]);
        match self.map.limit {
            Some(limit) if setting.alpha == 0.0 => Texel::Limit(limit(fixed.mu, setting)),
            _ => Texel::Samples((self.map.samples)(fixed, setting, self.tolerance)),
        }
    }

    /// The same of several, on all cores.
    pub fn texels(&self, range: std::ops::Range<usize>) -> Vec<Texel> {
        range.into_par_iter().map(|at| self.texel(at)).collect()
    }

    /// Evaluations that no result takes more of.
    pub fn most(&self) -> usize {
        self.settings.iter().map(|setting| (self.map.most)(setting, self.tolerance)).max().unwrap_or(1)
    }
}

impl Sample {
    /// The direction (θe, δφ), rad, of an integral with a fixed θi, and its weight cos θe dωe.
    pub fn new(theta_i: f64, theta_e: f64, delta_phi: f64, weight: f64) -> Self {
        Self { pair: Pair::new(theta_i, theta_e), azimuth: Azimuth::new(delta_phi), weight }
    }

    /// As the shader lays it out.
    pub(crate) fn to_array(self) -> [f64; POINT] {
        let Self { pair: Pair { hz2, dt2, ss, sd, mu_i, mu_e, .. }, azimuth, weight } = self;
        [hz2, dt2, ss, sd, mu_i, mu_e, azimuth.sin2, azimuth.cos2, azimuth.back, weight]
    }
}
