//! Directions for the integrals of lobes about the half vector, by a map of the normals, on the host in f64: for
//! whatever has no kernel of its own. As `shaders/lobe/slopes.wgsl`: about the fixed direction, in the azimuth φ of ωm
//! and in r(tan θm), up to the horizon; but f may be anything, and panels end where it has a kink.

pub(crate) mod adaptive;
pub(crate) mod stretched;

use crate::base::half_angle::{Azimuth, Half, Pair};
use crate::base::quadrature::{Node, gauss_legendre};
use crate::base::tolerance::{decade, is_fine};
use crate::model::SlopeCounts;
use crate::model::directions::{Fixed, Sample};
use crate::model::masking::Masking;
use crate::model::ndf::{MappedSlope, Ndf};
use crate::model::parameters::Setting;
use crate::model::slope_azimuths::{Turn, turn_of, turn_scale, turns};
use std::f64::consts::FRAC_1_SQRT_2;

/// Where a lobe's normals are, and where it is not smooth: for c = tan θe cos φ, with φ the azimuth of ωm from that of
/// ωe.
pub(super) struct Normals<'a> {
    /// r at which tan θm reaches `t_max`.
    pub end: &'a dyn Fn(f64) -> f64,
    pub at: &'a dyn Fn(f64) -> Normal,
    pub kinks: Kinks,
    /// What turns before the horizon.
    pub turn: Option<HorizonTurn>,
}

/// How far in r before the horizon something turns: directions crowd there.
#[derive(Clone, Copy)]
pub(super) struct HorizonTurn(pub f64);

/// The normals at r: tan θm = p/m, and their solid angle over dr dφ/2π.
pub(super) struct Normal {
    pub p: f64,
    pub m: f64,
    pub solid_angle: f64,
}

/// Where a function of the normal is not smooth.
#[derive(Clone, Copy)]
pub(crate) struct Kinks {
    /// tan θm, ascending, at which it has a kink: panels end there.
    pub breaks: fn(c: f64) -> Vec<f64>,
    /// At most so many of them.
    pub most: usize,
    /// c at which kinks meet: panels of the azimuth end there.
    pub meet: Option<f64>,
    /// tan θm on whose scale it turns at θm = 0: directions crowd there.
    pub turn: fn(c: f64) -> Option<f64>,
    /// Whether it follows the horizon, which turns within μ of cos φ = 0, all the way.
    pub is_sharp: bool,
    /// The same for rules that go by the direction, not by the normal; what has `breaks` says it.
    pub of_directions: Option<DirectionKinks>,
}

/// Where a function of both directions is not smooth, beside where their cosines are equal.
#[derive(Clone, Copy)]
pub(crate) struct DirectionKinks {
    /// sin²(δφ/2) at which it has a kink: there is none unless that is between 0 and 1.
    pub sin2: fn(&Pair) -> f64,
    /// Elevations of ωe, rad, at which that begins or ends to be in between, for the elevation of ωi.
    pub elevations: fn(elevation: f64) -> [f64; 4],
}

impl Kinks {
    /// Of what is smooth.
    pub const NONE: Self = Self {
        breaks: |_| Vec::new(),
        most: 0,
        meet: None,
        turn: |_| None,
        is_sharp: false,
        of_directions: None,
    };

    /// Of what has the smaller of both cosines in it: they are the same at tan θm = c.
    pub const OF_EQUAL_COSINES: Self = Self { breaks: |c| vec![c], most: 1, is_sharp: true, ..Self::NONE };
}

/// cos θ of the directions whose ρ make the mean ∫ ρ 2μ dμ of a lobe with kinks, and their weights. ρ turns where μ ~ α,
/// and where θ ~ α too, as a kink lies on the peak there: √μ below, √(1 − μ) above μ = 1/√2, where v-cavity's ρ has a
/// seam. The nodes of each tolerance on each side leave a third of it at most, measured for v-cavity and for Ashikhmin and
/// Shirley's over α.
pub(super) fn mean(tolerance: f64) -> Vec<Node> {
    const NODES: [usize; 10] = [3, 4, 6, 8, 12, 16, 20, 26, 32, 40];
    mean_by([NODES[decade(tolerance)]; 2], 1)
}

/// The same by so many nodes below and above, √(1 − μ) in proportion to this power of the node's.
pub(super) fn mean_by([below, above]: [usize; 2], power: i32) -> Vec<Node> {
    let below = gauss_legendre(below);
    let below = below.iter().map(|n| [FRAC_1_SQRT_2 * n.x * n.x, FRAC_1_SQRT_2 * n.x * n.weight]);
    let above = gauss_legendre(above);
    let above = above.iter().map(|n| {
        let (width, x) = (1.0 - FRAC_1_SQRT_2, n.x.powi(power));
        [1.0 - width * x * x, width * x * f64::from(power) * n.x.powi(power - 1) * n.weight]
    });
    below.chain(above).map(|[mu, half]| Node { x: mu, weight: 4.0 * mu * half }).collect()
}

/// Directions of an NDF's normals.
pub(super) fn samples<N: Ndf, M: Masking>(
    fixed: &Fixed,
    s: &Setting,
    counts: [SlopeCounts; 2],
    tolerance: f64,
) -> Vec<Sample> {
    samples_with::<N>(fixed, s, counts, tolerance, M::OF_NORMAL, None)
}

/// The same where something turns before the horizon.
pub(super) fn samples_with<N: Ndf>(
    fixed: &Fixed,
    s: &Setting,
    counts: [SlopeCounts; 2],
    tolerance: f64,
    of_normal: Option<Kinks>,
    turn: Option<HorizonTurn>,
) -> Vec<Sample> {
    let Some(maps) = N::MAPS else { return Vec::new() };
    let coordinate = if is_fine(tolerance) { maps.fine } else { maps.coarse };
    let at = |r| normal::<N>((coordinate.map)(r, s), s);
    let end = |t| (coordinate.end)(t, s);
    let kinks = of_normal.unwrap_or(Kinks::NONE);
    directions(fixed, counts, tolerance, &Normals { end: &end, at: &at, kinks, turn })
}

/// D cos θm dωm = m weight dr dφ/2π
fn normal<N: Ndf>(MappedSlope { p, m, weight }: MappedSlope, s: &Setting) -> Normal {
    let h2 = m * m + p * p;
    let half = Half { ht2: p * p, h2, c: 1.0, one_minus_c: 0.0 };
    Normal { p, m, solid_angle: weight * h2.sqrt() / N::ndf(&half, m * m, s) }
}

/// Directions and what they weigh: cos θ dω of them.
pub(super) fn directions(
    fixed: &Fixed,
    counts: [SlopeCounts; 2],
    tolerance: f64,
    normals: &Normals,
) -> Vec<Sample> {
    let (mu, kinks) = (fixed.mu, &normals.kinks);
    let d = if kinks.is_sharp { mu.max(0.03 * tolerance.sqrt()) } else { turn_scale(mu, tolerance) };
    let mut samples = Vec::new();
    for (sign, counts) in [1.0, -1.0].into_iter().zip(counts) {
        let counts = fixed.counts(counts);
        let nodes = gauss_legendre(counts.nodes);
        let meet = kinks.meet.filter(|_| sign > 0.0).and_then(|c| turn_of(mu, c, d));
        for turn in turns(mu, sign, &panels(&gauss_legendre(counts.azimuths), meet), d) {
            along(&turn, fixed, &nodes, tolerance, normals, &mut samples);
        }
    }
    samples
}

/// The directions that the normals of an azimuth reflect the fixed one to.
fn along(
    turn: &Turn,
    fixed: &Fixed,
    nodes: &[Node],
    tolerance: f64,
    normals: &Normals,
    samples: &mut Vec<Sample>,
) {
    let azimuth: [f64; 2] = fixed.phi.sin_cos().into();
    for strip in strips(turn, fixed, tolerance, normals.end, &normals.kinks, normals.turn) {
        for node in nodes {
            let (r, dr) = strip.node(node);
            samples.extend(sample(turn, fixed, azimuth, &(normals.at)(r), dr));
        }
    }
}

/// An interval of r in which the integrand is smooth, as an analytic map of [0, 1].
enum Strip {
    /// r = start + width x
    Plain { start: f64, width: f64 },
    /// r = scale sinh(start + width x)
    Graded { start: f64, width: f64, scale: f64 },
    /// r = end − turn sinh(reach x)
    Horizon { end: f64, turn: f64, reach: f64 },
}

impl Strip {
    /// r and dr of a node.
    fn node(&self, node: &Node) -> (f64, f64) {
        match *self {
            Self::Plain { start, width } => {
                let x = start + width * node.x;
                (x, width * node.weight)
            }
            Self::Graded { start, width, scale } => {
                let x = start + width * node.x;
                (scale * x.sinh(), scale * x.cosh() * width * node.weight)
            }
            Self::Horizon { end, turn, reach } => {
                let x = reach * node.x;
                (end - turn * x.sinh(), turn * x.cosh() * reach * node.weight)
            }
        }
    }

    /// Its length in the coordinate in which the integrand varies on the scale 1.
    fn length(&self) -> f64 {
        match *self {
            Self::Plain { width, .. } | Self::Graded { width, .. } => width,
            Self::Horizon { reach, .. } => reach,
        }
    }
}

/// The strips of an azimuth, from the normal to the horizon: see [`Normals`].
fn strips(
    turn: &Turn,
    fixed: &Fixed,
    tolerance: f64,
    end_at: &dyn Fn(f64) -> f64,
    kinks: &Kinks,
    horizon: Option<HorizonTurn>,
) -> Vec<Strip> {
    let Turn { c, t_max, .. } = *turn;
    let mu = fixed.mu;
    // cos θe = μ (1 + 2ct − t²)/(1 + t²) is k where (μ + k) t² − 2μct + k − μ = 0.
    let roots = |&k: &f64| {
        let root = (mu * mu * c * c - (k - mu) * (k + mu)).max(0.0).sqrt();
        [-root, root].map(|root| (mu * c + root) / (mu + k))
    };
    let mut stops = (kinks.breaks)(c);
    stops.extend(fixed.kinks.iter().flat_map(roots));
    stops.retain(|&t| 0.0 < t && t < t_max);
    stops.push(t_max);
    stops.sort_by(f64::total_cmp);
    let ends: Vec<_> = [0.0].into_iter().chain(stops.into_iter().map(end_at)).collect();
    // r = scale sinh x, whose x is r at r ≪ scale, and its logarithm beyond: what turns on that scale is smooth in x. A
    // scale that holds less than the tolerance is not worth nodes.
    let least = 0.1 * tolerance.sqrt();
    let scale = (kinks.turn)(c).map(|t| end_at(t).max(least));
    let graded = |r: f64| scale.map_or(r, |scale| (r / scale).asinh());
    let mut strips = Vec::new();
    for (k, panel) in ends.windows(2).enumerate() {
        let is_last = k + 2 == ends.len();
        // The last of r before the horizon is a strip of its own, if something turns there.
        let turn = horizon.filter(|turn| is_last && turn.0 < 0.5 && panel[1] - panel[0] > 1.5);
        let end = if turn.is_some() { panel[1] - 1.0 } else { panel[1] };
        let (start, width) = (graded(panel[0]), graded(end) - graded(panel[0]));
        strips.push(match scale {
            None => Strip::Plain { start, width },
            Some(scale) => Strip::Graded { start, width, scale },
        });
        strips.extend(turn.map(|HorizonTurn(turn)| Strip::Horizon {
            end: panel[1],
            turn,
            reach: (1.0 / turn).asinh(),
        }));
    }
    strips
}

/// The direction that a normal of an azimuth reflects the fixed one to, and cos θ dω of it; none below the horizon.
///
/// `azimuth_i` is the sine and the cosine of φi.
fn sample(turn: &Turn, fixed: &Fixed, azimuth_i: [f64; 2], normal: &Normal, dr: f64) -> Option<Sample> {
    let Normal { p, m, solid_angle } = *normal;
    let solid_angle = solid_angle * dr * turn.weight;
    let (mu, sin) = (fixed.mu, fixed.sin());
    let Reflected { c: projected, mu_e, x_e, y_e, .. } = reflect(turn, [mu, sin], [p, m]);
    if !(mu_e > 0.0 && solid_angle.is_finite()) {
        return None;
    }
    // Neither square leaves f64 but where sin θe is 0 to all digits.
    let pair = Pair::of_cosines_and_sines([mu, mu_e], [sin, (x_e * x_e + y_e * y_e).sqrt()]);
    let azimuth = Azimuth::of_sines_and_cosines(azimuth_i, [-y_e, -x_e]);
    Some(Sample { pair, azimuth, weight: 4.0 * projected * mu_e * solid_angle })
}

/// The direction ωe = 2 (ωi·ωm) ωm − ωi that a normal reflects ωi to.
struct Reflected {
    /// ωi·ωm
    c: f64,
    mu_e: f64,
    /// Its tangential part along the azimuth of ωi, and across.
    x_e: f64,
    y_e: f64,
    /// √(m² + p²)
    root: f64,
}

/// The reflection at the normal tan θm = p/m of an azimuth, of ωi with these cosine and sine.
fn reflect(turn: &Turn, [mu, sin]: [f64; 2], [p, m]: [f64; 2]) -> Reflected {
    let y = m * m + p * p;
    let root = y.sqrt();
    let c = (sin * turn.cos * p + mu * m) / root;
    let (t, q) = (p / m, 2.0 * c * (p / root));
    let mu_e = m * m / y * mu * (turn.t_max - t) * (t + 1.0 / turn.t_max);
    Reflected { c, mu_e, x_e: q * turn.cos - sin, y_e: q * turn.sin, root }
}

/// A rule, or one on each side of a break.
fn panels(rule: &[Node], end: Option<f64>) -> Vec<Node> {
    let part = |start: f64, width: f64| {
        rule.iter().map(move |node| Node { x: start + width * node.x, weight: width * node.weight })
    };
    let end = end.unwrap_or(1.0);
    if end < 1.0 { part(0.0, end).chain(part(end, 1.0 - end)).collect() } else { rule.to_vec() }
}

/// At most so many.
pub(super) fn most(kinks: &Kinks, [near, far]: [SlopeCounts; 2]) -> usize {
    let sides = if kinks.meet.is_some() { [2, 1] } else { [1, 1] };
    (sides[0] * near.azimuths * near.nodes + sides[1] * far.azimuths * far.nodes) * (1 + kinks.most)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::half_angle::MU_MIN;
    use crate::model;
    use crate::model::ALPHA_MIN_VALUE;
    use crate::model::masking::kelemen::Kelemen;
    use crate::model::masking::smith_correlated::SmithCorrelated;
    use crate::model::masking::v_cavity::VCavity;
    use crate::model::ndf::beckmann::Beckmann;
    use crate::model::ndf::ggx::Ggx;
    use crate::model::truth;
    use rayon::prelude::*;

    fn fixed(mu: f64) -> Fixed {
        Fixed { mu, phi: 0.0, factored: false, kinks: Vec::new() }
    }

    /// By directions as by slopes: the reference has what both must be.
    #[test]
    fn directions_meet_the_tolerance_as_slopes_do() {
        let models = [
            (
                "ggx",
                samples::<Ggx, SmithCorrelated> as fn(&Fixed, &Setting, [SlopeCounts; 2], f64) -> Vec<Sample>,
            ),
            ("beckmann", samples::<Beckmann, SmithCorrelated>),
        ];
        for (name, samples) in models {
            let model = model::find(name).unwrap();
            let model::Integral::Slopes(slopes) = model.integral else { unreachable!() };
            for tolerance in [1e-2, 1e-4, 1e-6, 1e-8] {
                let mut worst = 0f64;
                for mu in [1.0, 0.9, 0.5, 0.1, 1e-2, 1e-3, 1e-5, MU_MIN] {
                    for alpha in [1.0, 0.3, 0.1, 1e-2, 1e-3, 1e-5, ALPHA_MIN_VALUE] {
                        let s = alpha.into();
                        let counts = (slopes.counts)(mu, &s, tolerance);
                        let mut sum = [0.0; 2];
                        for Sample { pair, azimuth, weight } in samples(&fixed(mu), &s, counts, tolerance) {
                            let f = (model.lobe)(&pair, &azimuth, &s);
                            sum = [sum[0] + weight * f[0], sum[1] + weight * f[1]];
                        }
                        let truth = truth::rho_dh(model, mu, &s);
                        let error = (sum[0] - truth[0]).abs().max((sum[1] - truth[1]).abs());
                        worst = worst.max(error);
                    }
                }
                println!("{name} to {tolerance}: {worst:.1e}");
                assert!(worst <= tolerance, "{name}: {worst} of {tolerance}");
            }
        }
    }

    /// For maskings of the normal the counts of correlated Smith do not suffice: what is added to them does, for each
    /// NDF, all α and all μ. The truth takes four times the nodes; the reference agrees with it.
    #[test]
    fn the_error_model_holds_for_maskings_of_the_normal() {
        type Samples = fn(&Fixed, &Setting, [SlopeCounts; 2], f64) -> Vec<Sample>;
        let models: [(&str, Samples); 4] = [
            ("ggx-kelemen-schlick", samples::<Ggx, Kelemen>),
            ("beckmann-kelemen-schlick", samples::<Beckmann, Kelemen>),
            ("ggx-v-cavity-schlick", samples::<Ggx, VCavity>),
            ("beckmann-v-cavity-schlick", samples::<Beckmann, VCavity>),
        ];
        for (name, plenty) in models {
            let model = model::find(name).unwrap();
            let model::Integral::Listed(map) = model.integral else { unreachable!() };
            let sum = |samples: Vec<Sample>, s: &Setting| {
                samples.into_iter().fold([0.0; 2], |sum, Sample { pair, azimuth, weight }| {
                    let f = (model.lobe)(&pair, &azimuth, s);
                    [sum[0] + weight * f[0], sum[1] + weight * f[1]]
                })
            };
            let worst = (0..100).into_par_iter().map(|k| {
                // Additive recurrences of two irrationals: even over both logarithms.
                let (u, v) = ((k as f64 * 0.754_877_666).fract(), (k as f64 * 0.569_840_291).fract());
                let (mu, alpha) = (2f64.powf(-24.0 * u * u), 2f64.powf(-20.0 * v * v));
                let s = alpha.into();
                let exact =
                    sum(plenty(&fixed(mu), &s, [SlopeCounts { azimuths: 120, nodes: 160 }; 2], 1e-10), &s);
                if k < 8 {
                    let truth = truth::rho_dh(model, mu, &s);
                    let error = (exact[0] - truth[0]).abs().max((exact[1] - truth[1]).abs());
                    assert!(error < 5e-9, "{name}, μ = {mu}, α = {alpha}: {error:e}");
                }
                std::array::from_fn(|d| {
                    let tolerance = 10f64.powi(-1 - d as i32);
                    let samples = (map.samples)(&fixed(mu), &s, tolerance);
                    assert!(samples.len() <= (map.most)(&s, tolerance), "{name}");
                    let rho = sum(samples, &s);
                    (rho[0] - exact[0]).abs().max((rho[1] - exact[1]).abs()) / tolerance
                })
            });
            let worst: [f64; 9] =
                worst.reduce(|| [0.0; 9], |a, b| std::array::from_fn(|d| f64::max(a[d], b[d])));
            println!("{name}: {}", worst.map(|share| format!("{share:.2}")).join(" "));
            assert!(worst.iter().all(|&share| share <= 1.0), "{name}: {worst:?} of the tolerance");
        }
    }
}
