//! Directions for the integrals of Charlie. It has no peak that a map of its normals would flatten; but f is not
//! analytic at
//! - the horizon, where L has μ^c, and 0° where it has (1 − μ)^c; 60°, where Λ's two branches meet;
//! - the mirror direction, where sin^(1/α) θm comes to a point, the sharpest, a cone, at α = 1.
//!
//! So panels in the elevation ψ = π/2 − θe end at all of these, each by the double exponential rule (Takahasi & Mori
//! 1974), which no algebraic singularity at an end slows down; and for each ψ the azimuth is δφ = d sinh u with d the
//! distance 2 dt/√ss at which sin θm turns, so that the point's neighbourhood is seen at every scale.

use crate::mapped::Sample;
use crate::models::{SlopeCounts, decade};
use crate::pair::{Azimuth, Pair};
use crate::quadrature::{Node, gauss_legendre};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_6, PI};

/// Where Λ's branches meet.
const SEAM: f64 = FRAC_PI_6;

/// Directions and what they weigh: cos θ dω of them.
pub(super) fn samples(mu: f64, counts: SlopeCounts, tolerance: f64) -> Vec<Sample> {
    let sin = ((1.0 - mu) * (1.0 + mu)).sqrt();
    let own = mu.atan2(sin);
    let (rule, turns) = (ends(counts.nodes, tolerance), gauss_legendre(counts.azimuths));
    let mut breaks = [0.0, SEAM, own, FRAC_PI_2];
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
            let u_max = (PI / d).asinh();
            for turn in &turns {
                let u = u_max * turn.x;
                // Both halves of the azimuth.
                let azimuth = 2.0 * turn.weight * u_max * d * u.cosh();
                samples.push(Sample {
                    pair,
                    azimuth: Azimuth::new(d * u.sinh()),
                    weight: weight * width * mu_e * sin_e * azimuth,
                });
            }
        }
    }
    samples
}

/// At most so many.
pub(super) fn most(counts: SlopeCounts) -> usize {
    3 * counts.nodes * counts.azimuths
}

/// cos θ of the directions whose ρ make the mean ∫ ρ 2μ dμ, and their weights: ρ has the same seam and ends. The nodes of each
/// tolerance leave less than a third of it.
pub(super) fn mean(tolerance: f64) -> Vec<Node> {
    const NODES: [usize; 10] = [4, 6, 8, 12, 16, 20, 24, 28, 32, 36];
    mean_of(NODES[decade(tolerance)], tolerance)
}

/// By so many nodes on each side of the seam.
fn mean_of(count: usize, tolerance: f64) -> Vec<Node> {
    let rule = ends(count, tolerance);
    let node = |start: f64, end: &End| {
        let mu = start + 0.5 * end.x;
        Node { x: mu, weight: end.weight * mu }
    };
    [0.0, 0.5].into_iter().flat_map(|start| rule.iter().map(move |end| node(start, end))).collect()
}

/// Counts for tolerances 1e-1 … 1e-10: the error of each count alone, the worst over α ∈ [1/200, 1] and μ ∈ [2⁻²⁴, 1], is
/// below a third of the tolerance. The worst is α = 1/200 where ωi grazes.
pub(super) fn counts(tolerance: f64) -> [SlopeCounts; 2] {
    const COUNTS: [[usize; 2]; 10] =
        [[5, 7], [7, 12], [12, 16], [20, 20], [25, 24], [32, 28], [38, 33], [46, 38], [54, 44], [60, 50]];
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
