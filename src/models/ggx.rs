//! The GGX microfacet lobe with height-correlated Smith masking and Schlick's Fresnel. Twin of
//! `shaders/lobe/microfacet.wgsl`, put together for these parts.

use super::fresnel::schlick::{self, fresnel};
use super::masking::smith::{self, masking, visibility};
use super::ndf::ggx::{self, Map, map, map_end, ndf};
use super::ndf::ggx_nodes;
use super::ndf::ggx_samples;
use super::{Component, Integral, Model, Slopes, part};
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
        end: map_end,
        integrand: slope_integrand,
        azimuths: ggx_nodes::azimuths,
        nodes: ggx_nodes::nodes,
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

fn slope_integrand(r: f64, [c, t_max, t_max_inverse]: [f64; 3], mu_e: f64, alpha: f64) -> [f64; 2] {
    let Map { p, m, weight, divisor } = map(r, alpha);
    let projected = m + c * p;
    let sec2 = m * m + p * p;
    let mu_i = mu_e * ((t_max * m - p) * (p + t_max_inverse * m)).max(0.0);
    let all = 2.0 * mu_e * mu_i * projected * weight / (masking(mu_i, sec2, mu_e, alpha) * m * divisor);
    let c = (mu_e * projected / sec2.sqrt()).min(1.0);
    fresnel(c, 1.0 - c).map(|f| f * all)
}
