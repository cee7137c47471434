//! The f64 reference of gonio: every model by its textbook formula, every integral by adaptive quadrature, light by its
//! definitions.
//!
//! gonio evaluates BRDFs twice, in shaders and in their f64 twins, and measures both against this crate. A comparison
//! between evaluations that share code proves nothing of the shared part. So this crate shares nothing with gonio: it
//! depends on glam and libm alone, which Cargo checks, and has its own angles, its own measure of roughness, its own
//! parameters by name, its own tangent frames and its own reading of environment maps. Both sides agree on names and on
//! conventions only, those of the papers and of gonio's guide.
//!
//! It is written to be checked against the papers first, and to be fast second. Where an integral changes variables, a
//! test holds it to the definition, which does not.
//!
//! Accuracy, as the tests hold it: values to 1e-12 relative, integrals to 1e-9 absolute. Both directions of a value, and
//! the fixed one of an integral, have a cosine of at least [`MIN_MU`].
//!
//! ```
//! use gonio_reference::{Parameters, Setting, microfacet};
//!
//! let ggx = microfacet("ggx", "smith-correlated", "none").ok_or("no such parts")?;
//! let setting = Setting::new(ggx.measure(), Some(1.0), &Parameters::DEFAULT)?;
//! let [rho, _] = ggx.rho_dh(1.0, &setting);
//! assert!((rho - (1.0 - f64::ln(2.0))).abs() < 1e-11);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod anisotropic;
mod classic;
mod definition;
mod diffuse;
mod directions;
mod fresnel;
pub mod light;
mod masking;
mod measure;
mod microfacet;
mod mirror;
mod ndf;
mod quadrature;
mod registry;
mod setting;

#[cfg(test)]
mod tests;

pub use definition::rho_hh as mean_of_rho_dh;
pub use directions::{Angles, MIN_MU};
pub use measure::Measure;
pub use registry::{microfacet, mirror, model};
pub use setting::{Parameters, Refused, Setting};

use fresnel::Fresnel;
use masking::Masking;
use ndf::Ndf;

/// The f64 reference of a model.
///
/// A model's BRDF is f = a·A + b·B, its integrals likewise; each function returns [A, B]. Under Schlick's Fresnel
/// A is what F0 weighs and B what F90 weighs; a model with one component has B = 0. An integral that did not converge is
/// NaN.
pub trait Reference: Sync {
    /// The model's own measure of a roughness, if it takes one; a [`Setting`] is made with it.
    fn measure(&self) -> Measure {
        Measure::None
    }

    /// f in sr⁻¹, without the cosine; `None` where it is a delta and has no value.
    fn brdf(&self, angles: &Angles, setting: &Setting) -> Option<[f64; 2]>;

    /// ρ_dh = ∫ f cos θ dω over the hemisphere, at μ = cos θ ∈ [0, 1] of the fixed direction.
    fn rho_dh(&self, mu: f64, setting: &Setting) -> [f64; 2];

    /// The same for an azimuth φ of the fixed direction, which isotropic models do not tell.
    fn rho_dh_at(&self, mu: f64, _phi: f64, setting: &Setting) -> [f64; 2] {
        self.rho_dh(mu, setting)
    }

    /// ρ_hh = 2 ∫ ρ_dh(μ) μ dμ over [0, 1].
    fn rho_hh(&self, setting: &Setting) -> [f64; 2] {
        definition::rho_hh(setting, setting.alpha, |mu, error| self.rho_dh(mu, &setting.within(error)))
    }

    /// ρ_dh of f times a factor of the other direction's cosine.
    fn rho_dh_times(&self, mu: f64, setting: &Setting, factor: &dyn Fn(f64) -> f64) -> [f64; 2] {
        let f = |angles: &Angles| {
            let factor = factor(angles.theta_e.cos());
            self.brdf(angles, setting).unwrap_or([f64::NAN; 2]).map(|f| f * factor)
        };
        definition::rho_dh_kinked(f, mu, setting)
    }

    /// The factors of a microfacet model; `None` for any other, and where [`Reference::brdf`] is `None`.
    fn factors(&self, _angles: &Angles, _: &Setting) -> Option<Factors> {
        None
    }
}

/// What a microfacet BRDF is made of: f = F·D·G2 / (4 μi μe), F = Σ weight · `f`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Factors {
    /// D(ωm), sr⁻¹: the density of microfacet normals.
    pub d: f64,
    /// G2(ωi, ωe): the share of microfacets that both directions see.
    pub g2: f64,
    /// The Fresnel term's components, as those of f.
    pub f: [f64; 2],
}
