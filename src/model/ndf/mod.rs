//! Distributions of microfacet normals.

pub(crate) mod beckmann;
pub(crate) mod blinn_phong;
pub(crate) mod charlie;
mod charlie_map;
pub(crate) mod ggx;
pub(crate) mod ggx_coarse;
pub(crate) mod ggx_fine;
pub(crate) mod ggx_nodes;
pub(crate) mod ggx_samples;
pub(crate) mod gtr;
pub(crate) mod stretched;

use crate::base::half_angle::Half;
use crate::base::quadrature::Node;
use crate::model::directions::{Fixed, Sample};
use crate::model::fresnel::Fresnel;
use crate::model::masking::Masking;
use crate::model::parameters::{Parameters, Setting};
use crate::model::{Branches, Parameter, Part, Shape, SlopeCounts, Term, half_vector};

/// A distribution of normals, with the maps that integrate and sample it.
pub(crate) trait Ndf: Sized {
    const TERM: Term;
    /// The shaders of its maps, the coarse one first, for the kernel that integrates in slopes: without, the host finds
    /// directions by the fine map.
    const MAPS: Option<[Part; 2]> = None;
    /// Its samplers, if it has them.
    const SAMPLES: Option<Part> = None;
    /// What its roughness is.
    const SHAPE: Shape = Shape::ALPHA;
    /// The rest of its parameters, in places 0 to 3.
    const PARAMETERS: &'static [Parameter] = &[];
    /// Whether shape 0 is the ideal mirror.
    const IS_MIRROR_AT_0: bool = true;
    /// The relative error of its values in f32.
    const VALUE_F32: f64 = crate::base::precision::VALUE_F32;
    /// The error of its integrals in f32, relative to the most they reach.
    const INTEGRAL_F32: f64 = crate::base::precision::INTEGRAL_F32;
    /// f below which f32 has lost digits to underflow, sr⁻¹, where that is earlier than of most.
    const FAINT: Option<f64> = None;
    /// The maskings with which ρ_dh exceeds 1, and its bound there: none, unless Λ is not Smith's of these normals, or not of
    /// their α.
    const RHO_BOUNDS: &'static [(&'static str, f64)] = &[];
    /// cos θ at which ρ(μ) is not analytic, if there is such a place between grazing and the normal.
    const SEAM: Option<f64> = None;
    /// Where ρ(μ, α) is not analytic, if that was measured.
    const BRANCHES: Option<Branches> = None;

    /// Whether α differs along the tangent and the bitangent.
    const STRETCHES: bool = false;

    /// The relative error of its values in f32 at a setting.
    fn value_f32(_s: &Setting) -> f64 {
        Self::VALUE_F32
    }

    /// What ρ_dh reaches at most at a setting with Λ of its α, where that is less than with the worst.
    fn rho_most(_s: &Setting) -> f64 {
        f64::INFINITY
    }

    /// α along the tangent and along the bitangent.
    fn axes(s: &Setting) -> [f64; 2] {
        [s.alpha; 2]
    }

    /// Adds what its shader takes beside its parameters, or in place of them.
    fn derive(_parameters: &mut Parameters) {}

    /// D(ωm), sr⁻¹.
    fn ndf(h: &Half, hz2: f64, s: &Setting) -> f64;

    /// (1 + 2Λ) μ, with Smith's Λ.
    fn smith_root(mu: f64, s: &Setting) -> f64;

    /// y (1 + 2Λ) μi at μi = μe x/y.
    fn smith_root_at(x: f64, y: f64, mu_e: f64, s: &Setting) -> f64 {
        y * Self::smith_root((mu_e * x / y).clamp(0.0, 1.0), s)
    }

    /// Directions whose weighted values add up to ρ, cos θ dω of them; and at most how many. By the map of the normals,
    /// unless the NDF knows better.
    fn samples<M: Masking>(
        fixed: &Fixed,
        s: &Setting,
        counts: [SlopeCounts; 2],
        tolerance: f64,
    ) -> Vec<Sample> {
        half_vector::samples::<Self, M>(fixed, s, counts, tolerance)
    }
    fn most<M: Masking>(counts: [SlopeCounts; 2]) -> usize {
        half_vector::most(&M::KINKS, counts)
    }
    /// μ and weights of the mean ρ_hh, where the rule of all models does not see what is in ρ: with a smooth masking, and
    /// with one that has kinks.
    const MEANS: Option<[Mean; 2]> = None;

    /// r at which tan θm reaches `t_max`, and the map there: of one that has a map.
    fn fine_end(_t_max: f64, _: &Setting) -> f64 {
        f64::NAN
    }
    fn fine_map(_r: f64, _: &Setting) -> Map {
        Map { p: f64::NAN, m: f64::NAN, weight: f64::NAN }
    }
    /// The same for tolerances that f32 can meet.
    fn coarse_end(t_max: f64, s: &Setting) -> f64 {
        Self::fine_end(t_max, s)
    }
    fn coarse_map(r: f64, s: &Setting) -> Map {
        Self::fine_map(r, s)
    }

    /// What a texel takes to meet a tolerance, where cos φ > 0 and where it is < 0.
    fn counts(mu: f64, s: &Setting, tolerance: f64) -> [SlopeCounts; 2];

    /// f μi / p for a draw of D cos θm, and for one of the normals that ωe sees: of one that has samplers.
    fn by_ndf<M: Masking, F: Fresnel>(_draw: [f64; 2], _mu_e: f64, _: &Setting) -> [f64; 2] {
        [f64::NAN; 2]
    }
    fn by_vndf<M: Masking, F: Fresnel>(_draw: [f64; 2], _mu_e: f64, _: &Setting) -> [f64; 2] {
        [f64::NAN; 2]
    }
}

/// cos θ of directions and their weights in the mean ∫ ρ 2μ dμ, at a tolerance.
pub(crate) type Mean = fn(tolerance: f64) -> Vec<Node>;

/// A map's tan θm = p/m at r, and `weight` = w dv/dr / m, where D cos θm dωm = w dv dφ / 2π.
pub(crate) struct Map {
    pub p: f64,
    pub m: f64,
    pub weight: f64,
}
