//! Lafortune, Foo, Torrance & Greenberg 1997, *Non-Linear Approximation of Reflectance Functions*: one of their generalised
//! cosine lobes (section 4, eq. 5 and 6), isotropic. Twin of `shaders/classic/lafortune.wgsl`.
//!
//! ```text
//! f = specular · (n + 2)/(2π) max(0, Cx ux vx + Cy uy vy + Cz uz vz)ⁿ,   u = ωi, v = ωe, Cx = Cy,   n = 2/α² − 1
//! ```
//!
//! | parameter | range | unit | default | |
//! |---|---|---|---|---|
//! | `roughness`, or `alpha` | [0, 1] | – | none | α = roughness², the lobe's width about its axis; 0 has integrals alone |
//! | `cxy` | [−1, 1] | – | −1 | Cx = Cy: −1 is forward, 0 turns to the normal, 1 back to ωi |
//! | `cz` | [0, 1] | – | 1 | Cz: less than \|Cx\| leans the lobe to the horizon |
//! | `specular` | [0, 1] | – | 1 | weighs A |
//!
//! Cu is the lobe's axis, and |Cu|ⁿ scales it: (−1, 1) is Phong's, |Cx| > Cz is off-specular, 1 returns light, and (0, 1) is
//! (n + 2)/(2π) (μi μe)ⁿ. The paper has no factor and any C; a common factor of both is one of f, so that every lobe of it
//! is one of these times a weight: C/m and mⁿ 2π/(n + 2), m the larger of both. What is measured is a sum of some such lobes.
//!
//! ρ_dh is |Cu|ⁿ times that of Phong's about the axis. α → 0 tends to a mirror that reflects μ at (−1, 1), to what returns μ
//! at (1, 1), and to nothing at others but where |Cu| = 1.
//!
//! Kept: finite, bounded, not negative, reciprocal to the bit; energy, as |Cu| ≤ 1.

use crate::base::quadrature::Node;
use crate::base::tolerance::decade;
use crate::model::classic::axis;
use crate::model::classic::axis::{AXIS_F32, LobeAxis};
use crate::model::directions::Map;
use crate::model::half_vector::mean_by;
use crate::model::parameters::Parameters;
use crate::model::{Component, Integral, Model, Parameter, Shape, part};

pub(crate) static MODEL: Model = Model {
    name: "lafortune",
    summary: "Lafortune's cosine lobe about any axis: off-specular, or back to where light is from",
    source: "Lafortune, Foo, Torrance & Greenberg 1997, eq. 5 and 6, Cx = Cy, each lobe normalised",
    microfacet: None,
    components: &Component::SPECULAR,
    shape: Some(Shape::ABOUT_AXIS),
    parameters: &PARAMETERS,
    derive,
    rho_bound: 1.0,
    parts: &[axis::PART, part!("classic/lafortune")],
    value_f32: AXIS_F32,
    integral: Integral::Listed(Map {
        samples: |fixed, s, tolerance| axis::samples(fixed, &of(&s.parameters), s.alpha, tolerance),
        most: |_, tolerance| axis::most(tolerance),
        mean: Some(mean),
        limit: |mu, s| axis::is_narrow(s).then(|| [of(&s.parameters).narrow(mu), 0.0]),
    }),
    lobe: |p, a, s| {
        let LobeAxis { cxy, cz } = of(&s.parameters);
        let mu2 = p.mu_i * p.mu_e;
        let cosine = cz * mu2 - cxy * p.ss * (a.cos2 - a.sin2);
        let turned = (1.0 - cxy) * a.sin2 + (1.0 + cxy) * a.cos2;
        axis::power(cosine, 2.0 * p.sd + (1.0 - cz) * mu2 + p.ss * turned, s)
    },
};

const CXY: usize = 0;
const CZ: usize = 1;

static PARAMETERS: [Parameter; 2] = [
    Parameter {
        name: "cxy",
        summary: "Cx = Cy of the lobe: -1 forward, 1 back",
        unit: "",
        range: [-1.0, 1.0],
        default: Some(-1.0),
        place: CXY,
    },
    Parameter {
        name: "cz",
        summary: "Cz of the lobe: below |cxy| it leans to the horizon",
        unit: "",
        range: [0.0, 1.0],
        default: Some(1.0),
        place: CZ,
    },
];

fn of(parameters: &Parameters) -> LobeAxis {
    LobeAxis { cxy: parameters[CXY], cz: parameters[CZ] }
}

/// 1 − Cx, 1 + Cx and 1 − Cz: of a rounded C they would lose digits, which n multiplies.
fn derive(parameters: &mut Parameters) {
    let LobeAxis { cxy, cz } = of(parameters);
    [parameters[2], parameters[3], parameters[4]] = [1.0 - cxy, 1.0 + cxy, 1.0 - cz];
}

/// Of the mean of ρ. Where Cz = 1 and |Cx| is less, all of it is where θ ~ α, and that is on any scale: nodes crowd as the
/// cube. For tolerances 1e-1 … 1e-10, measured over α for Cx from 0 to −0.9999, 0.4 of the tolerance is left; below, the
/// nodes of others' kinks leave a quarter of it for |Cx| = 1 and any Cz.
fn mean(tolerance: f64) -> Vec<Node> {
    const NODES: [[usize; 2]; 10] =
        [[3, 3], [4, 5], [6, 8], [8, 12], [12, 19], [16, 22], [20, 31], [26, 40], [32, 49], [40, 58]];
    mean_by(NODES[decade(tolerance)], 3)
}
