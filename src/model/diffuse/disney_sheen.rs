//! The sheen of Burley 2012, *Physically-Based Shading at Disney*; the formula is `FH` of BRDF Explorer's `disney.brdf`.
//! Twin of `shaders/diffuse/disney_sheen.wgsl`.
//!
//! ```text
//! f = color · (1 − ωi·ωm)⁵
//! ```
//!
//! | parameter | range | unit | default | |
//! |---|---|---|---|---|
//! | `color` | [0, 1] | – | none | sheen · Csheen, weighs A |
//!
//! Light from behind at grazing, nothing elsewhere.
//!
//! Kept: finite, bounded (1), not negative, reciprocal to the bit; energy: ρ_dh is 2.6e-4 at the normal and 0.0885 where ωi
//! grazes.

use crate::base::half_angle::Half;
use crate::base::precision::VALUE_F32;
use crate::base::tolerance::decade;
use crate::model::fresnel::schlick;
use crate::model::{Component, Integral, Model, part};

pub(crate) static MODEL: Model = Model {
    name: "disney-sheen",
    summary: "Disney's sheen, Schlick's weight as a lobe: f = color (1 − ωi·ωm)⁵",
    source: "Burley 2012; disney.brdf",
    microfacet: None,
    components: &[Component { name: "A", weight: "color", default: None }],
    shape: None,
    parameters: &[],
    derive: |_| {},
    rho_bound: 1.0,
    parts: &[schlick::PART, part!("diffuse/disney_sheen")],
    value_f32: VALUE_F32,
    integral: Integral::Smooth(nodes),
    lobe: |p, a, _| {
        let h = Half::new(p, a);
        [schlick::fresnel(h.c, h.one_minus_c)[1], 0.0]
    },
};

/// Nodes in θe and δφ for tolerances 1e-1 … 1e-10, measured: the error of each count alone, worst over
/// θi, is below a quarter of the tolerance.
fn nodes(tolerance: f64) -> [usize; 2] {
    const COUNTS: [[usize; 2]; 10] =
        [[1, 2], [3, 4], [4, 5], [5, 7], [7, 9], [9, 11], [12, 14], [17, 20], [22, 27], [29, 33]];
    COUNTS[decade(tolerance)]
}
