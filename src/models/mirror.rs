//! The ideal mirror. Twin of `shaders/delta/mirror.wgsl`.

use super::fresnel::schlick::{self, fresnel};
use super::{Component, Integral, Model, part};
use crate::reference;

pub(crate) static MODEL: Model = Model {
    name: "mirror",
    summary: "the ideal mirror, a delta, with Schlick's Fresnel: no values, integrals in closed form",
    source: "f = F δ(θi − θe) δ(φi + π − φe) / (cos θi sin θi)",
    microfacet: None,
    components: &Component::schlick(1.0),
    shape: None,
    parameters: &[],
    derive: |_| {},
    rho_bound: 1.0,
    parts: &[schlick::PART, part!("delta/mirror")],
    integral: Integral::Delta(|mu, _| fresnel(mu, 1.0 - mu)),
    lobe: |p, a, _| fresnel(p.mu_i, 1.0 - p.mu_i).map(|f| f * p.bin * a.bin),
    reference: Some(reference::MIRROR),
};
