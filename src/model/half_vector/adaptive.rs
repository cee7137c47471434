//! Directions of a lobe whose node counts are unknown: adaptive quadrature over its normals, in f64 on the host.
//!
//! The charts are those of rules with counts: about the fixed direction, the azimuth φ of ωm, as a sinh crowds it where the
//! horizon turns, and a coordinate r of tan θm up to the horizon, in strips that end at known kinks. An NDF without a
//! coordinate gets tan θm = t₀ sinh r, with t₀ its median slope: per unit of r a peak and its tail both change by a
//! bounded factor. Rectangles of (φ, r) are bisected until the sum of their errors is below the tolerance
//! ([`cubature`](crate::base::cubature)), so that kinks, steep Λ at the horizon and peaks that nobody foretold are found.
//!
//! Accuracy: errors are those of the 7-point rules, and a quarter of the tolerance is theirs; what is kept is the 15-point
//! rule. A lobe that does not converge within [`most`] evaluations gets NaN, which no table is written with.

use crate::base::cubature::{CubatureCell, EVALUATIONS, Measured, kronrod, refine};
use crate::base::half_angle::{Azimuth, Half, Pair};
use crate::base::quadrature::{Node, gauss_legendre};
use crate::base::tolerance::{decade, is_fine};
use crate::model::directions::{Fixed, Sample};
use crate::model::half_vector::stretched::panels;
use crate::model::half_vector::{Kinks, Normal, Strip, normal, sample, strips};
use crate::model::ndf::Ndf;
use crate::model::parameters::Setting;
use crate::model::slope_azimuths::{Turn, turn_of, turns};
use std::f64::consts::TAU;

/// Evaluations that no result takes more of: what the strictest driver runs in one loop, where f32 does it.
pub(crate) fn most(tolerance: f64) -> usize {
    if is_fine(tolerance) { 1_000_000 } else { 59_000 }
}

/// Directions whose weighted values add up to ρ, cos θ dω of them.
pub(crate) fn samples<N: Ndf>(
    fixed: &Fixed,
    s: &Setting,
    tolerance: f64,
    kinks: &Kinks,
    lobe: &dyn Fn(&Pair, &Azimuth) -> [f64; 2],
) -> Vec<Sample> {
    let median = if N::MAPS.is_some() { 0.0 } else { median_slope::<N>(s) };
    let axes = N::AXES.map(|axes| axes(s));
    let azimuths = azimuths(fixed, axes, tolerance);
    let at = |azimuth: &Azimuths, u: f64, weight: f64| {
        let (turn, alpha) = azimuth.turn(&Node { x: u, weight }, fixed, axes);
        let s = alpha.map_or(*s, |alpha| Setting { alpha, ..*s });
        (turn, s)
    };
    // The strips of an azimuth, by the NDF's own map if it has one.
    let strips = |turn: &Turn, s: &Setting| {
        let end = |t: f64| N::MAPS.map_or((t / median).asinh(), |maps| (maps.fine.end)(t, s));
        strips(turn, fixed, tolerance, &end, kinks, None)
    };
    let start: Vec<Chart> = azimuths
        .iter()
        .flat_map(|azimuth| {
            // Known kinks meet at one azimuth, where charts end.
            let meet = kinks.meet.and_then(|c| azimuth.meet(fixed.mu, c));
            let ends: Vec<f64> = [0.0].into_iter().chain(meet).chain([1.0]).collect();
            ends.windows(2)
                .flat_map(|ends| {
                    let middle = 0.5 * (ends[0] + ends[1]);
                    let lengths = [ends[0], middle, ends[1]].map(|u| {
                        let (turn, s) = at(azimuth, u, 1.0);
                        strips(&turn, &s).iter().map(Strip::length).collect::<Vec<_>>()
                    });
                    let count = lengths.iter().map(Vec::len).max().unwrap_or(0);
                    let chart = |strip: usize| {
                        let length =
                            lengths.iter().filter_map(|all| all.get(strip)).copied().fold(0.0, f64::max);
                        Chart { azimuth, strip, u: [ends[0], ends[1]], length }
                    };
                    (0..count).map(chart).collect::<Vec<_>>()
                })
                .collect::<Vec<_>>()
        })
        .collect();
    let rectangles = start.iter().enumerate().flat_map(|(k, chart)| chart.rectangles(k)).collect();
    let azimuth_i: [f64; 2] = fixed.phi.sin_cos().into();
    // Factors that the lobe is multiplied with turn where μ ~ α, too.
    let turns_at = s.alpha.max(tolerance);
    let cells = refine(rectangles, 0.25 * tolerance, most(tolerance), |rectangle| {
        let chart = &start[rectangle.chart];
        let mut found = Vec::with_capacity(EVALUATIONS);
        // K ⊗ K, G ⊗ K and K ⊗ G of A, B, and of what a factor makes of them.
        let mut sums = [[0.0; 3]; 3];
        let along = kronrod(rectangle.x);
        for across in kronrod(rectangle.u) {
            let (turn, s) = at(chart.azimuth, across.node.x, across.node.weight);
            let Some(strip) = strips(&turn, &s).into_iter().nth(chart.strip) else { continue };
            for node in &along {
                let (r, dr) = strip.node(&node.node);
                let normal = normal_at::<N>(r, &s, median);
                let Some(sample) = sample(&turn, fixed, azimuth_i, &normal, dr) else { continue };
                let [a, b] = lobe(&sample.pair, &sample.azimuth).map(|f| f * sample.weight);
                let factor =
                    if fixed.factored { sample.pair.mu_e / (sample.pair.mu_e + turns_at) } else { 0.0 };
                let shares =
                    [1.0, across.gauss_weight / across.node.weight, node.gauss_weight / node.node.weight];
                for (sum, share) in sums.iter_mut().zip(shares) {
                    for (sum, value) in sum.iter_mut().zip([a, b, factor * (a + b)]) {
                        *sum += share * value;
                    }
                }
                found.push((sample, a.abs() + b.abs()));
            }
        }
        let error = |rule: usize| (0..3).map(|k| (sums[0][k] - sums[rule][k]).abs()).fold(0.0, f64::max);
        Measured { samples: found, sums: sums[0], errors: [error(1), error(2)] }
    });
    let Some(cells) = cells else { return vec![not_converged(fixed)] };
    // What adds nothing need not be evaluated again: all of it together is a hundredth of the tolerance.
    let count: usize = cells.iter().map(Vec::len).sum();
    let least = 0.01 * tolerance / count.max(1) as f64;
    cells.into_iter().flatten().filter(|(_, value)| *value > least).map(|(sample, _)| sample).collect()
}

/// A number that no table is written with.
fn not_converged(fixed: &Fixed) -> Sample {
    Sample { weight: f64::NAN, ..Sample::new(fixed.mu.acos(), 0.0, 0.0, 1.0) }
}

/// Azimuths of the normal as functions of u in [0, 1].
enum Azimuths {
    /// φ = π/2 ∓ d sinh u.
    Isotropic {
        sign: f64,
        d: f64,
    },
    Stretched(super::stretched::Panel),
}

fn azimuths(fixed: &Fixed, axes: Option<[f64; 2]>, tolerance: f64) -> Vec<Azimuths> {
    match axes {
        None => {
            let d = fixed.mu.max(0.03 * tolerance.sqrt());
            [1.0, -1.0].into_iter().map(|sign| Azimuths::Isotropic { sign, d }).collect()
        }
        Some(axes) => panels(fixed, axes).into_iter().map(Azimuths::Stretched).collect(),
    }
}

impl Azimuths {
    /// The azimuth at a node of u, and α along it, where that differs.
    fn turn(&self, node: &Node, fixed: &Fixed, axes: Option<[f64; 2]>) -> (Turn, Option<f64>) {
        match self {
            Self::Isotropic { sign, d } => {
                let turn = turns(fixed.mu, *sign, std::slice::from_ref(node), *d).next();
                (turn.unwrap_or(Turn::new(0.0, [1.0, 0.0], f64::NAN)), None)
            }
            Self::Stretched(panel) => {
                let (turn, alpha) = panel.turn(node, fixed, axes.unwrap_or([1.0; 2]));
                (turn, Some(alpha))
            }
        }
    }

    /// The length of u in the coordinate in which the horizon turns on the scale 1.
    fn length(&self) -> f64 {
        match self {
            Self::Isotropic { d, .. } => (std::f64::consts::FRAC_PI_2 / d).asinh(),
            Self::Stretched(panel) => panel.reach,
        }
    }

    /// u at which tan θe cos φ is c, if that is known.
    fn meet(&self, mu: f64, c: f64) -> Option<f64> {
        match self {
            Self::Isotropic { sign, d } if *sign > 0.0 => turn_of(mu, c, *d).filter(|u| 0.0 < *u && *u < 1.0),
            _ => None,
        }
    }
}

/// A strip of azimuths from `u[0]` to `u[1]`.
struct Chart<'a> {
    azimuth: &'a Azimuths,
    strip: usize,
    u: [f64; 2],
    length: f64,
}

impl Chart<'_> {
    /// The rectangles to begin with: no longer than [`LONGEST`], so that none looks converged by luck.
    fn rectangles(&self, chart: usize) -> Vec<CubatureCell> {
        let cuts = |[low, high]: [f64; 2], length: f64| {
            let n = (length / LONGEST).ceil().max(1.0) as usize;
            let at = move |k: usize| low + (high - low) * k as f64 / n as f64;
            (0..n).map(|k| [at(k), at(k + 1)]).collect::<Vec<_>>()
        };
        let along = cuts([0.0, 1.0], self.length);
        let across = cuts(self.u, self.azimuth.length() * (self.u[1] - self.u[0]));
        across.iter().flat_map(|&u| along.iter().map(move |&x| CubatureCell { chart, u, x })).collect()
    }
}

/// In u and in r, lobes vary on the scale 1.
const LONGEST: f64 = 4.0;

/// The normals at r: by the NDF's own map, or by tan θm = t₀ sinh r.
fn normal_at<N: Ndf>(r: f64, s: &Setting, median: f64) -> Normal {
    if let Some(maps) = N::MAPS {
        return normal::<N>((maps.fine.map)(r, s), s);
    }
    let p = median * r.sinh();
    // dωm = 2π t/(1 + t²)^(3/2) dt dφ/2π
    let h2 = 1.0 + p * p;
    Normal { p, m: 1.0, solid_angle: TAU * p / (h2 * h2.sqrt()) * median * r.cosh() }
}

/// The slope tan θm below which half of D cos θm dωm is: by the trapezoid in its logarithm.
fn median_slope<N: Ndf>(s: &Setting) -> f64 {
    const STEP: f64 = 0.125;
    let slope = |k: i32| (f64::from(k) * STEP).exp();
    let density = |t: f64| {
        let t2 = t * t;
        let half = Half { ht2: t2, h2: 1.0 + t2, c: 1.0, one_minus_c: 0.0 };
        // D cos θm sin θm dθm = D t²/(1 + t²)² d ln t
        N::ndf(&half, 1.0, s) * (t / (1.0 + t2)).powi(2)
    };
    // tan θm from 1e-13 to 1e13
    let all: Vec<(f64, f64)> = (-240..=240).map(slope).map(|t| (t, density(t))).collect();
    let half = 0.5 * all.iter().map(|(_, density)| density).sum::<f64>();
    let mut sum = 0.0;
    let reached = all.iter().find(|(_, density)| {
        sum += density;
        sum >= half
    });
    reached.map_or(1.0, |(t, _)| *t)
}

/// cos θ of the directions whose ρ make the mean ∫ ρ 2μ dμ of any lobe, and their weights. ρ may turn at any μ, and where
/// 1 − μ is small: panels are four times as long as the one before, from both ends, down to where less than a tenth of the
/// tolerance is left, μ² at grazing and 1 − μ at the normal.
pub(crate) fn mean(tolerance: f64) -> Vec<Node> {
    const RATIO: f64 = 4.0;
    let count = if is_fine(tolerance) {
        10
    } else if decade(tolerance) > decade(1e-3) {
        8
    } else {
        5
    };
    let rule = gauss_legendre(count);
    let graded = |least: f64| {
        let mut ends = vec![0.5];
        while ends[ends.len() - 1] > least {
            ends.push(ends[ends.len() - 1] / RATIO);
        }
        ends.push(0.0);
        ends
    };
    let panel = |ends: &[f64]| {
        let (start, width) = (ends[1], ends[0] - ends[1]);
        rule.iter().map(move |node| [start + width * node.x, width * node.weight]).collect::<Vec<_>>()
    };
    let below: Vec<_> = graded((0.1 * tolerance).sqrt()).windows(2).flat_map(panel).collect();
    let above: Vec<_> = graded(0.1 * tolerance).windows(2).flat_map(panel).collect();
    let above = above.into_iter().map(|[rest, weight]| [1.0 - rest, weight]);
    below.into_iter().chain(above).map(|[mu, weight]| Node { x: mu, weight: 2.0 * mu * weight }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::half_angle::MU_MIN;
    use crate::model::masking::Masking;
    use crate::model::masking::Toward;
    use crate::model::masking::smith_correlated::SmithCorrelated;
    use crate::model::masking::v_cavity::VCavity;
    use crate::model::ndf::charlie::Charlie;
    use crate::model::ndf::ggx::Ggx;
    use crate::model::truth;
    use crate::model::{self, Term, part};
    use rayon::prelude::*;

    /// GGX and Charlie as a newcomer gives them: by D and Λ alone.
    struct Bare<N>(std::marker::PhantomData<N>);

    impl<N: Ndf> Ndf for Bare<N> {
        const TERM: Term = Term { name: "bare", summary: "", source: "", part: part!("ndf/ggx") };

        fn ndf(h: &Half, hz2: f64, s: &Setting) -> f64 {
            N::ndf(h, hz2, s)
        }

        fn smith_root(mu: f64, s: &Setting) -> f64 {
            N::smith_root(mu, s)
        }
    }

    fn rho<N: Ndf, M: Masking>(fixed: &Fixed, s: &Setting, tolerance: f64) -> ([f64; 2], usize) {
        let lobe = |p: &Pair, a: &Azimuth| {
            let h = Half::new(p, a);
            let toward = |mu: f64| Toward { mu, setting: *s };
            let f = N::ndf(&h, p.hz2, s)
                * M::of_normal(M::visibility::<N>(&toward(p.mu_i), &toward(p.mu_e)), p, &h);
            let fc = h.one_minus_c.powi(5);
            [f * (1.0 - fc), f * fc]
        };
        let found = samples::<N>(fixed, s, tolerance, &M::OF_NORMAL.unwrap_or(Kinks::NONE), &lobe);
        let sum = found.iter().fold([0.0; 2], |sum, Sample { pair, azimuth, weight }| {
            let f = lobe(pair, azimuth);
            [sum[0] + weight * f[0], sum[1] + weight * f[1]]
        });
        (sum, found.len())
    }

    /// With no counts and no map, every tolerance is met, at every μ and α, with smooth masking and with one that has kinks.
    #[test]
    fn a_distribution_of_d_and_lambda_alone_meets_every_tolerance() {
        type RhoOfNode = fn(&Fixed, &Setting, f64) -> ([f64; 2], usize);
        let cases: [(&str, RhoOfNode); 4] = [
            ("ggx", rho::<Bare<Ggx>, SmithCorrelated>),
            ("ggx-v-cavity-schlick", rho::<Bare<Ggx>, VCavity>),
            ("charlie", rho::<Bare<Charlie>, SmithCorrelated>),
            ("charlie-v-cavity-schlick", rho::<Bare<Charlie>, VCavity>),
        ];
        for (name, rho) in cases {
            let model = model::find(name).unwrap();
            let mut places = Vec::new();
            for mu in [1.0, 0.7, 0.3, 0.03, 1e-3, 1e-5, MU_MIN] {
                places.extend([1.0, 0.3, 0.05, 1e-3, 1e-6].map(|alpha| (mu, alpha)));
            }
            for tolerance in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7] {
                let worst = places.par_iter().map(|&(mu, alpha)| {
                    let s = alpha.into();
                    let fixed = Fixed { mu, phi: 0.0, factored: false, kinks: Vec::new() };
                    let (found, count) = rho(&fixed, &s, tolerance);
                    let truth = truth::rho_dh(model, mu, &s);
                    let error = (found[0] - truth[0]).abs().max((found[1] - truth[1]).abs());
                    if error.is_nan() || error > tolerance {
                        println!(
                            "{name}, μ = {mu}, α = {alpha} to {tolerance:e}: off by {error:e} of {truth:?}"
                        );
                    }
                    (if error.is_nan() { f64::INFINITY } else { error }, count)
                });
                let (error, count) = worst.reduce(|| (0.0, 0), |a, b| (f64::max(a.0, b.0), a.1.max(b.1)));
                println!("{name} to {tolerance:e}: {error:.1e}, at most {count} directions");
                assert!(error <= tolerance, "{name} to {tolerance:e}: {error:e}");
            }
        }
    }

    /// The weights of the mean add up to 1, and powers of μ and of 1 − μ that are not whole are met.
    #[test]
    fn means_meet_the_tolerance() {
        for tolerance in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8] {
            let sum = |f: &dyn Fn(f64) -> f64| mean(tolerance).iter().map(|n| n.weight * f(n.x)).sum::<f64>();
            assert!((sum(&|_| 1.0) - 1.0).abs() < 1e-14);
            assert!((sum(&|mu| mu.powf(0.2)) - 2.0 / 2.2).abs() <= 0.5 * tolerance);
            // 2 ∫ (1 − μ)^½ μ dμ = 2 B(2, 3/2)
            assert!((sum(&|mu| (1.0 - mu).sqrt()) - 8.0 / 15.0).abs() <= 0.5 * tolerance);
            for alpha in [0.3_f64, 0.01, 1e-4] {
                let exact = 1.0 - 2.0 * alpha + 2.0 * alpha * alpha * (1.0 / alpha).ln_1p();
                let found = sum(&|mu| mu / (mu + alpha));
                assert!(
                    (found - exact).abs() <= 0.5 * tolerance,
                    "{alpha} to {tolerance}: {found} of {exact}"
                );
            }
        }
    }
}
