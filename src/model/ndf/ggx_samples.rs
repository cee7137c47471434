//! Importance sampling of GGX. Twin of `shaders/ndf/ggx_samples.wgsl`, which has the derivation.

use crate::model::fresnel::Fresnel;
use crate::model::masking::Masking;
use crate::model::ndf::Ndf;
use crate::model::ndf::ggx::Ggx;
use crate::model::parameters::Setting;
use crate::model::{Part, part};

pub(crate) const PART: Part = part!("ndf/ggx_samples");

/// f μi / p for a draw (t, cos φ) of D cos θm.
pub(crate) fn by_ndf<M: Masking, F: Fresnel>([t, cos_phi]: [f64; 2], mu: f64, s: &Setting) -> [f64; 2] {
    let alpha = s.alpha;
    let tan = alpha * t;
    estimate::<M, F>([tan * cos_phi, tan * tan, 1.0], mu, s, |q| 2.0 * mu * q)
}

/// f μi / p for a draw (u, cos φ) of the normals that ωe sees.
pub(crate) fn by_vndf<M: Masking, F: Fresnel>([u, cos_phi]: [f64; 2], mu: f64, s: &Setting) -> [f64; 2] {
    let alpha = s.alpha;
    let root = Ggx::smith_root(mu, s);
    let w_x = alpha * sine(mu) / root;
    let w_z = 1.0 + mu / root;
    let m = u * w_z;
    let sin2 = (1.0 - u) * (m * w_z + w_x * w_x);
    let x = sin2.sqrt() * cos_phi + w_x;
    let t2 = x * x + sin2 * (1.0 - cos_phi * cos_phi).max(0.0);
    estimate::<M, F>([alpha * x, alpha * alpha * t2, m], mu, s, |_| mu + root)
}

fn estimate<M: Masking, F: Fresnel>(
    [x, t2, m]: [f64; 3],
    mu: f64,
    s: &Setting,
    weight: impl Fn(f64) -> f64,
) -> [f64; 2] {
    let q = sine(mu) / mu * x + m;
    let y = m * m + t2;
    let z = (2.0 * q * m - y).max(0.0);
    let all = z * weight(q) / M::masking::<Ggx>(z, y, mu, s);
    let c = (mu * q / y.sqrt()).min(1.0);
    if z == 0.0 { [0.0; 2] } else { F::fresnel(c, 1.0 - c, s).map(|f| f * all) }
}

fn sine(mu: f64) -> f64 {
    ((1.0 - mu) * (1.0 + mu)).sqrt()
}
