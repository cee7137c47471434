//! Anisotropic distributions: αx along the tangent, αy along the bitangent. Twin of `shaders/lobe/anisotropic.wgsl`.
//!
//! A distribution that depends on tan θm / α alone (Heitz 2014, §5.3) is stretched with the surface: in the plane of
//! slopes, by αx and αy in place of α.
//!
//! | parameter | range | unit | default | what it is |
//! |---|---|---|---|---|
//! | `alpha` | [1e-6, 1] | | none | α, or `[αx, αy]`, which is α = √(αx αy) and aspect = αx/αy |
//! | `aspect` | [0.01, 100] | | 1 | αx/αy, as Disney's: αx = α √aspect, αy = α/√aspect |
//! | `strength` | [0, 1] | | 0 | of KHR_materials_anisotropy: αx is then mixed with 1 by strength² |
//!
//! With a strength, α below 1e-6 is taken as 1e-6: grooves without width are no surface.
//!
//! Kept: what the isotropic distribution keeps, but isotropy. Values in f32: a half vector near the axis of the larger
//! α is off by that much more: see [`Stretch::ROUNDINGS`]. Limits: equal α are the isotropic model, to rounding.

use crate::base::half_angle::Half;
use crate::base::tolerance::decade;
use crate::model::ndf::{AlbedoBounds, CountRule, Maps, Ndf, Rounding};
use crate::model::parameters::{Parameters, Setting};
use crate::model::{ALPHA_MIN_VALUE, Parameter, Shape, SlopeCounts, Term};
use std::marker::PhantomData;

/// A distribution that can be stretched.
pub(crate) trait Stretch: Ndf {
    /// What recipes call it then.
    const STRETCHED: Term;
    /// The relative error of values in f32, in units of 2⁻²⁴: so many roundings, and so many for each unit of the ratio r
    /// of the larger α to the other. A component of the tangential half vector is off by 4 √2 roundings of its length, which
    /// is at worst r/2 times as much of ht² (stretched); D has that twice (GGX), or times its exponent (Beckmann).
    const ROUNDINGS: [f64; 2];
    /// As [`AlbedoBounds::bounds`], measured where α = 1 and the aspect is 100: along grooves of αx = 10.
    const BOUNDS: &'static [(&'static str, f64)];
    /// Azimuths of each of eight panels and nodes of each azimuth, for tolerances 1e-1 … 1e-10: their errors alone are below
    /// half of these, worst over μ, φ, α and aspects of 0.01 to 100, down to 1e-7. Finer ones would take more turns of a loop
    /// than every driver runs.
    const COUNTS: [[usize; 2]; 10];
}

pub(crate) struct Stretched<N>(PhantomData<N>);

const ASPECT: usize = 0;
const STRENGTH: usize = 1;
/// Where the shader finds 1/√aspect.
const INVERSE: usize = 2;

impl<N: Stretch> Ndf for Stretched<N> {
    const TERM: Term = N::STRETCHED;
    const SHAPE: Shape = Shape::ALPHA_XY;
    const PARAMETERS: &'static [Parameter] = &[
        Parameter {
            name: "aspect",
            summary: "alpha along the tangent over alpha along the bitangent",
            unit: "",
            range: [1e-2, 1e2],
            default: Some(1.0),
            place: ASPECT,
        },
        Parameter {
            name: "strength",
            summary: "of KHR_materials_anisotropy: mixes alpha along the tangent with 1 by strength²",
            unit: "",
            range: [0.0, 1.0],
            default: Some(0.0),
            place: STRENGTH,
        },
    ];
    const AXES: Option<fn(&Setting) -> [f64; 2]> = Some(axes);
    const ALBEDO: AlbedoBounds = AlbedoBounds { bounds: N::BOUNDS, ..AlbedoBounds::CONSERVED };
    const F32: Rounding = Rounding {
        value: (N::ROUNDINGS[0] + N::ROUNDINGS[1]) / (1 << 24) as f64,
        value_at: Some(|s| {
            let [x, y] = axes(s);
            (N::ROUNDINGS[0] + N::ROUNDINGS[1] * (x / y).max(y / x)) / f64::from(1 << 24)
        }),
        ..Rounding::USUAL
    };
    /// The fine one alone, which is its own twin along every azimuth.
    const MAPS: Option<Maps> = match N::MAPS {
        Some(maps) => Some(Maps::both(maps.fine)),
        None => None,
    };
    const RULE: Option<CountRule> = Some(CountRule::new(|_, _, tolerance| {
        let [azimuths, nodes] = N::COUNTS[decade(tolerance)];
        [SlopeCounts { azimuths, nodes }; 2]
    }));

    /// Counts leave 7.6 times 1e-6 with Kelemen's.
    const RULE_HOLDS_TURNS: bool = false;

    fn derive(parameters: &mut Parameters) {
        let root = parameters[ASPECT].sqrt();
        let strength = parameters[STRENGTH];
        [parameters[ASPECT], parameters[STRENGTH], parameters[INVERSE]] =
            [root, strength * strength, 1.0 / root];
    }

    fn ndf(h: &Half, hz2: f64, s: &Setting) -> f64 {
        N::ndf(h, hz2, s)
    }

    fn smith_root(mu: f64, s: &Setting) -> f64 {
        N::smith_root(mu, s)
    }
}

/// αx and αy.
fn axes(&Setting { alpha, parameters }: &Setting) -> [f64; 2] {
    let (root, strength) = (parameters[ASPECT].sqrt(), parameters[STRENGTH]);
    let alpha = if strength > 0.0 { alpha.max(ALPHA_MIN_VALUE) } else { alpha };
    let x = alpha * root;
    [x + (1.0 - x) * strength * strength, alpha / root]
}
