//! Masking and shadowing of microfacets.

pub(crate) mod ashikhmin_neubelt;
pub(crate) mod disney_clearcoat;
pub(crate) mod kelemen;
pub(crate) mod none;
mod schlick;
pub(crate) mod schlick_ggx;
pub(crate) mod schlick_ggx_direct;
pub(crate) mod smith_correlated;
pub(crate) mod smith_separable;
pub(crate) mod v_cavity;

use crate::base::half_angle::{Half, Pair};
use crate::model::half_vector::Kinks;
use crate::model::ndf::Ndf;
use crate::model::parameters::Setting;
use crate::model::{SlopeCounts, Term};

/// A direction: its cosine, and the setting with the α that is seen from it.
pub(crate) struct Toward {
    pub mu: f64,
    pub setting: Setting,
}

/// G2 of the normals of `N`.
pub(crate) trait Masking {
    const TERM: Term;
    /// Why ρ has no bound, if it has none.
    const UNBOUNDED: Option<&'static str> = None;

    /// The same, where it has none with normals that do not gather about n as α → 0.
    const UNBOUNDED_OFF_PEAK: Option<&'static str> = None;

    /// What it takes where cos φ > 0, the side on which the horizon turns, and where cos φ < 0, when correlated
    /// Smith takes so much.
    fn counts(correlated: [SlopeCounts; 2], _tolerance: f64) -> [SlopeCounts; 2] {
        correlated
    }

    /// Whether ρ has the branch points of the NDF alone, so that tables of it may be spread from few integrals.
    const SPREADS: bool = true;
    /// Whether G2 depends on ωm, and the kernel that integrates in slopes cannot have it.
    const OF_NORMAL: bool = false;

    /// Where G2 is not smooth in ωm.
    const KINKS: Kinks = Kinks::NONE;

    /// G2 / (4 μi μe), or what of it all azimuths share.
    fn visibility<N: Ndf>(i: &Toward, e: &Toward) -> f64;

    /// G2 / (4 μi μe), of the microfacet and in proportion to that share.
    fn of_normal(shared: f64, _p: &Pair, _h: &Half) -> f64 {
        shared
    }

    /// G2 = 2 μe x / masking(x, y), for μi = μe x/y, where it does not depend on ωm.
    fn masking<N: Ndf>(_x: f64, _y: f64, _mu_e: f64, _s: &Setting) -> f64 {
        f64::NAN
    }

    /// What ρ_dh reaches at most, where it is `own` with Smith's Λ of α.
    fn rho_most(own: f64, _alpha: f64) -> f64 {
        own
    }

    /// G2 of the mirror that α → 0 tends to.
    fn mirror(_mu: f64) -> f64 {
        1.0
    }
}
