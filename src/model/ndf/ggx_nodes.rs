//! The error model of GGX's warped rule: how many nodes meet a tolerance.
//!
//! Tabulated, not fitted: the integrand is analytic, but what limits its convergence changes over
//! (μ, α). `cargo run --release --example tabulate -- ggx-counts` writes the table, from the f64 twin: see `src/lab/tabulate/`.
//! Between its places counts are interpolated, and rounded up at last.

use crate::base::tolerance::decade;
use crate::model::SlopeCounts;

/// The places in −log₂ μ and −log₂ α. Deep down things change with the ratio μ/α; there, and at μ = 1, the
/// table has the most of what is half way to the neighbours.
pub(crate) const MU_PLACES: [f64; 22] = [
    0.0, 0.12, 0.25, 0.42, 0.6, 0.8, 1.0, 1.25, 1.5, 1.85, 2.2, 2.7, 3.2, 3.8, 4.5, 5.5, 6.5, 8.0, 10.0,
    13.0, 17.0, 24.0,
];
pub(crate) const ALPHA_PLACES: [f64; 22] = [
    0.0, 0.17, 0.35, 0.57, 0.8, 1.1, 1.4, 1.8, 2.2, 2.7, 3.2, 3.8, 4.5, 5.5, 6.5, 7.7, 9.0, 11.0, 13.0, 17.0,
    24.0, 40.0,
];
pub(crate) const DECADES: usize = 10;

pub(crate) fn counts(mu: f64, alpha: f64, tolerance: f64) -> [SlopeCounts; 2] {
    let table = &COUNTS[decade(tolerance)];
    let ((i, u), (j, v)) = (place(&MU_PLACES, mu), place(&ALPHA_PLACES, alpha));
    let count = |k: usize| {
        let at = |i: usize, j: usize| f64::from(table[i][j][k]);
        let row = |i: usize| (1.0 - v) * at(i, j) + v * at(i, j + 1);
        // In tenths; the slack is for what the sums round up.
        (0.1 * ((1.0 - u) * row(i) + u * row(i + 1)) - 1e-9).ceil() as usize
    };
    [(0, 2), (1, 3)].map(|(nodes, azimuths)| SlopeCounts { azimuths: count(azimuths), nodes: count(nodes) })
}

/// The place at or before a value, and how far it is to the next.
fn place(places: &[f64], value: f64) -> (usize, f64) {
    let last = places.len() - 1;
    let octaves = (-value.log2()).clamp(0.0, places[last]);
    let k = places[..last].iter().rposition(|&place| octaves >= place).unwrap_or(0);
    (k, (octaves - places[k]) / (places[k + 1] - places[k]))
}

include!("ggx_counts.rs");

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::quadrature::{Node, gauss_legendre};
    use crate::model;
    use crate::model::slope_azimuths::side;
    use crate::model::{Integral, Slopes};
    use rayon::prelude::*;

    fn slopes() -> &'static Slopes {
        let Integral::Slopes(slopes) = model::find("ggx").unwrap().integral else { unreachable!() };
        slopes
    }

    fn integral(mu: f64, alpha: f64, sign: f64, azimuths: usize, nodes: &[Node], tolerance: f64) -> [f64; 2] {
        let map = slopes().map(tolerance);
        let mut sum = [0.0; 2];
        for [c, t_max, inverse, weight] in side(mu, sign, &gauss_legendre(azimuths), tolerance) {
            let end = (map.end)(t_max, &alpha.into());
            for node in nodes {
                let [a, b] = (map.integrand)(end * node.x, [c, t_max, inverse], mu, &alpha.into());
                let weight = weight * end * node.weight;
                sum = [sum[0] + weight * a, sum[1] + weight * b];
            }
        }
        sum
    }

    /// At grazing the tail counts, however small: A by 80-bit arithmetic in slopes of other coordinates. A map that ends at
    /// 1e9 α leaves 1.09e-9.
    #[test]
    fn grazing_meets_the_finest_tolerance() {
        let (mu, alpha) = (crate::base::half_angle::MU_MIN, f64::powi(1.0 / 39.0, 2));
        let [near, far] = counts(mu, alpha, 1e-9);
        let a: f64 = [(1.0, near), (-1.0, far)]
            .map(|(sign, c)| integral(mu, alpha, sign, c.azimuths, &gauss_legendre(c.nodes), 1e-9)[0])
            .iter()
            .sum();
        assert!((a - 0.019_414_401_953_476).abs() <= 0.5e-9, "{a}");
    }

    /// Away from the samples that the table was made from, the rule of each tolerance keeps it.
    #[test]
    fn the_error_model_holds_between_its_samples() {
        let total = |mu: f64, alpha: f64, tolerance: f64| {
            let [near, far] = counts(mu, alpha, tolerance);
            [(1.0, near), (-1.0, far)].map(|(sign, SlopeCounts { azimuths, nodes })| {
                integral(mu, alpha, sign, azimuths, &gauss_legendre(nodes), tolerance)
            })
        };
        let sum = |sides: [[f64; 2]; 2]| [sides[0][0] + sides[1][0], sides[0][1] + sides[1][1]];
        (0..3000).into_par_iter().for_each(|k| {
            // Additive recurrences of two irrationals: even over both logarithms.
            let (u, v) = ((k as f64 * 0.754_877_666).fract(), (k as f64 * 0.569_840_291).fract());
            let (mu, alpha) = (2f64.powf(-24.0 * u * u), 2f64.powf(-20.0 * v * v));
            let exact = sum(total(mu, alpha, 1e-10));
            for decade in 1..=9 {
                let tolerance = 10f64.powi(-decade);
                let rule = sum(total(mu, alpha, tolerance));
                let error = (rule[0] - exact[0]).abs().max((rule[1] - exact[1]).abs());
                assert!(error <= tolerance, "μ = {mu}, α = {alpha}: {error} where {tolerance} is promised");
            }
        });
    }
}
