//! Distributions of microfacet normals.
//!
//! What a distribution must say is D and Smith's Λ: see [`Ndf`]. The rest makes it faster or its promises sharper.

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
pub(crate) mod student_t;

use crate::base::half_angle::Half;
use crate::base::quadrature::Node;
use crate::model::directions::{Fixed, Sample};
use crate::model::half_vector::Kinks;
use crate::model::parameters::{Parameters, Setting};
use crate::model::{Branches, Parameter, Part, Shape, SlopeCounts, Term};

/// A distribution of normals: its name, D and Smith's Λ. All other items have defaults that are right.
pub(crate) trait Ndf: Sized {
    /// The name, the source and the shader.
    const TERM: Term;

    /// D(ωm), sr⁻¹, of the half vector h; `hz2` is the square of its component along the normal.
    fn ndf(h: &Half, hz2: f64, s: &Setting) -> f64;

    /// (1 + 2Λ) μ, with Smith's Λ.
    fn smith_root(mu: f64, s: &Setting) -> f64;

    /// What its roughness is.
    const SHAPE: Shape = Shape::ALPHA;
    /// Its parameters beside the roughness, in places 0 to 3.
    const PARAMETERS: &'static [Parameter] = &[];

    /// Adds what the shader takes beside the parameters, or in place of them.
    fn derive(_parameters: &mut Parameters) {}

    /// α along the tangent and along the bitangent, where they differ.
    const AXES: Option<fn(&Setting) -> [f64; 2]> = None;
    /// Bounds and limits of ρ.
    const ALBEDO: AlbedoBounds = AlbedoBounds::CONSERVED;
    /// The errors of f32.
    const F32: Rounding = Rounding::USUAL;
    /// A coordinate of tan θm in which the lobe is flat.
    const MAPS: Option<Maps> = None;
    /// Node counts of its integrals. Without them integrals are found by adaptive quadrature.
    const RULE: Option<CountRule> = None;
    /// Whether the counts hold with a masking that turns near the normal: see [`Masking::TURNS`](super::masking::Masking::TURNS).
    const RULE_HOLDS_TURNS: bool = true;
    /// How normals are drawn, for the rules that sample.
    const DRAWS: Option<Draws> = None;

    /// y (1 + 2Λ) μi at μi = μe x/y.
    fn smith_root_at(x: f64, y: f64, mu_e: f64, s: &Setting) -> f64 {
        y * Self::smith_root((mu_e * x / y).clamp(0.0, 1.0), s)
    }
}

/// Bounds and limits of ρ.
pub(crate) struct AlbedoBounds {
    /// Whether shape 0 is the ideal mirror.
    pub is_mirror_at_0: bool,
    /// The maskings with which ρ_dh exceeds 1, and its bound there: none, unless Λ is not Smith's of these normals, or not of
    /// their α.
    pub bounds: &'static [(&'static str, f64)],
    /// The bound of ρ_dh at a setting, with Λ of its α, where that is less than with the worst.
    pub bound_at: fn(&Setting) -> f64,
    /// cos θ at which ρ(μ) is not analytic, if there is such a place between grazing and the normal.
    pub seam: Option<f64>,
}

impl AlbedoBounds {
    /// Energy is conserved, and α → 0 is the mirror.
    pub const CONSERVED: Self =
        Self { is_mirror_at_0: true, bounds: &[], bound_at: |_| f64::INFINITY, seam: None };
}

/// The errors of f32.
pub(crate) struct Rounding {
    /// The relative error of values, the worst of all settings.
    pub value: f64,
    /// The relative error of values at a setting, where that is known.
    pub value_at: Option<fn(&Setting) -> f64>,
    /// The error of integrals, relative to the most they reach.
    pub integral: f64,
    /// f below which f32 has lost digits to underflow, sr⁻¹, where that is earlier than of most.
    pub faint: Option<f64>,
}

impl Rounding {
    /// The budget of a lobe whose D takes five roundings.
    pub const USUAL: Self = Self {
        value: crate::base::precision::VALUE_F32,
        value_at: None,
        integral: crate::base::precision::INTEGRAL_F32,
        faint: None,
    };
}

/// A coordinate r of tan θm, for tolerances that f32 can meet, and for finer ones.
pub(crate) struct Maps {
    pub coarse: Coordinate,
    pub fine: Coordinate,
}

impl Maps {
    /// The same coordinate for all tolerances.
    pub const fn both(coordinate: Coordinate) -> Self {
        Self { coarse: coordinate, fine: coordinate }
    }
}

/// A coordinate r of tan θm, from 0.
#[derive(Clone, Copy)]
pub(crate) struct Coordinate {
    /// r at which tan θm reaches `t_max`, or at which the rest of the lobe is negligible.
    pub end: fn(t_max: f64, &Setting) -> f64,
    /// tan θm at r.
    pub map: fn(r: f64, &Setting) -> MappedSlope,
}

/// A map's tan θm = p/m at r, and `weight` = w dv/dr / m, where D cos θm dωm = w dv dφ / 2π.
pub(crate) struct MappedSlope {
    pub p: f64,
    pub m: f64,
    pub weight: f64,
}

/// Node counts of integrals with height-correlated Smith and Schlick, and what goes by them.
pub(crate) struct CountRule {
    /// The counts of a texel for a tolerance, where cos φ > 0 and where it is < 0.
    pub counts: fn(mu: f64, &Setting, tolerance: f64) -> [SlopeCounts; 2],
    /// The shaders of the maps, the coarse one first, for the kernel that integrates in slopes.
    pub kernels: Option<[Part; 2]>,
    /// Where ρ(μ, α) is not analytic, if that was measured.
    pub branches: Option<Branches>,
    /// Directions that are not by the map alone.
    pub directions: Option<Directions>,
    /// μ and weights of the mean ρ_hh, where the rule of all models does not see what is in ρ: with a smooth masking, and
    /// with one that has kinks.
    pub means: Option<[Mean; 2]>,
}

impl CountRule {
    /// The counts alone.
    pub const fn new(counts: fn(f64, &Setting, f64) -> [SlopeCounts; 2]) -> Self {
        Self { counts, kernels: None, branches: None, directions: None, means: None }
    }
}

/// Directions whose weighted values add up to ρ, cos θ dω of them; and at most how many. `of_normal` are the kinks of a
/// masking that depends on ωm.
#[derive(Clone, Copy)]
pub(crate) struct Directions {
    pub samples: SampleDirections,
    pub most: fn([SlopeCounts; 2], of_normal: Option<Kinks>) -> usize,
}

/// Directions for a fixed one and a setting, with node counts of both sides, for a tolerance.
pub(crate) type SampleDirections =
    fn(&Fixed, &Setting, [SlopeCounts; 2], tolerance: f64, of_normal: Option<Kinks>) -> Vec<Sample>;

/// cos θ of directions and their weights in the mean ∫ ρ 2μ dμ, at a tolerance.
pub(crate) type Mean = fn(tolerance: f64) -> Vec<Node>;

/// How normals are drawn, for the rules that sample.
pub(crate) struct Draws {
    /// The functions that the sampling kernels call.
    pub part: Part,
    /// A draw of D cos θm.
    pub by_ndf: fn(draw: [f64; 2], mu_e: f64, &Setting) -> Draw,
    /// A draw of the normals that ωe sees.
    pub by_vndf: fn(draw: [f64; 2], mu_e: f64, &Setting) -> Draw,
}

/// A normal (x, ·, m)/√(m² + t2), x along the azimuth of ωe. With q = ωe·ωm √(m² + t2)/μe, its estimate of ρ is
/// F G2 z (weight\[0\] q + weight\[1\]) / 2μe z, z = (m² + t2) μi/μe.
pub(crate) struct Draw {
    pub x: f64,
    pub t2: f64,
    pub m: f64,
    pub weight: [f64; 2],
}
