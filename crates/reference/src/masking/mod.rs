//! Masking and shadowing.

pub(crate) mod ashikhmin_neubelt;
pub(crate) mod disney_clearcoat;
pub(crate) mod kelemen;
pub(crate) mod none;
pub(crate) mod schlick_ggx;
pub(crate) mod smith_correlated;
pub(crate) mod smith_joint_approx;
pub(crate) mod smith_separable;
pub(crate) mod v_cavity;

/// What G2 may depend on: the directions about a microfacet.
pub(crate) struct Facet {
    /// cos θ of both directions.
    pub mu: [f64; 2],
    /// Smith's Λ of both.
    pub lambda: [f64; 2],
    /// ωi·ωm = ωe·ωm
    pub cos_d: f64,
    /// cos θm
    pub cos_m: f64,
    /// α that is seen from both.
    pub alpha: [f64; 2],
}

/// G2(ωi, ωe): the share of microfacets that are neither masked nor shadowed.
pub(crate) trait Masking: Sync {
    /// tan θm at which G2 has a kink, for ωo = (sin θo cos φ, ·, cos θo) about the azimuth φ of ωm.
    fn kinks(&self, _x_o: f64, _mu_o: f64) -> Vec<f64> {
        Vec::new()
    }

    /// G2 above the horizon.
    fn g2(&self, facet: &Facet) -> f64;
}
