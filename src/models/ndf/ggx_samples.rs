//! Importance sampling of GGX. Twin of `shaders/ndf/ggx_samples.wgsl`, which has the derivation.

use crate::models::fresnel::schlick::fresnel;
use crate::models::masking::smith::{masking, root};
use crate::models::{Part, Sampling, part};

pub(crate) const SAMPLING: Sampling = Sampling { part: PART, ndf: by_ndf, vndf: by_vndf };
const PART: Part = part!("ndf/ggx_samples");

/// f μi / p for a draw (t, cos φ) of D cos θm.
fn by_ndf([t, cos_phi]: [f64; 2], mu: f64, alpha: f64) -> [f64; 2] {
    let tan = alpha * t;
    estimate([tan * cos_phi, tan * tan, 1.0], mu, alpha, |q| 2.0 * mu * q)
}

/// f μi / p for a draw (u, cos φ) of the normals that ωe sees.
fn by_vndf([u, cos_phi]: [f64; 2], mu: f64, alpha: f64) -> [f64; 2] {
    let root = root(mu, alpha);
    let w_x = alpha * sine(mu) / root;
    let w_z = 1.0 + mu / root;
    let m = u * w_z;
    let sin2 = (1.0 - u) * (m * w_z + w_x * w_x);
    let x = sin2.sqrt() * cos_phi + w_x;
    let t2 = x * x + sin2 * (1.0 - cos_phi * cos_phi).max(0.0);
    estimate([alpha * x, alpha * alpha * t2, m], mu, alpha, |_| mu + root)
}

fn estimate([x, t2, m]: [f64; 3], mu: f64, alpha: f64, weight: impl Fn(f64) -> f64) -> [f64; 2] {
    let q = sine(mu) / mu * x + m;
    let y = m * m + t2;
    let z = (2.0 * q * m - y).max(0.0);
    let all = z * weight(q) / masking(z, y, mu, alpha);
    let c = (mu * q / y.sqrt()).min(1.0);
    if z == 0.0 { [0.0; 2] } else { fresnel(c, 1.0 - c).map(|f| f * all) }
}

fn sine(mu: f64) -> f64 {
    ((1.0 - mu) * (1.0 + mu)).sqrt()
}
