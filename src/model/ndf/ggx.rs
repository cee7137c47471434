//! GGX: Trowbridge & Reitz 1975; Walter et al. 2007, eq. 33. Twin of `shaders/ndf/ggx.wgsl`.

use crate::base::half_angle::Half;
use crate::model::fresnel::Fresnel;
use crate::model::masking::Masking;
use crate::model::ndf::stretched::Stretch;
use crate::model::ndf::{Map, Ndf, ggx_coarse, ggx_fine, ggx_nodes, ggx_samples};
use crate::model::parameters::Setting;
use crate::model::{Branches, Part, SlopeCounts, Term, part};
use std::f64::consts::FRAC_1_PI;

pub(crate) struct Ggx;

impl Ndf for Ggx {
    const TERM: Term = Term {
        name: "ggx",
        summary: "GGX microfacets",
        source: "Walter et al. 2007, eq. 20 and 33",
        part: part!("ndf/ggx", "ndf/smith_of_ggx"),
    };
    const MAPS: Option<[Part; 2]> = Some([ggx_coarse::PART, ggx_fine::PART]);
    const SAMPLES: Option<Part> = Some(ggx_samples::PART);
    /// Smith's root α² + (1 − α²) μ² vanishes at μ = ±iα/√(1 − α²), and the map ends at its own branch point,
    /// α = ±i t_max, at μ = ±2iα/(1 − α²). Measured by `print_the_error_of_spreading`: 1 is too little by a third.
    const BRANCHES: Option<Branches> = Some(Branches { strength: 1.5 });

    /// Measured, of α = 1 where ωi grazes.
    const RHO_BOUNDS: &'static [(&'static str, f64)] = &[("disney-clearcoat", 3.438)];

    fn ndf(h: &Half, hz2: f64, &Setting { alpha, .. }: &Setting) -> f64 {
        let q = alpha * h.h2 / (alpha * alpha * hz2 + h.ht2);
        q * q * FRAC_1_PI
    }

    fn smith_root(mu: f64, &Setting { alpha, .. }: &Setting) -> f64 {
        (alpha * alpha + (1.0 - alpha * alpha) * mu * mu).sqrt()
    }

    fn smith_root_at(x: f64, y: f64, mu_e: f64, &Setting { alpha, .. }: &Setting) -> f64 {
        let (a2, b2) = (alpha * alpha, (1.0 - alpha * alpha) * mu_e * mu_e);
        (a2 * y * y + b2 * x * x).sqrt()
    }

    fn coarse_end(t_max: f64, &Setting { alpha, .. }: &Setting) -> f64 {
        ggx_coarse::map_end(t_max, alpha)
    }

    fn coarse_map(r: f64, &Setting { alpha, .. }: &Setting) -> Map {
        ggx_coarse::map(r, alpha)
    }

    fn fine_end(t_max: f64, &Setting { alpha, .. }: &Setting) -> f64 {
        ggx_fine::map_end(t_max, alpha)
    }

    fn fine_map(r: f64, &Setting { alpha, .. }: &Setting) -> Map {
        ggx_fine::map(r, alpha)
    }

    fn counts(mu: f64, &Setting { alpha, .. }: &Setting, tolerance: f64) -> [SlopeCounts; 2] {
        ggx_nodes::counts(mu, alpha, tolerance)
    }

    fn by_ndf<M: Masking, F: Fresnel>(draw: [f64; 2], mu_e: f64, s: &Setting) -> [f64; 2] {
        ggx_samples::by_ndf::<M, F>(draw, mu_e, s)
    }

    fn by_vndf<M: Masking, F: Fresnel>(draw: [f64; 2], mu_e: f64, s: &Setting) -> [f64; 2] {
        ggx_samples::by_vndf::<M, F>(draw, mu_e, s)
    }
}

impl Stretch for Ggx {
    const STRETCHED: Term = Term {
        name: "ggx-anisotropic",
        summary: "anisotropic GGX microfacets",
        source: "Walter et al. 2007, eq. 20; Heitz 2014, eq. 85 and 86",
        part: Self::TERM.part,
    };
    const ROUNDINGS: [f64; 2] = [60.0, 12.0];
    const RHO_BOUNDS: &'static [(&'static str, f64)] = &[("disney-clearcoat", 22.56)];
    const COUNTS: [[usize; 2]; 10] =
        [[4, 6], [5, 8], [8, 11], [12, 14], [20, 20], [38, 30], [54, 48], [58, 60], [58, 60], [58, 60]];
}

/// Beyond it, in units of α, the lobe holds 1e-18 of its weight.
pub(crate) const TAN_CAP: f64 = 1e9;
