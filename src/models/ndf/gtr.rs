//! GTR, generalised Trowbridge–Reitz: Burley 2012, *Physically-Based Shading at Disney*, appendix B.2. Twin of
//! `shaders/ndf/gtr.wgsl`.
//!
//! ```text
//! D = c / (α² cos²θm + sin²θm)^γ,   c = (γ − 1)(1 − α²)/(π (α^(2 − 2γ) − 1)),   at γ = 1: (1 − α²)/(π ln 1/α²)
//! ```
//!
//! | parameter | range | unit | default | |
//! |---|---|---|---|---|
//! | `alpha` | (0, 1] | – | none | or `roughness`, alpha = roughness² |
//! | `gamma` | [1, 4] | – | 2 | how soon the tail ends |
//!
//! γ = 2 is GGX; 1 is Disney's clearcoat, whose glow reaches far out; 4 nearly Beckmann's edge. α = 1 is D = 1/π for every
//! γ. Smith's Λ is GGX's with the same α: these normals' own at γ = 2 alone. Below γ = 1, α → 0 would be no mirror.
//!
//! Kept: finite, not negative, reciprocal; energy where γ = 2. Broken: energy below γ = 2, as Λ is another's. For γ < 3/2 the
//! tail lets ρ_dh at μ ~ α grow as α^(2γ − 3), beyond any bound: of γ = 1 it is 1.9 at α = 0.3, 3.9 at 0.1, 21 at 0.01 and
//! 145 at 0.001, Disney's glossiest; of γ = 3/2, 1.4, 1.9, 3.2 and 4.6. Above γ = 2 it is at most 1, and light is lost.

use super::{Map, Ndf};
use crate::models::{Parameter, SlopeCounts, Term, decade, part};
use crate::pair::Half;
use crate::reference;
use crate::setting::Setting;
use std::f64::consts::FRAC_1_PI;

pub(crate) struct Gtr;

const GAMMA: usize = 0;

/// The relative error of its values in f32, in units of 2⁻²⁴: the 40 of every lobe, and of the exponent y =
/// γ ln(1 + …) ≤ 4 · 28 = 112 nine roundings: four of its quotient, four of the logarithm, one of γ's product.
const GTR_F32: f64 = (40.0 + 9.0 * 112.0) / (1 << 24) as f64;

impl Ndf for Gtr {
    const TERM: Term = Term {
        name: "gtr",
        summary: "generalised Trowbridge–Reitz microfacets, GGX's Λ",
        source: "Burley 2012, appendix B.2",
        part: part!("ndf/gtr", "elementary"),
    };
    const REFERENCE: &'static dyn reference::Ndf = &reference::Gtr;
    const PARAMETERS: &'static [Parameter] = &[Parameter {
        name: "gamma",
        summary: "how soon the tail ends: 1 Disney's clearcoat, 2 GGX",
        unit: "",
        range: [1.0, 4.0],
        default: Some(2.0),
        place: GAMMA,
    }];
    const VALUE_F32: f64 = GTR_F32;
    /// None for γ < 3/2.
    const RHO_BOUND: f64 = f64::INFINITY;

    fn ndf(h: &Half, hz2: f64, s: &Setting) -> f64 {
        let Setting { alpha, .. } = *s;
        let (a2, flat) = (alpha * alpha, (1.0 - alpha) * (1.0 + alpha));
        peak(s) * (-s.parameters[GAMMA] * (flat * h.ht2 / (a2 * (hz2 + h.ht2))).ln_1p()).exp()
    }

    fn smith_root(mu: f64, &Setting { alpha, .. }: &Setting) -> f64 {
        (alpha * alpha + (1.0 - alpha * alpha) * mu * mu).sqrt()
    }

    /// tan θm = α sinh v; beyond the cap, the lobe has 1e-13 of its weight, and of what G2 leaves of (ωe·ωm)/μe.
    fn fine_end(t_max: f64, s: &Setting) -> f64 {
        end(t_max, 30.0, s)
    }

    fn coarse_end(t_max: f64, s: &Setting) -> f64 {
        end(t_max, 18.0, s)
    }

    fn fine_map(v: f64, s: &Setting) -> Map {
        let (sinh, cosh) = (v.sinh(), v.cosh());
        let tan = s.alpha * sinh;
        let h2 = 1.0 + tan * tan;
        let half = Half { ht2: tan * tan, h2, c: 1.0, one_minus_c: 0.0 };
        // D cos θm dωm = 2π D t/(1 + t²)² dt dφ/2π
        let weight = 2.0 * std::f64::consts::PI * Self::ndf(&half, 1.0, s) * tan / (h2 * h2) * s.alpha * cosh;
        Map { p: tan, m: 1.0, weight }
    }

    /// In proportion to the map's length, a logarithm of 1/α. Azimuths are measured, to spare. Nodes are too few for
    /// γ near 1 and tolerances below 1e-4, where G2 bends within α of the horizon and the tail still has weight there: then
    /// the second rule of a table says that it misses its tolerance.
    fn counts(mu: f64, s: &Setting, tolerance: f64) -> [SlopeCounts; 2] {
        let d = decade(tolerance);
        let longest =
            if crate::models::is_fine(tolerance) { Self::fine_end } else { Self::coarse_end }(2.0 / mu, s);
        let nodes = (6.0 + 4.0 * d as f64 + longest * (0.6 + 0.5 * d as f64)).ceil() as usize;
        let azimuths = 5 + 5 * d;
        [SlopeCounts { azimuths, nodes }; 2]
    }
}

/// D at θm = 0: (1 − α²)/(π α² l) · g/(1 − e^(−g)), l = ln 1/α², g = (γ − 1) l.
fn peak(s: &Setting) -> f64 {
    let (a2, flat) = (s.alpha * s.alpha, (1.0 - s.alpha) * (1.0 + s.alpha));
    let log = (flat / a2).ln_1p();
    let g = (s.parameters[GAMMA] - 1.0) * log;
    let share = if g == 0.0 { 1.0 } else { g / -(-g).exp_m1() };
    let slope = if flat == 0.0 { 1.0 } else { flat / log };
    FRAC_1_PI / a2 * slope * share
}

/// v at which tan θm reaches `t_max`, or beyond which e^(−`digits`) is left of the weight: per unit of v, and with (ωe·ωm)/μe
/// for the worst ωe, it falls as (α/tan θm)^(2γ − 3) as far as tan θm = 1, and from there as 1/tan θm.
fn end(t_max: f64, digits: f64, s: &Setting) -> f64 {
    let (tail, log) = (2.0 * s.parameters[GAMMA] - 3.0, -s.alpha.ln());
    let most = if digits < tail * log { digits / tail } else { log + digits - tail * log };
    (t_max / s.alpha).asinh().min(most + 1.0)
}
