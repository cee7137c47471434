//! What models take beside the weights of their components: a roughness, and numbers of their own.

use crate::base::error::{Error, Result};
use crate::model::ALPHA_MIN_VALUE;
use crate::model::classic::FAINT_ABOUT_AXIS;
use crate::model::ndf::gtr::ALPHA_LEAST;
use std::f64::consts::FRAC_PI_2;

/// A perceptual roughness: finite, in [0, 1].
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct Roughness(f64);

impl Roughness {
    /// A roughness of `value`.
    ///
    /// # Errors
    /// When it is not in [0, 1].
    pub fn new(value: f64) -> Result<Self> {
        if (0.0..=1.0).contains(&value) {
            return Ok(Self(value));
        }
        Err(Error::input(format!("a roughness of {value}; give one in [0, 1]")))
    }

    /// The number.
    pub const fn get(self) -> f64 {
        self.0
    }
}

/// How rough a lobe is: every model takes a perceptual roughness in [0, 1], and evaluates its own measure of it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Shape {
    /// What recipes may give in place of the roughness: `alpha`; `roughness` where that is what it evaluates.
    pub name: &'static str,
    /// One line for people.
    pub summary: &'static str,
    /// Empty: dimensionless.
    pub unit: &'static str,
    /// The measure at roughness 1; it is 0 at 0.
    pub most: f64,
    /// The least measure that has values: below it, the lobe is a delta as far as f32 goes. 0: all have.
    pub least: f64,
    /// The power of the roughness in it: measure = most · roughnessᵖ.
    power: i32,
    /// Whether it may differ along the tangent and the bitangent, so that f depends on both azimuths.
    pub anisotropic: bool,
    /// The measure that is taken below it.
    floor: f64,
    /// Whether it is a share σ whose rest 1 − σ matters as much: shaders get σ/(1 − σ).
    odds: bool,
    /// f below which a lobe of it is known absolutely, sr⁻¹, where that is earlier than of most.
    pub(crate) faint: Option<f64>,
}

/// A number that a model takes beside its roughness and the weights of its components.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Parameter {
    /// The name in recipes.
    pub name: &'static str,
    /// One line for people.
    pub summary: &'static str,
    /// Empty: dimensionless.
    pub unit: &'static str,
    /// The least and the most.
    pub range: [f64; 2],
    /// Where a recipe gives none; `None`: it must.
    pub default: Option<f64>,
    /// Where shaders find it: see [`Parameters`](crate::model::parameters::Parameters).
    pub place: usize,
}

impl Parameter {
    /// The name of the parameter that is 0, 1, 2 in R, G, B of a material.
    pub const CHANNEL: &'static str = "channel";
}

impl Shape {
    /// α = roughness², the slope of microfacets: α → 0 is the mirror.
    pub const ALPHA: Self = Self {
        name: "alpha",
        summary: "the slope of the microfacets, alpha = roughness²",
        unit: "",
        most: 1.0,
        least: ALPHA_MIN_VALUE,
        power: 2,
        anisotropic: false,
        floor: 0.0,
        odds: false,
        faint: None,
    };

    /// The mean α = √(αx αy) of slopes that differ along the tangent and the bitangent.
    pub const ALPHA_XY: Self = Self { anisotropic: true, ..Self::ALPHA };

    /// α = roughness², the width of a lobe about an axis that is not the normal: α → 0 is a delta.
    pub const ABOUT_AXIS: Self = Self {
        summary: "the width of the lobe about its axis, alpha = roughness²; its exponent is 2/alpha² - 1",
        faint: Some(FAINT_ABOUT_AXIS),
        ..Self::ALPHA
    };

    /// α = roughness², how much fibres lean: α → 0 is no mirror.
    pub const SHEEN: Self = Self {
        summary: "how far fibres are from upright, alpha = roughness², at least 0.005",
        least: 0.0,
        ..Self::ALPHA
    };

    /// α = roughness², at least Disney's 1/1000, so that all of them have values.
    pub(crate) const GTR: Self = Self {
        summary: "the slope of the microfacets, alpha = roughness², at least 0.001",
        least: 0.0,
        floor: ALPHA_LEAST,
        ..Self::ALPHA
    };

    /// The roughness as it is.
    pub const ROUGHNESS: Self = Self {
        name: "roughness",
        summary: "the roughness as it is",
        unit: "",
        most: 1.0,
        least: 0.0,
        power: 1,
        anisotropic: false,
        floor: 0.0,
        odds: false,
        faint: None,
    };

    /// σ of slopes as angles, rad.
    pub const SIGMA: Self = Self {
        name: "sigma",
        summary: "the standard deviation of the facets' slope angle, sigma = π/2 · roughness",
        unit: "rad",
        most: FRAC_PI_2,
        least: 0.0,
        power: 1,
        anisotropic: false,
        floor: 0.0,
        odds: false,
        faint: None,
    };

    /// The roughness as it is, as the share of what vanishes with it: f32 has both ends in full as odds alone.
    pub const SHARE: Self = Self { odds: true, ..Self::ROUGHNESS };

    /// The model's own measure of a roughness.
    pub fn measure(&self, roughness: f64) -> f64 {
        self.taken(self.most * roughness.powi(self.power))
    }

    /// What is taken for a measure: no less than the floor.
    pub(crate) fn taken(&self, measure: f64) -> f64 {
        measure.max(self.floor)
    }

    /// What shaders get of a measure: it, or its odds up to 1e30, beyond which f does not tell them from infinite.
    pub(crate) fn on_device(&self, measure: f64) -> f64 {
        if self.odds { (measure / (1.0 - measure)).min(1e30) } else { measure }
    }

    /// The roughness of a measure.
    pub fn roughness(&self, measure: f64) -> f64 {
        let share = measure / self.most;
        if self.power == 2 { share.sqrt() } else { share }
    }
}
