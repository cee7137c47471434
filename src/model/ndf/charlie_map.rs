//! Directions for the integrals of Charlie. It has no peak that a map of its normals would flatten; but f is not
//! analytic at
//! - the horizon, where L has μ^c, and 0° where it has (1 − μ)^c; 60°, where Λ's two branches meet;
//! - the mirror direction, where sin^(1/α) θm comes to a point, the sharpest, a cone, at α = 1;
//! - the kinks of the masking, if it has any, and of factors.
//!
//! So panels in the elevation ψ = π/2 − θe end at all of these, each by the double exponential rule (Takahasi & Mori
//! 1974), which no algebraic singularity at an end slows down; and for each ψ the azimuth is δφ = d sinh u with d the
//! distance 2 dt/√ss at which sin θm turns, so that the point's neighbourhood is seen at every scale.

use crate::base::half_angle::{Azimuth, Pair};
use crate::base::quadrature::{Node, gauss_legendre};
use crate::base::tolerance::decade;
use crate::model::SlopeCounts;
use crate::model::directions::Sample;
use crate::model::half_vector::Kinks;
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, FRAC_PI_6, PI};

/// Where Λ's branches meet.
const SEAM: f64 = FRAC_PI_6;

/// Directions and what they weigh: cos θ dω of them.
pub(super) fn samples(
    mu: f64,
    of_factors: &[f64],
    counts: SlopeCounts,
    tolerance: f64,
    of_normal: Option<Kinks>,
) -> Vec<Sample> {
    let kinks = of_normal.and_then(|kinks| kinks.of_directions);
    let sin = ((1.0 - mu) * (1.0 + mu)).sqrt();
    let own = mu.atan2(sin);
    let (rule, turns) =
        (ends(nodes(counts, of_normal), tolerance), gauss_legendre(azimuths(counts, of_normal)));
    let mut breaks = vec![0.0, SEAM, own, FRAC_PI_2];
    let of_masking = kinks.into_iter().flat_map(|kinks| (kinks.elevations)(own));
    let of_factors = of_factors.iter().map(|cosine| cosine.asin());
    breaks.extend(of_masking.chain(of_factors).filter(|&psi| 0.0 < psi && psi < FRAC_PI_2));
    breaks.sort_by(f64::total_cmp);
    let least = tolerance.max(1e-9).cbrt();
    let mut samples = Vec::new();
    for panel in breaks.windows(2) {
        let (start, width) = (panel[0], panel[1] - panel[0]);
        for &End { x, rest, weight } in rule.iter().filter(|_| width > 0.0) {
            let psi = start + width * x;
            let mu_e = psi.sin();
            let sin_e = if panel[1] == FRAC_PI_2 { (width * rest).sin() } else { psi.cos() };
            // From ωi's, by the end of the panel that it is.
            let above = match panel {
                [start, _] if *start == own => width * x,
                [_, end] if *end == own => -width * rest,
                _ => psi - own,
            };
            let (ss, hz) = (sin * sin_e, 0.5 * (mu + mu_e));
            let (sin_half, cos_half) = (0.5 * above).sin_cos();
            let dt = hz / cos_half * sin_half;
            let pair = Pair {
                hz2: hz * hz,
                dt2: dt * dt,
                ss,
                sd: sin_half * sin_half,
                mu_i: mu,
                mu_e,
                bin: 0.0,
                weight: 1.0,
                st: 0.5 * (sin + sin_e),
                dt: 0.5 * (sin - sin_e),
            };
            let root = ss.sqrt().max(1e-30);
            let d = (2.0 * dt.abs() / root).max(least * (2.0 * hz / root).min(1.0)).min(10.0);
            let u = |delta: f64| (delta / d).asinh();
            let kink = kinks.map(|kinks| (kinks.sin2)(&pair)).filter(|sin2| 0.0 < *sin2 && *sin2 < 1.0);
            let stops = [0.0].into_iter().chain(kink.map(|sin2| u(2.0 * sin2.sqrt().asin()))).chain([u(PI)]);
            for (from, to) in stops.clone().zip(stops.skip(1)) {
                for turn in &turns {
                    let u = from + (to - from) * turn.x;
                    // Both halves of the azimuth.
                    let azimuth = 2.0 * turn.weight * (to - from) * d * u.cosh();
                    samples.push(Sample {
                        pair,
                        azimuth: Azimuth::new(d * u.sinh()),
                        weight: weight * width * mu_e * sin_e * azimuth,
                    });
                }
            }
        }
    }
    samples
}

/// At most so many.
pub(super) fn most(counts: SlopeCounts, of_normal: Option<Kinks>) -> usize {
    let panels = if has_kinks(of_normal) { (3 + 4) * 2 } else { 3 };
    panels * nodes(counts, of_normal) * azimuths(counts, of_normal)
}

fn has_kinks(of_normal: Option<Kinks>) -> bool {
    of_normal.is_some_and(|kinks| kinks.of_directions.is_some())
}

/// Where kinks make more panels, each takes an eighth less: measured as the counts are.
fn nodes(counts: SlopeCounts, of_normal: Option<Kinks>) -> usize {
    counts.nodes - if has_kinks(of_normal) { counts.nodes / 8 } else { 0 }
}

/// What maskings of the normal divide by, |h|², takes half as many again: measured as the counts are.
fn azimuths(counts: SlopeCounts, of_normal: Option<Kinks>) -> usize {
    counts.azimuths + if of_normal.is_some() { counts.azimuths.div_ceil(2) } else { 0 }
}

/// cos θ of the directions whose ρ make the mean ∫ ρ 2μ dμ, and their weights: ρ has the same seam and ends. The nodes of each
/// tolerance leave less than a third of it.
pub(super) fn mean(tolerance: f64) -> Vec<Node> {
    mean_of(MEAN_NODES[decade(tolerance)], tolerance, &[0.0, 0.5, 1.0])
}

/// The same with v-cavity, whose kinks all meet at ψ = π/4, and 3ψ leaves the hemisphere at Λ's seam. Measured as above, but
/// at α = 1/200, where it is six tenths of 1e-4 and nine of 1e-7.
pub(super) fn mean_with_kinks(tolerance: f64) -> Vec<Node> {
    mean_of(MEAN_NODES[decade(tolerance)], tolerance, &[0.0, 0.5, FRAC_1_SQRT_2, 1.0])
}

const MEAN_NODES: [usize; 10] = [4, 6, 8, 12, 16, 20, 24, 28, 32, 36];

/// By so many nodes in each panel.
fn mean_of(count: usize, tolerance: f64, ends_at: &[f64]) -> Vec<Node> {
    let rule = ends(count, tolerance);
    let node = |panel: &[f64], end: &End| {
        let mu = panel[0] + (panel[1] - panel[0]) * end.x;
        Node { x: mu, weight: 2.0 * (panel[1] - panel[0]) * end.weight * mu }
    };
    ends_at.windows(2).flat_map(|panel| rule.iter().map(move |end| node(panel, end))).collect()
}

/// Counts for tolerances 1e-1 … 1e-10: the error of each count alone, the worst over α ∈ [1/200, 1] and μ ∈ [2⁻²⁴, 1], is
/// below the tolerance, and but for α = 1/200 where ωi grazes below half of it.
pub(super) fn counts(tolerance: f64) -> [SlopeCounts; 2] {
    const COUNTS: [[usize; 2]; 10] =
        [[5, 7], [7, 12], [12, 17], [20, 21], [26, 27], [32, 32], [39, 37], [47, 42], [56, 48], [60, 50]];
    let [azimuths, nodes] = COUNTS[decade(tolerance)];
    [SlopeCounts { azimuths, nodes }; 2]
}

/// A node in [0, 1], and how far it is from 1.
struct End {
    x: f64,
    rest: f64,
    weight: f64,
}

/// The double exponential rule of `n` nodes on [0, 1], cut where what is left of it is a thousandth of the tolerance.
fn ends(n: usize, tolerance: f64) -> Vec<End> {
    let reach = ((1000.0 / tolerance).ln() / PI).asinh();
    let step = 2.0 * reach / n as f64;
    (0..n)
        .map(|k| {
            let t = -reach + (k as f64 + 0.5) * step;
            let s = PI * t.sinh();
            let [x, rest] = [-s, s].map(|s| 1.0 / (1.0 + s.exp()));
            End { x, rest, weight: step * PI * t.cosh() * x * rest }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model;
    use crate::model::directions::Fixed;
    use crate::model::masking::Masking;
    use crate::model::masking::ashikhmin_neubelt::AshikhminNeubelt;
    use crate::model::masking::disney_clearcoat::DisneyClearcoat;
    use crate::model::masking::kelemen::Kelemen;
    use crate::model::masking::schlick_ggx_direct::SchlickGgxDirect;
    use crate::model::masking::smith_correlated::SmithCorrelated;
    use crate::model::masking::smith_separable::SmithSeparable;
    use crate::model::masking::v_cavity::VCavity;
    use crate::model::ndf::charlie::ALPHA_LEAST;
    use crate::model::parameters::Setting;
    use crate::model::truth;
    use crate::model::{Integral, Model};
    use rayon::prelude::*;

    fn sum(model: &Model, samples: Vec<Sample>, s: &Setting) -> [f64; 2] {
        samples.into_iter().fold([0.0; 2], |sum, Sample { pair, azimuth, weight }| {
            let f = (model.lobe)(&pair, &azimuth, s);
            [sum[0] + weight * f[0], sum[1] + weight * f[1]]
        })
    }

    /// The truth takes more nodes; the reference agrees with it.
    #[test]
    fn the_counts_hold_for_every_masking() {
        let models: [(&str, Option<Kinks>); 7] = [
            ("charlie", SmithCorrelated::OF_NORMAL),
            ("charlie-smith-separable-schlick", SmithSeparable::OF_NORMAL),
            ("charlie-schlick-ggx-direct-schlick", SchlickGgxDirect::OF_NORMAL),
            ("charlie-ashikhmin-neubelt-schlick", AshikhminNeubelt::OF_NORMAL),
            ("charlie-disney-clearcoat-schlick", DisneyClearcoat::OF_NORMAL),
            ("charlie-kelemen-schlick", Kelemen::OF_NORMAL),
            ("charlie-v-cavity-schlick", VCavity::OF_NORMAL),
        ];
        let mut failed = Vec::new();
        for (name, of_normal) in models {
            let model = model::find(name).unwrap();
            let Integral::Listed(map) = model.integral else { unreachable!() };
            let worst = (0..61).into_par_iter().map(|k| {
                // Additive recurrences of two irrationals: even over α's logarithm, and over μ or its logarithm.
                let (u, v) = ((k as f64 * 0.754_877_666).fract(), (k as f64 * 0.569_840_291).fract());
                let mu = if k % 2 == 0 { 2f64.powf(-24.0 * u * u) } else { u };
                // And the worst place.
                let (mu, alpha) = match k {
                    60 => (1e-7, ALPHA_LEAST),
                    _ => (mu, ALPHA_LEAST.powf((1.1 * v).min(1.0))),
                };
                let s = alpha.into();
                let most = SlopeCounts { azimuths: 70, nodes: 80 };
                let exact = sum(model, samples(mu, &[], most, 1e-10, of_normal), &s);
                if k < 6 {
                    let truth = truth::rho_dh(model, mu, &s);
                    let error = (exact[0] - truth[0]).abs().max((exact[1] - truth[1]).abs());
                    assert!(error < 5e-10, "{name}, μ = {mu}, {s:?}: {error:e}");
                }
                let most = model.rho_bound;
                assert!(exact[0] + exact[1] <= most, "{name}, μ = {mu}, {s:?}: {exact:?} of {most}");
                let fixed = Fixed { mu, phi: 0.0, factored: false, kinks: Vec::new() };
                std::array::from_fn(|d| {
                    let tolerance = 10f64.powi(-1 - d as i32);
                    let samples = (map.samples)(&fixed, &s, tolerance);
                    assert!(samples.len() <= (map.most)(&s, tolerance), "{name}");
                    let rho = sum(model, samples, &s);
                    (rho[0] - exact[0]).abs().max((rho[1] - exact[1]).abs()) / tolerance
                })
            });
            let worst: [f64; 9] =
                worst.reduce(|| [0.0; 9], |a, b| std::array::from_fn(|d| f64::max(a[d], b[d])));
            println!("{name}: {}", worst.map(|share| format!("{share:.2}")).join(" "));
            if worst.iter().any(|&share| share > 1.0) {
                failed.push((name, worst));
            }
        }
        assert!(failed.is_empty(), "{failed:#?} of the tolerance");
    }

    /// Without a panel that ends at v-cavity's seam, 1e-8 is off by 400 times as much at α = 1.
    #[test]
    fn means_meet_the_tolerance_where_masking_has_kinks() {
        let model = model::find("charlie-v-cavity-schlick").unwrap();
        for alpha in [0.1, 1.0] {
            let s = alpha.into();
            let mean = |nodes: Vec<Node>, finer: f64| {
                let [counts, _] = counts(finer);
                let at = |n: &Node| {
                    let rho = sum(model, samples(n.x, &[], counts, finer, VCavity::OF_NORMAL), &s);
                    rho.map(|rho| rho * n.weight)
                };
                nodes.par_iter().map(at).reduce(|| [0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]])
            };
            let exact = mean(mean_of(40, 1e-10, &[0.0, 0.5, FRAC_1_SQRT_2, 1.0]), 1e-9);
            for tolerance in [1e-2, 1e-4, 1e-6, 1e-8] {
                let found = mean(mean_with_kinks(tolerance), 0.1 * tolerance);
                let error = (found[0] - exact[0]).abs().max((found[1] - exact[1]).abs());
                println!("α = {alpha} to {tolerance:e}: {error:.1e}");
                assert!(error <= 0.5 * tolerance, "α = {alpha}: {error:e} of {tolerance:e}");
            }
        }
    }
}
