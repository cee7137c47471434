//! Importance sampling of GGX. Twin of `shaders/ndf/ggx_samples.wgsl`, which has the derivation.

use crate::base::half_angle::sine;
use crate::model::ndf::ggx::Ggx;
use crate::model::ndf::{Draw, Draws, Ndf};
use crate::model::parameters::Setting;
use crate::model::part;

pub(super) const DRAWS: Draws = Draws { part: part!("ndf/ggx_samples"), by_ndf, by_vndf };

/// The normal of a draw (t, cos φ) of D cos θm.
fn by_ndf([t, cos_phi]: [f64; 2], mu: f64, s: &Setting) -> Draw {
    let tan = s.alpha * t;
    Draw { x: tan * cos_phi, t2: tan * tan, m: 1.0, weight: [2.0 * mu, 0.0] }
}

/// The normal of a draw (u, cos φ) of the normals that ωe sees.
fn by_vndf([u, cos_phi]: [f64; 2], mu: f64, s: &Setting) -> Draw {
    let alpha = s.alpha;
    let root = Ggx::smith_root(mu, s);
    let w_x = alpha * sine(mu) / root;
    let w_z = 1.0 + mu / root;
    let m = u * w_z;
    let sin2 = (1.0 - u) * (m * w_z + w_x * w_x);
    let x = sin2.sqrt() * cos_phi + w_x;
    let t2 = x * x + sin2 * (1.0 - cos_phi * cos_phi).max(0.0);
    Draw { x: alpha * x, t2: alpha * alpha * t2, m, weight: [0.0, mu + root] }
}
