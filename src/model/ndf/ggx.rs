//! GGX: Trowbridge & Reitz 1975; Walter et al. 2007, eq. 33. Twin of `shaders/ndf/ggx.wgsl`.

use crate::base::half_angle::Half;
use crate::model::ndf::stretched::Stretch;
use crate::model::ndf::{
    AlbedoBounds, Coordinate, CountRule, Draws, Maps, Ndf, ggx_coarse, ggx_fine, ggx_nodes, ggx_samples,
};
use crate::model::parameters::Setting;
use crate::model::{Branches, Term, part};
use std::f64::consts::FRAC_1_PI;

pub(crate) struct Ggx;

impl Ndf for Ggx {
    const TERM: Term = Term {
        name: "ggx",
        summary: "GGX microfacets",
        source: "Walter et al. 2007, eq. 20 and 33",
        part: part!("ndf/ggx", "ndf/smith_of_ggx"),
    };
    /// Measured, of α = 1 where ωi grazes.
    const ALBEDO: AlbedoBounds =
        AlbedoBounds { bounds: &[("disney-clearcoat", 3.438)], ..AlbedoBounds::CONSERVED };
    const MAPS: Option<Maps> = Some(Maps {
        coarse: Coordinate {
            end: |t_max, s| ggx_coarse::map_end(t_max, s.alpha),
            map: |r, s| ggx_coarse::map(r, s.alpha),
        },
        fine: Coordinate {
            end: |t_max, s| ggx_fine::map_end(t_max, s.alpha),
            map: |r, s| ggx_fine::map(r, s.alpha),
        },
    });
    /// Smith's root α² + (1 − α²) μ² vanishes at μ = ±iα/√(1 − α²), and the map ends at its own branch point,
    /// α = ±i t_max, at μ = ±2iα/(1 − α²). Measured by
    /// `interpolation_keeps_its_share_over_any_range` (`src/integrate/chebyshev.rs`): 8 leaves 2.8 times the share.
    const RULE: Option<CountRule> = Some(CountRule {
        kernels: Some([ggx_coarse::PART, ggx_fine::PART]),
        branches: Some(Branches { strength: 24.0 }),
        ..CountRule::new(|mu, s, tolerance| ggx_nodes::counts(mu, s.alpha, tolerance))
    });
    const DRAWS: Option<Draws> = Some(ggx_samples::DRAWS);

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
}

impl Stretch for Ggx {
    const STRETCHED: Term = Term {
        name: "ggx-anisotropic",
        summary: "anisotropic GGX microfacets",
        source: "Walter et al. 2007, eq. 20; Heitz 2014, eq. 85 and 86",
        part: Self::TERM.part,
    };
    const ROUNDINGS: [f64; 2] = [60.0, 12.0];
    /// Of cloth's visibility half of what the facets cover as seen from the side, αx, where ωi grazes.
    const BOUNDS: &'static [(&'static str, f64)] = &[("disney-clearcoat", 22.56), ("ashikhmin-neubelt", 5.0)];
    const COUNTS: [[usize; 2]; 10] =
        [[4, 6], [5, 8], [8, 11], [12, 14], [20, 20], [38, 30], [54, 48], [58, 60], [58, 60], [58, 60]];
}

/// The cap of the coarse map: beyond it, in units of α, the lobe holds 1e-18 of its weight.
pub(crate) const TAN_CAP: f64 = 1e9;
