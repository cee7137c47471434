//! Lambert 1760. Twin of `shaders/diffuse/lambert.wgsl`.

use crate::base::precision::VALUE_F32;
use crate::model::{Component, Integral, Model, part};
use std::f64::consts::FRAC_1_PI;

pub(crate) static MODEL: Model = Model {
    name: "lambert",
    summary: "ideal diffuse: f = albedo/π",
    source: "Lambert, Photometria, 1760",
    microfacet: None,
    components: &Component::DIFFUSE,
    shape: None,
    parameters: &[],
    derive: |_| {},
    rho_bound: 1.0,
    parts: &[part!("diffuse/lambert")],
    value_f32: VALUE_F32,
    integral: Integral::Smooth(|_| [8, 1]),
    lobe: |_, _, _| [FRAC_1_PI, 0.0],
};
