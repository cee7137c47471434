//! Diffuse lobes.

pub(crate) mod burley;
pub(crate) mod disney;
pub(crate) mod eon;
pub(crate) mod frostbite;
pub(crate) mod fujii;
pub(crate) mod gltf;
pub(crate) mod gltf_oren_nayar;
pub(crate) mod lambert;
pub(crate) mod oren_nayar;

use crate::directions::Pair;

/// (sin θi, sin θe), of the directions that the cosines of a pair are of.
fn sines(pair: &Pair) -> [f64; 2] {
    [pair.mu_i * pair.tan2_i.sqrt(), pair.mu_e * pair.tan2_e.sqrt()]
}
