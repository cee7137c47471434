//! Directions of a smooth lobe, in panels of cos θ and δφ that end at its kinks.

use crate::base::half_angle::{Azimuth, Pair};
use crate::base::quadrature::{Node, gauss_legendre};
use crate::model::directions::{Fixed, Sample};
use std::f64::consts::{FRAC_PI_2, PI};

/// Directions for a fixed cosine, which weigh cos θ dω: so many in θ, in asinh(μ/δ) and in δφ, in panels of cos θ that end at
/// kinks, and panels of δφ that end where ωi and ωe are perpendicular in azimuth, if there is a kink.
pub(crate) fn directions(
    fixed: &Fixed,
    delta: f64,
    kinks: &[f64],
    counts: [usize; 3],
    kinked: bool,
) -> Vec<Sample> {
    let [theta, steep, phi] = counts.map(gauss_legendre);
    let mu = fixed.mu;
    let panels = |[low, high]: [f64; 2]| {
        let mut ends = vec![low];
        ends.extend(kinks.iter().copied().filter(|&kink| low < kink && kink < high));
        ends.push(high);
        ends.sort_by(f64::total_cmp);
        ends
    };
    let mut directions = Vec::new();
    for ends in panels([SPLIT, 1.0]).windows(2) {
        // θ falls as μ rises.
        let [from, to] = [ends[1].acos(), ends[0].acos()];
        directions.extend(theta.iter().map(|node| {
            let (sin, cos) = (from + (to - from) * node.x).sin_cos();
            (cos, sin, (to - from) * node.weight * sin * cos)
        }));
    }
    for ends in panels([0.0, SPLIT]).windows(2) {
        let [from, to] = [ends[0], ends[1]].map(|mu| (mu / delta).asinh());
        directions.extend(steep.iter().map(|node| {
            let u = from + (to - from) * node.x;
            let cos = delta * u.sinh();
            (cos, ((1.0 - cos) * (1.0 + cos)).sqrt(), (to - from) * node.weight * cos * delta * u.cosh())
        }));
    }
    let azimuths: Vec<_> = if kinked {
        [0.0, FRAC_PI_2].into_iter().flat_map(|start| turn(&phi, start, FRAC_PI_2)).collect()
    } else {
        turn(&phi, 0.0, PI).collect()
    };
    let sin = fixed.sin();
    let sample = |&(cos_e, sin_e, weight): &(f64, f64, f64)| {
        let pair = Pair::of_cosines_and_sines([mu, cos_e], [sin, sin_e]);
        azimuths.iter().map(move |&(azimuth, width)| Sample { pair, azimuth, weight: weight * width })
    };
    directions.iter().flat_map(sample).collect()
}

/// Below it, θ ≤ 60°, f is smooth in θ; above it factors are in asinh(μ/δ).
pub(crate) const SPLIT: f64 = 0.5;

/// Azimuths δφ with their mirror images.
fn turn(rule: &[Node], start: f64, width: f64) -> impl Iterator<Item = (Azimuth, f64)> {
    rule.iter().map(move |node| (Azimuth::new(start + width * node.x), 2.0 * width * node.weight))
}
