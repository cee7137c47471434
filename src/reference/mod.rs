//! The f64 reference: every model by its textbook formula, every integral by adaptive quadrature.
//!
//! Tables that a device computed are measured against it, so it takes no line from the device's side and
//! knows neither its buffers nor its rules. It is written to be checked against the papers first, and to be
//! fast second. Where an integral changes variables, a test holds it to the definition, which does not.
//!
//! Accuracy, as the tests hold it: values to 1e-12 relative, integrals to 1e-9 absolute. Both directions of a
//! value, and the fixed one of an integral, have a cosine of at least [`MIN_MU`].

mod anisotropic;
mod classic;
mod definition;
mod diffuse;
mod directions;
mod factor;
mod fresnel;
pub mod light;
mod masking;
mod microfacet;
mod mirror;
mod ndf;
mod quadrature;

#[cfg(test)]
mod tests;

use crate::model::parameters::Setting;

pub(crate) use anisotropic::Anisotropic;
pub use classic::{
    ashikhmin_shirley::{ASHIKHMIN_SHIRLEY, ASHIKHMIN_SHIRLEY_DIFFUSE},
    blinn::BLINN,
    lafortune::LAFORTUNE,
    phong::PHONG,
    ward::WARD,
    ward_dur::WARD_DUR,
};
pub use diffuse::{
    burley::BURLEY,
    disney::{DISNEY_SHEEN, DISNEY_SUBSURFACE},
    eon::EON,
    frostbite::FROSTBITE,
    fujii::FUJII,
    gltf::GLTF_DIFFUSE,
    gltf_oren_nayar::GLTF_OREN_NAYAR,
    lambert::LAMBERT,
    oren_nayar::OREN_NAYAR,
};
pub use directions::{Angles, MIN_MU};
pub use factor::Product;
pub(crate) use fresnel::{
    Fresnel, conductor::Conductor, dielectric::Dielectric, f82::F82, generalized_schlick::GeneralizedSchlick,
    none::Constant, schlick::Schlick, thin_film::ThinFilm,
};
pub(crate) use masking::{
    Masking,
    ashikhmin_neubelt::AshikhminNeubelt,
    disney_clearcoat::DisneyClearcoat,
    kelemen::Kelemen,
    none::Unmasked,
    schlick_ggx::{SchlickGgx, SchlickGgxDirect},
    smith_correlated::SmithCorrelated,
    smith_separable::SmithSeparable,
    v_cavity::VCavity,
};
pub use microfacet::GGX;
pub(crate) use microfacet::Microfacet;
pub use mirror::MIRROR;
pub(crate) use mirror::Mirror;
pub(crate) use ndf::{
    Ndf, beckmann::Beckmann, blinn_phong::BlinnPhong, charlie::Charlie, ggx::Ggx, gtr::Gtr,
};

/// The f64 reference of a model.
///
/// A model's BRDF is f = a·A + b·B, its integrals likewise; each function returns [A, B]. Under Schlick's Fresnel
/// A is what F0 weighs and B what F90 weighs; a model with one component has B = 0. A model without roughness ignores
/// the setting's `alpha`; that of microfacets is in [0, 1]. An integral that did not converge is NaN.
pub trait Reference: Sync {
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
        definition::rho_hh(|mu| self.rho_dh(mu, setting), setting.alpha)
    }

    /// ρ_dh of f times a factor of the other direction's cosine.
    fn rho_dh_times(&self, mu: f64, setting: &Setting, factor: &dyn Fn(f64) -> f64) -> [f64; 2] {
        let f = |angles: &Angles| {
            let factor = factor(angles.theta_e.cos());
            self.brdf(angles, setting).unwrap_or([f64::NAN; 2]).map(|f| f * factor)
        };
        definition::rho_dh_kinked(f, mu)
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
