//! Fresnel reflectance.
//!
//! What a Fresnel term must say is F and its components: see [`Fresnel`]. The rest makes it faster or its promises sharper.

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

/// F, split by what a material weighs: its name, its components and F. All other items have defaults that are right.
pub(crate) trait Fresnel {
    /// The name, the source and the shader.
    const TERM: Term;
    /// What a material weighs.
    const COMPONENTS: &'static [Component];

    /// The components for c = ωi·ωm and x = 1 − c. Long ones are not inlined: there are hundreds of combinations.
    fn fresnel(c: f64, x: f64, s: &Setting) -> [f64; 2];

    /// Node counts. Without them integrals are found by adaptive quadrature.
    const COUNTS: Option<FresnelCounts> = None;
    /// Whether it is a polynomial of c with coefficients of no more than some ones: it then leaves ρ as analytic as the
    /// NDF does, and tables may be spread from few integrals.
    const POLYNOMIAL: bool = false;
    /// The same within a tolerance, where F costs so much that integrals of stretched lobes share what does not depend on it.
    const AS_POLYNOMIAL: Option<AsPolynomial> = None;
    /// Its parameters, in places 4 to 7.
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
}

/// Node counts, given those that Schlick's term needs.
pub(crate) struct FresnelCounts {
    /// Where cos φ > 0, the side on which ωi·ωm comes near 0.
    pub near: fn(schlick: SlopeCounts, &Setting, tolerance: f64) -> SlopeCounts,
    /// Where cos φ < 0.
    pub far: fn(schlick: SlopeCounts, &Setting, tolerance: f64) -> SlopeCounts,
    /// How many more nodes in μ its mean over directions takes than Schlick's.
    pub mean_nodes: fn(&Setting, tolerance: f64) -> usize,
}

/// F as a polynomial of c within a tolerance.
pub(crate) struct AsPolynomial {
    /// Its degree.
    pub degree: fn(&Setting, tolerance: f64) -> usize,
    /// Node counts of stretched lobes where cos φ > 0 and where it is < 0, for polynomials of a degree, given those of
    /// Schlick's term.
    pub counts: fn(schlick: [SlopeCounts; 2], degree: usize) -> [SlopeCounts; 2],
}

impl FresnelCounts {
    /// Those of Schlick's term.
    pub const SCHLICK: Self =
        Self { near: |schlick, _, _| schlick, far: |schlick, _, _| schlick, mean_nodes: |_, _| 0 };
}

/// Nodes in μ of the mean over directions that a term without counts takes beside Schlick's.
pub(crate) const MEAN_NODES_UNKNOWN: usize = 64;

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
