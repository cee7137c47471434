//! Fresnel reflectance.

pub(crate) mod conductor;
pub(crate) mod dielectric;
pub(crate) mod f82;
pub(crate) mod generalized_schlick;
pub(crate) mod metals;
pub(crate) mod none;
pub(crate) mod schlick;
pub(crate) mod thin_film;

use crate::base::tolerance::{decade, is_fine};
use crate::model::parameters::{Parameters, Setting};
use crate::model::{Component, Metal, Parameter, SlopeCounts, Term};

/// F, split by what a material weighs.
pub(crate) trait Fresnel {
    const TERM: Term;
    const COMPONENTS: &'static [Component];
    /// Whether it is a polynomial of c with coefficients of no more than some ones: it then leaves ρ as analytic as the
    /// NDF does, and tables may be spread from few integrals.
    const POLYNOMIAL: bool = false;
    const PARAMETERS: &'static [Parameter] = &[];
    /// The most that F is.
    const BOUND: f64 = 1.0;
    /// What it adds to the relative error that values have in f32 with Schlick's.
    const VALUE_F32: f64 = 0.0;

    /// Names that stand for parameters.
    const METALS: &'static [Metal] = &[];

    /// Adds what its shader takes beside the parameters, or in place of them.
    fn derive(_parameters: &mut Parameters) {}

    /// Why these parameters are refused, if they are, though each is in its range.
    fn refused(_parameters: &Parameters) -> Option<&'static str> {
        None
    }

    /// What it takes where cos φ > 0, the side on which ωi·ωm comes near 0, and Schlick takes so much.
    fn near(schlick: SlopeCounts, _s: &Setting, _tolerance: f64) -> SlopeCounts {
        schlick
    }

    /// The same where cos φ < 0.
    fn far(schlick: SlopeCounts, _s: &Setting, _tolerance: f64) -> SlopeCounts {
        schlick
    }

    /// How many more nodes in μ its mean over directions takes than Schlick's.
    fn mean_nodes(_s: &Setting, _tolerance: f64) -> usize {
        0
    }

    /// The components for c = ωi·ωm and x = 1 − c. Long ones are not inlined: there are hundreds of combinations.
    fn fresnel(c: f64, x: f64, s: &Setting) -> [f64; 2];
}

/// What an exact term of index n takes, by |n² − 1| and |n² + 1|.
///
/// In c, F has branch points at c² = 1 − n² and poles at c² = 1/(n² + 1): what Gauss–Legendre feels is how near they
/// come to c = 0, as F turns there from what it is to 1. A factor for each decade of that distance, measured for n = 1 +
/// 2⁻²² … 1000 + 100i: with less, n = 1.01 is off by 4 times 1e-6, and 1 + i/1000 by 1700 times 1e-9. Down to 1e-4
/// Schlick's counts have what it takes.
fn exact(schlick: SlopeCounts, [minus, plus]: [f64; 2], tolerance: f64) -> SlopeCounts {
    let turn = minus.sqrt().min(1.0 / plus.sqrt());
    let [coarse, fine] = match turn {
        0.4.. => [1.25, 1.5],
        0.12.. => [1.25, 2.0],
        0.06.. => [1.5, 2.5],
        _ => [2.0, 4.0],
    };
    match tolerance {
        _ if is_fine(tolerance) => schlick.more(fine),
        _ if decade(tolerance) >= decade(1e-5) => schlick.more(coarse),
        _ => schlick,
    }
}
