//! The GGX microfacet lobe with height-correlated Smith masking and Schlick's Fresnel. Twin of
//! `shaders/lobe/microfacet.wgsl`, put together for these parts.

use super::fresnel::schlick::{self, fresnel};
use super::masking::smith::{self, masking, visibility};
use super::ndf::ggx::{self, Map, ndf};
use super::ndf::{ggx_coarse, ggx_fine, ggx_nodes, ggx_samples};
use super::{Component, Integral, Model, SlopeMap, Slopes, part};
use crate::pair::Half;
use crate::reference;

pub(crate) static MODEL: Model = Model {
    name: "ggx",
    summary: "GGX microfacets, height-correlated Smith, Schlick: f = F0·A + F90·B",
    source: "Walter et al. 2007, eq. 20 and 33; Heitz 2014, eq. 99; Schlick 1994, eq. 15",
    components: &Component::schlick(0.04),
    has_roughness: true,
    rho_bound: 1.0,
    parts: &[schlick::PART, ggx::PART, smith::PART, part!("lobe/microfacet")],
    integral: Integral::Slopes(&Slopes {
        coarse: SlopeMap {
            part: ggx_coarse::PART,
            end: ggx_coarse::map_end,
            integrand: |r, azimuth, mu_e, alpha| integrand(ggx_coarse::map(r, alpha), azimuth, mu_e, alpha),
        },
        fine: SlopeMap {
            part: ggx_fine::PART,
            end: ggx_fine::map_end,
            integrand: |r, azimuth, mu_e, alpha| integrand(ggx_fine::map(r, alpha), azimuth, mu_e, alpha),
        },
        counts: ggx_nodes::counts,
        mirror_limit: |mu_e| fresnel(mu_e, 1.0 - mu_e),
        sampling: ggx_samples::SAMPLING,
    }),
    lobe: |p, a, alpha| {
        let h = Half::new(p, a);
        let s = ndf(&h, p.hz2, alpha) * visibility(p.mu_i, p.mu_e, alpha);
        fresnel(h.c, h.one_minus_c).map(|f| f * s)
    },
    reference: Some(reference::GGX),
};

fn integrand(map: Map, [mu_c, t_max, t_max_inverse]: [f64; 3], mu_e: f64, alpha: f64) -> [f64; 2] {
    let Map { p, m, weight } = map;
    let projected = mu_e * m + mu_c * p; // ωe·ωm √y
    let y = m * m + p * p;
    let x = (t_max * m - p) * (p + t_max_inverse * m); // cos θi = μe x/y
    let all = 2.0 * x * projected * weight / masking(x, y, mu_e, alpha);
    let c = (projected / y.sqrt()).min(1.0);
    fresnel(c, 1.0 - c).map(|f| f * all)
}
