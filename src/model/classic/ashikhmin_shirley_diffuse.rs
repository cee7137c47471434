//! Ashikhmin & Shirley 2000, *An Anisotropic Phong BRDF Model*, what is below its specular part. Twin of
//! `shaders/classic/ashikhmin_shirley_diffuse.wgsl`.
//!
//! ```text
//! f = albedo · 28/(23π) (1 − (1 − μi/2)⁵)(1 − (1 − μe/2)⁵)
//! ```
//!
//! | parameter | range | unit | default | |
//! |---|---|---|---|---|
//! | `albedo` | [0, 1] | – | none | weighs A; below a specular part Rd (1 − Rs) |
//!
//! What the surface lets through, on the way in and out: dark at grazing, where it reflects. With `ashikhmin-shirley` of
//! f0 = Rs above and albedo = Rd (1 − Rs) it is the paper's model.
//!
//! Kept: finite, bounded, not negative, reciprocal to the bit; energy: ρ_dh = 1 − (1 − μ/2)⁵, 31/32 at the normal.

use crate::base::precision::VALUE_F32;
use crate::base::tolerance::decade;
use crate::model::{Component, Integral, Model, part};
use std::f64::consts::PI;

pub(crate) static MODEL: Model = Model {
    name: "ashikhmin-shirley-diffuse",
    summary: "what Ashikhmin and Shirley have below their specular lobe",
    source: "Ashikhmin & Shirley 2000, the diffuse term",
    microfacet: None,
    components: &Component::DIFFUSE,
    shape: None,
    parameters: &[],
    derive: |_| {},
    rho_bound: 1.0,
    parts: &[part!("classic/ashikhmin_shirley_diffuse")],
    value_f32: VALUE_F32,
    integral: Integral::Smooth(nodes),
    lobe: |p, _, _| [28.0 / (23.0 * PI) * through(p.mu_i) * through(p.mu_e), 0.0],
};

/// 1 − (1 − μ/2)⁵
fn through(mu: f64) -> f64 {
    let x = 1.0 - 0.5 * mu;
    let x2 = x * x;
    0.5 * mu * (1.0 + x + x2 * (1.0 + x + x2))
}

/// Nodes in θe for tolerances 1e-1 … 1e-10, as of Disney's lobe, whose powers are the same; f knows no azimuth.
fn nodes(tolerance: f64) -> [usize; 2] {
    const COUNTS: [usize; 10] = [3, 4, 5, 6, 7, 8, 9, 9, 10, 11];
    [COUNTS[decade(tolerance)], 1]
}
