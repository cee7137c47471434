//! The GGX microfacet lobe with height-correlated Smith masking and Schlick's Fresnel. Twin of
//! `shaders/lobe/microfacet.wgsl`, put together for these parts.

use super::fresnel::schlick::{self, fresnel};
use super::masking::smith::{self, visibility};
use super::ndf::ggx::{self, map, map_end, ndf};
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
        mirror_limit: |mu_e| fresnel(mu_e, 1.0 - mu_e),
    }),
    lobe: |p, a, alpha| {
        let h = Half::new(p, a);
        let s = ndf(&h, p.hz2, alpha) * visibility(p.mu_i, p.mu_e, alpha);
        fresnel(h.c, h.one_minus_c).map(|f| f * s)
    },
    reference: Some(reference::GGX),
};

fn slope_integrand(r: f64, [c, t_max, t_max_inverse]: [f64; 3], mu_e: f64, alpha: f64) -> [f64; 2] {
    let [t, weight] = map(r, alpha);
    let cos2_m = 1.0 / (1.0 + t * t);
    let projected = 1.0 + c * t;
    let mu_i = (cos2_m * mu_e * (t_max - t) * (t + t_max_inverse)).max(0.0);
    let g2 = 4.0 * mu_i * mu_e * visibility(mu_i, mu_e, alpha);
    let c = (mu_e * projected * cos2_m.sqrt()).min(1.0);
    fresnel(c, 1.0 - c).map(|f| f * g2 * projected * weight)
}
