//! Diffuse lobes.

pub(super) mod burley;
pub(super) mod disney;
pub(super) mod eon;
pub(super) mod frostbite;
pub(super) mod fujii;
pub(super) mod gltf;
pub(super) mod gltf_oren_nayar;
pub(super) mod lambert;
pub(super) mod oren_nayar;

use crate::reference::directions::Pair;

/// (sin θi, sin θe), of the directions that the cosines of a pair are of.
fn sines(pair: &Pair) -> [f64; 2] {
    [pair.mu_i * pair.tan2_i.sqrt(), pair.mu_e * pair.tan2_e.sqrt()]
}
