//! Distributions of microfacet normals.

pub(crate) mod beckmann;
pub(crate) mod ggx;
pub(crate) mod ggx_coarse;
pub(crate) mod ggx_fine;
pub(crate) mod ggx_nodes;
pub(crate) mod ggx_samples;
pub(crate) mod stretched;

use super::fresnel::Fresnel;
use super::masking::Masking;
use super::{Branches, Parameter, Part, Shape, SlopeCounts, Term};
use crate::pair::Half;
use crate::reference;
use crate::setting::{Parameters, Setting};

/// A distribution of normals, with the maps that integrate and sample it.
pub(crate) trait Ndf {
    const TERM: Term;
    const REFERENCE: &'static dyn reference::Ndf;
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
    const VALUE_F32: f64 = crate::plan::VALUE_F32;
    /// Where ρ(μ, α) is not analytic, if that was measured.
    const BRANCHES: Option<Branches> = None;

    /// Whether α differs along the tangent and the bitangent.
    const STRETCHES: bool = false;

    /// The relative error of its values in f32 at a setting.
    fn value_f32(_s: &Setting) -> f64 {
        Self::VALUE_F32
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

    /// r at which tan θm reaches `t_max`, and the map there.
    fn fine_end(t_max: f64, s: &Setting) -> f64;
    fn fine_map(r: f64, s: &Setting) -> Map;
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

/// A map's tan θm = p/m at r, and `weight` = w dv/dr / m, where D cos θm dωm = w dv dφ / 2π.
pub(crate) struct Map {
    pub p: f64,
    pub m: f64,
    pub weight: f64,
}
