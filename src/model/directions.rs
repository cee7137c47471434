//! Integration maps by direction: where a model's lobe lives, as directions with weights.

use super::SlopeCounts;
use crate::base::half_angle::{Azimuth, HalfSums, Pair};
use crate::base::quadrature::Node;
use crate::model::parameters::Setting;

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

impl Sample {
    /// The direction (θe, δφ), rad, of an integral with a fixed θi, and its weight cos θe dωe.
    pub fn new(theta_i: f64, theta_e: f64, delta_phi: f64, weight: f64) -> Self {
        Self { pair: Pair::new(theta_i, theta_e), azimuth: Azimuth::new(delta_phi), weight }
    }

    /// As the shader lays it out.
    pub(crate) fn to_array(self) -> [f64; POINT] {
        let Self { pair: Pair { hz2, dt2, ss, sd, mu_i, mu_e, st, dt, .. }, azimuth, weight } = self;
        let Azimuth { sin2, cos2, back, frame: HalfSums { cp, cm, sp, sm }, .. } = azimuth;
        [hz2, dt2, ss, sd, mu_i, mu_e, sin2, cos2, back, weight, st, dt, cp, cm, sp, sm]
    }
}
