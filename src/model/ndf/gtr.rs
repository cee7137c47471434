//! GTR, generalised Trowbridge–Reitz: Burley 2012, *Physically-Based Shading at Disney*, appendix B. Twin of
//! `shaders/ndf/gtr.wgsl`.
//!
//! ```text
//! D = c / (α² cos²θm + sin²θm)^γ,   c = (γ − 1)(1 − α²)/(π (α^(2 − 2γ) − 1)),   at γ = 1: (1 − α²)/(π ln 1/α²)
//! ```
//!
//! | parameter | range | unit | default | |
//! |---|---|---|---|---|
//! | `alpha` | [0, 1] | – | none | or `roughness`, alpha = roughness²; at least 1/1000, as in Disney's own code; 1 is D = 1/π |
//! | `gamma` | [1, 10] | – | 2 | how soon the tail ends |
//!
//! γ = 2 is GGX; 1 is Disney's clearcoat, whose glow reaches far out; 10 has Beckmann's edge, and is as if α were a third.
//!
//! Smith's Λ is GGX's with the same α, as Disney has it: these normals' own has no closed form. Disney masks the clearcoat
//! with α = 1/4 whatever its gloss, which is disney-clearcoat here.
//!
//! Kept: finite, not negative, reciprocal; energy where γ ≥ 2. Broken below: the normals that ωe sees from grazing cover
//! [`side`] of the surface, where Λ has α. So Smith's ρ_dh there is their ratio, which no μ exceeds: of γ = 1, (1 −
//! α)/(α ln 1/α), that is 1.9 at α = 0.3, 3.9 at 0.1, 21 at 0.01 and 145 at 0.001; of γ = 3/2, 1.4, 1.9, 3.2 and 4.6.
//! Above γ = 2 light is lost. α → 0 is not joined to the mirror, as γ = 1 reaches it by a logarithm alone.

use crate::base::half_angle::Half;
use crate::base::quadrature::{Node, gauss_legendre};
use crate::base::tolerance::{decade, is_fine};
use crate::model::directions::{Fixed, Sample};
use crate::model::half_vector;
use crate::model::half_vector::{HorizonTurn, Kinks};
use crate::model::ndf::{AlbedoBounds, Coordinate, CountRule, Directions, MappedSlope, Maps, Ndf, Rounding};
use crate::model::parameters::Setting;
use crate::model::{Parameter, Shape, SlopeCounts, Term, part};
use std::f64::consts::{FRAC_1_PI, TAU};

pub(crate) struct Gtr;

const GAMMA: usize = 0;

/// What f32 loses of values, in units of 2⁻²⁴: the 40 of every lobe, and of the exponent y = γ ln(1 + …) nine roundings:
/// four of its quotient, four of the logarithm, one of γ's product.
fn roundings(y: f64) -> f64 {
    (40.0 + 9.0 * y) / (1 << 24) as f64
}

/// All values share their peak, whose logarithm, quotients and mean of an exponential round ten times.
const PEAK_F32: f64 = 10.0 / (1 << 24) as f64;

impl Ndf for Gtr {
    const TERM: Term = Term {
        name: "gtr",
        summary: "generalised Trowbridge–Reitz microfacets, GGX's Λ",
        source: "Burley 2012, appendix B",
        part: part!("ndf/gtr", "elementary", "ndf/smith_of_ggx"),
    };
    const SHAPE: Shape = Shape::GTR;
    const PARAMETERS: &'static [Parameter] = &[Parameter {
        name: "gamma",
        summary: "how soon the tail ends: 1 Disney's clearcoat, 2 GGX",
        unit: "",
        range: [1.0, 10.0],
        default: Some(2.0),
        place: GAMMA,
    }];
    /// y ≤ 128 where f is above 1e-30 sr⁻¹.
    const F32: Rounding = Rounding {
        value: (40.0 + 9.0 * 128.0) / (1 << 24) as f64,
        value_at: Some(|s| {
            let most = -2.0 * s.parameters[GAMMA] * s.alpha.ln();
            roundings(most.min(128.0))
        }),
        integral: crate::base::precision::INTEGRAL_F32 + PEAK_F32,
        faint: None,
    };
    /// [`side`]/α of γ = 1 and α = 1/1000, where ωi grazes; the others' measured there, and of the clearcoat's at α = 1.
    const ALBEDO: AlbedoBounds = AlbedoBounds {
        bounds: &[
            ("smith-correlated", 144.63),
            ("smith-separable", 144.63),
            ("schlick-ggx", 144.63),
            ("smith-joint-approx", 144.63),
            ("disney-clearcoat", 3.438),
        ],
        bound_at,
        ..AlbedoBounds::CONSERVED
    };
    /// tan θm = α sinh v; beyond the cap, the lobe has 1e-12 of its weight, and of what G2 leaves of (ωe·ωm)/μe.
    const MAPS: Option<Maps> = Some(Maps {
        coarse: Coordinate { end: |t_max, s| end(t_max, 18.0, s), map },
        fine: Coordinate { end: |t_max, s| end(t_max, 30.0, s), map },
    });
    const RULE: Option<CountRule> = Some(CountRule {
        directions: Some(Directions {
            samples,
            most: |counts, of_normal| 2 * half_vector::most(&of_normal.unwrap_or(Kinks::NONE), counts),
        }),
        means: Some([mean, half_vector::mean]),
        ..CountRule::new(counts)
    });

    /// Below γ = 1.3, counts leave 4.6 times 1e-6 with Kelemen's.
    const RULE_HOLDS_TURNS: bool = false;

    fn ndf(h: &Half, hz2: f64, s: &Setting) -> f64 {
        let Setting { alpha, .. } = *s;
        let (a2, flat) = (alpha * alpha, (1.0 - alpha) * (1.0 + alpha));
        peak(s) * (-s.parameters[GAMMA] * (flat * h.ht2 / (a2 * (hz2 + h.ht2))).ln_1p()).exp()
    }

    fn smith_root(mu: f64, &Setting { alpha, .. }: &Setting) -> f64 {
        (alpha * alpha + (1.0 - alpha * alpha) * mu * mu).sqrt()
    }
}

fn map(v: f64, s: &Setting) -> MappedSlope {
    let (sinh, cosh) = (v.sinh(), v.cosh());
    let tan = s.alpha * sinh;
    let h2 = 1.0 + tan * tan;
    let half = Half { ht2: tan * tan, h2, c: 1.0, one_minus_c: 0.0 };
    // D cos θm dωm = 2π D t/(1 + t²)² dt dφ/2π
    let weight = TAU * Gtr::ndf(&half, 1.0, s) * tan / (h2 * h2) * s.alpha * cosh;
    MappedSlope { p: tan, m: 1.0, weight }
}

fn samples(
    fixed: &Fixed,
    s: &Setting,
    counts: [SlopeCounts; 2],
    tolerance: f64,
    of_normal: Option<Kinks>,
) -> Vec<Sample> {
    let tolerance = relative(tolerance, s);
    // G2 turns where μi ~ α, that is α/μ of v before the horizon: less than that matters from γ < 2 and 1e-6 on.
    let turn = (is_fine(tolerance) && of_normal.is_none()).then_some(HorizonTurn(s.alpha / fixed.mu));
    half_vector::samples_with::<Gtr>(fixed, s, counts, tolerance, of_normal, turn)
}

/// Measured for α from 1/1000 to 1 and γ from 1 to 10, worst over μ ∈ [2⁻²⁴, 1]: each count alone leaves less than a third
/// of the tolerance. Nodes in v fall by a decade of the error for each 5.5 of them; below γ = 2 all scales between
/// α and 1 matter, and it is up to 9.5 at α = 1/1000.
fn counts(_mu: f64, s: &Setting, tolerance: f64) -> [SlopeCounts; 2] {
    const AZIMUTHS: [usize; 10] = [4, 5, 6, 8, 12, 20, 22, 25, 29, 34];
    let tolerance = relative(tolerance, s);
    let tail = (2.0 * (2.0 - s.parameters[GAMMA])).clamp(0.0, 1.0) * s.alpha.ln() / ALPHA_LEAST.ln();
    let nodes = 8.0 - tolerance.log10() * (5.5 + 4.0 * tail);
    [SlopeCounts { azimuths: AZIMUTHS[decade(tolerance)], nodes: nodes.ceil() as usize }; 2]
}

fn bound_at(s: &Setting) -> f64 {
    (side(s) / s.alpha).max(1.0)
}

/// `max(.001, …)` in Disney's brdf explorer.
pub(crate) const ALPHA_LEAST: f64 = 1e-3;

/// The tolerance of ρ in units of the most it reaches, down to 1e-11.
fn relative(tolerance: f64, s: &Setting) -> f64 {
    (tolerance / bound_at(s)).clamp(1e-11, 0.1)
}

/// Nodes in ∛μ of the mean over directions, as ρ of γ = 1 turns where μ ~ α by more than GGX's: measured for α from 1/1000
/// to 1, each leaves less than a third of its tolerance.
fn mean(tolerance: f64) -> Vec<Node> {
    const NODES: [usize; 10] = [4, 5, 7, 10, 13, 18, 24, 30, 36, 42];
    let nodes = gauss_legendre(NODES[decade(tolerance)]);
    nodes.iter().map(|n| Node { x: n.x.powi(3), weight: 6.0 * n.x.powi(5) * n.weight }).collect()
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

/// What the facets cover as seen from the side: ∫ |ωm·x| D dωm = 4 ∫ sin²θm D dθm, where GGX has α. By the trapezoid in
/// ln tan θm, which converges beyond f64.
fn side(s: &Setting) -> f64 {
    const STEP: f64 = 0.25;
    let of = |k: i32| {
        let t = s.alpha * (f64::from(k) * STEP).exp();
        let t2 = t * t;
        // sin²θm dθm = t³/(1 + t²)² d ln t
        let half = Half { ht2: t2, h2: 1.0 + t2, c: 1.0, one_minus_c: 0.0 };
        t * t2 / (1.0 + t2).powi(2) * Gtr::ndf(&half, 1.0, s)
    };
    let last = ((40.0 - s.alpha.ln()) / STEP) as i32;
    4.0 * STEP * (-60..last).map(of).sum::<f64>()
}

/// v at which tan θm reaches `t_max`, or beyond which e^(−`digits`) is left of the weight: per unit of v, and with (ωe·ωm)/μe
/// for the worst ωe, it falls as (α/tan θm)^(2γ − 3) as far as tan θm = 1, and from there as 1/tan θm.
fn end(t_max: f64, digits: f64, s: &Setting) -> f64 {
    let (tail, log) = (2.0 * s.parameters[GAMMA] - 3.0, -s.alpha.ln());
    let most = if digits < tail * log { digits / tail } else { log + digits - tail * log };
    (t_max / s.alpha).asinh().min(most + 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::half_angle::MU_MIN;
    use crate::model;
    use crate::model::masking::Masking;
    use crate::model::masking::ashikhmin_neubelt::AshikhminNeubelt;
    use crate::model::masking::disney_clearcoat::DisneyClearcoat;
    use crate::model::masking::kelemen::Kelemen;
    use crate::model::masking::schlick_ggx::SchlickGgx;
    use crate::model::masking::schlick_ggx_direct::SchlickGgxDirect;
    use crate::model::masking::smith_correlated::SmithCorrelated;
    use crate::model::masking::smith_separable::SmithSeparable;
    use crate::model::masking::v_cavity::VCavity;
    use crate::model::truth;
    use crate::model::{Integral, Model};
    use rayon::prelude::*;

    fn setting(alpha: f64, gamma: f64) -> Setting {
        let mut s = Setting::from(alpha);
        s.parameters[GAMMA] = gamma;
        s
    }

    fn fixed(mu: f64) -> Fixed {
        Fixed { mu, phi: 0.0, factored: false, kinks: Vec::new() }
    }

    fn sum(model: &Model, samples: Vec<Sample>, s: &Setting) -> [f64; 2] {
        samples.into_iter().fold([0.0; 2], |sum, Sample { pair, azimuth, weight }| {
            let f = (model.lobe)(&pair, &azimuth, s);
            [sum[0] + weight * f[0], sum[1] + weight * f[1]]
        })
    }

    /// What a side covers is α of γ = 2, and in closed form of γ = 1.
    #[test]
    fn sides_meet_closed_forms() {
        for alpha in [1e-3, 0.03, 0.5, 0.999] {
            let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12 * b, "{a} is not {b} at α = {alpha}");
            near(side(&setting(alpha, 2.0)), alpha);
            near(side(&setting(alpha, 1.0)), (1.0 - alpha) / -alpha.ln());
        }
        assert!((side(&setting(1.0, 7.0)) - 1.0).abs() < 1e-12);
    }

    /// For each masking, over γ, α and μ. The truth takes more nodes; the reference agrees with it.
    #[test]
    fn the_counts_hold_for_every_masking() {
        type Samples = fn(&Fixed, &Setting, [SlopeCounts; 2], f64) -> Vec<Sample>;
        const PLENTY: [SlopeCounts; 2] = [SlopeCounts { azimuths: 45, nodes: 120 }; 2];
        let models: [(&str, Samples); 8] = [
            ("gtr", |f, s, c, t| samples(f, s, c, t, SmithCorrelated::OF_NORMAL)),
            ("gtr-smith-separable-schlick", |f, s, c, t| samples(f, s, c, t, SmithSeparable::OF_NORMAL)),
            ("gtr-schlick-ggx-schlick", |f, s, c, t| samples(f, s, c, t, SchlickGgx::OF_NORMAL)),
            ("gtr-schlick-ggx-direct-schlick", |f, s, c, t| samples(f, s, c, t, SchlickGgxDirect::OF_NORMAL)),
            ("gtr-ashikhmin-neubelt-schlick", |f, s, c, t| samples(f, s, c, t, AshikhminNeubelt::OF_NORMAL)),
            ("gtr-kelemen-schlick", |f, s, c, t| samples(f, s, c, t, Kelemen::OF_NORMAL)),
            ("gtr-disney-clearcoat-schlick", |f, s, c, t| samples(f, s, c, t, DisneyClearcoat::OF_NORMAL)),
            ("gtr-v-cavity-schlick", |f, s, c, t| samples(f, s, c, t, VCavity::OF_NORMAL)),
        ];
        let mut failed = Vec::new();
        for (name, plenty) in models {
            let model = model::find(name).unwrap();
            let Integral::Listed(map) = model.integral else { unreachable!() };
            let worst = (0..36).into_par_iter().map(|k| {
                // Additive recurrences of irrationals: even over all three.
                let [u, v, w] =
                    [0.754_877_666, 0.569_840_291, 0.438_447_187].map(|step| (f64::from(k) * step).fract());
                let mu = [2f64.powf(-24.0 * u * u), u.max(MU_MIN)][k as usize % 2];
                let s = setting(
                    ALPHA_LEAST.powf((1.2 * v).min(1.0)),
                    [1.0, 1.0 + w, 2.0 / (1.0 - 0.8 * w)][k as usize % 3],
                );
                let exact = sum(model, plenty(&fixed(mu), &s, PLENTY, 1e-10), &s);
                if k < 6 {
                    let truth = truth::rho_dh(model, mu, &s);
                    let error = (exact[0] - truth[0]).abs().max((exact[1] - truth[1]).abs());
                    assert!(error < 2e-9, "{name}, μ = {mu}, {s:?}: {error:e}");
                }
                let most = of_rho(model, &s);
                assert!(exact[0] + exact[1] <= most, "{name}, μ = {mu}, {s:?}: {exact:?} of {most}");
                std::array::from_fn(|d| {
                    let tolerance = 10f64.powi(-1 - d as i32);
                    let samples = (map.samples)(&fixed(mu), &s, tolerance);
                    assert!(samples.len() <= (map.most)(&s, tolerance), "{name}");
                    let rho = sum(model, samples, &s);
                    let error = (rho[0] - exact[0]).abs().max((rho[1] - exact[1]).abs()) / tolerance;
                    if error > 0.5 {
                        println!("{name}, μ = {mu}, {s:?} to {tolerance:e}: {error:.2}");
                    }
                    error
                })
            });
            let worst: [f64; 8] =
                worst.reduce(|| [0.0; 8], |a, b| std::array::from_fn(|d| f64::max(a[d], b[d])));
            println!("{name}: {}", worst.map(|share| format!("{share:.2}")).join(" "));
            if worst.iter().any(|&share| share > 0.7) {
                failed.push((name, worst));
            }
        }
        assert!(failed.is_empty(), "{failed:#?}");
    }

    /// The bound at a setting.
    fn of_rho(model: &Model, s: &Setting) -> f64 {
        ((model.microfacet.unwrap().rho_most)(s) * (1.0 + 1e-6)).min(model.rho_bound)
    }

    #[test]
    fn means_meet_the_tolerance() {
        for (name, rule) in
            [("gtr", mean as fn(f64) -> Vec<Node>), ("gtr-v-cavity-schlick", half_vector::mean)]
        {
            let model = model::find(name).unwrap();
            let Integral::Listed(map) = model.integral else { unreachable!() };
            let settings = [(1e-3, 1.0), (0.01, 1.0), (0.2, 1.0), (0.01, 10.0)];
            for &(alpha, gamma) in if crate::base::is_thorough() { &settings[..] } else { &settings[2..] } {
                let s = setting(alpha, gamma);
                let sum_of = |nodes: Vec<Node>, finer: f64| {
                    let at = |n: &Node| {
                        sum(model, (map.samples)(&fixed(n.x), &s, finer), &s).map(|rho| rho * n.weight)
                    };
                    nodes.par_iter().map(at).reduce(|| [0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]])
                };
                let exact = sum_of(rule(1e-10), 1e-9);
                for tolerance in [1e-1, 1e-2, 1e-4, 1e-6, 1e-8] {
                    let found = sum_of(rule(tolerance), 0.1 * tolerance);
                    let error = (found[0] - exact[0]).abs().max((found[1] - exact[1]).abs());
                    println!("{name} {alpha} {gamma} to {tolerance:e}: {error:.1e}");
                    assert!(error <= 0.7 * tolerance, "{name}, {alpha}, {gamma}: {error:e} of {tolerance:e}");
                }
            }
        }
    }
}
