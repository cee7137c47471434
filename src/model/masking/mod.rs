//! Masking and shadowing of microfacets.
//!
//! What a masking term must say is `visibility`: see [`Masking`]. The rest makes it faster or its promises sharper.

pub(crate) mod ashikhmin_neubelt;
pub(crate) mod disney_clearcoat;
pub(crate) mod kelemen;
pub(crate) mod none;
mod schlick;
pub(crate) mod schlick_ggx;
pub(crate) mod schlick_ggx_direct;
pub(crate) mod smith_correlated;
pub(crate) mod smith_joint_approx;
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

/// G2 of the normals of `N`: its name and `visibility`. All other items have defaults that are right.
pub(crate) trait Masking {
    /// The name, the source and the shader.
    const TERM: Term;

    /// G2 / (4 μi μe), or what of it all azimuths share.
    fn visibility<N: Ndf>(i: &Toward, e: &Toward) -> f64;

    /// Why ρ has no bound, if it has none.
    const UNBOUNDED: Option<&'static str> = None;

    /// The same, where it has none with normals that do not gather about n as α → 0.
    const UNBOUNDED_OFF_PEAK: Option<&'static str> = None;

    /// Node counts where cos φ > 0, the side on which the horizon turns, and where cos φ < 0, given those that
    /// height-correlated Smith needs. Without them integrals are found by adaptive quadrature.
    const COUNTS: Option<MaskingCounts> = None;

    /// Whether ρ has the branch points of the NDF alone, so that tables of it may be spread from few integrals.
    const SPREADS: bool = false;
    /// Where G2 is not smooth in ωm, if it depends on ωm: the kernel that integrates in slopes cannot have it then.
    const OF_NORMAL: Option<Kinks> = None;

    /// Whether it turns near the normal, on a scale of its own: not every distribution's counts see that.
    const TURNS: bool = false;

    /// G2 / (4 μi μe), of the microfacet and in proportion to what all azimuths share.
    fn of_normal(shared: f64, _p: &Pair, _h: &Half) -> f64 {
        shared
    }

    /// y / (2 μe visibility) at μi = μe x/y, for the kernel that integrates in slopes: G2 = 2 μe x / masking(x, y).
    fn masking<N: Ndf>(x: f64, y: f64, mu_e: f64, s: &Setting) -> f64 {
        let toward = |mu: f64| Toward { mu, setting: *s };
        y / (2.0 * mu_e * Self::visibility::<N>(&toward(mu_e * x / y), &toward(mu_e)))
    }

    /// The bound of ρ_dh, given the one with Smith's Λ of α.
    fn bound(smith: f64, _alpha: f64) -> f64 {
        smith
    }

    /// G2 of the mirror that α → 0 tends to.
    fn mirror(_mu: f64) -> f64 {
        1.0
    }
}

/// Node counts of both sides for a tolerance, given those that height-correlated Smith needs.
pub(crate) type MaskingCounts = fn(correlated: [SlopeCounts; 2], tolerance: f64) -> [SlopeCounts; 2];
