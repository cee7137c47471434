//! The error model of GGX's warped rule: how many nodes meet a tolerance.
//!
//! Tabulated, not fitted: the integrand is analytic, but what limits its convergence changes over
//! (μ, α). The table was made by `print_the_error_model` below, from the f64 twin: for each bin the
//! least counts such that these and all larger ones keep the rule's error below a third of the
//! tolerance, everywhere in the bin, for each of the four counts on its own.

use crate::models::{SlopeCounts, decade};

/// Edges of the bins in −log₂ μ and −log₂ α; the last bins hold all that is smaller.
const MU_EDGES: [f64; 18] =
    [0.0, 0.12, 0.25, 0.42, 0.6, 0.8, 1.0, 1.25, 1.5, 1.85, 2.2, 2.7, 3.2, 3.8, 4.5, 5.5, 6.5, 10.0];
const ALPHA_EDGES: [f64; 18] =
    [0.0, 0.17, 0.35, 0.57, 0.8, 1.1, 1.4, 1.8, 2.2, 2.7, 3.2, 3.8, 4.5, 5.5, 6.5, 7.7, 9.0, 13.0];
const DECADES: usize = 10;

pub(crate) fn counts(mu: f64, alpha: f64, tolerance: f64) -> [SlopeCounts; 2] {
    let counts = COUNTS[decade(tolerance)][bin(&MU_EDGES, mu)][bin(&ALPHA_EDGES, alpha)];
    let [near_nodes, far_nodes, near_azimuths, far_azimuths] = counts.map(usize::from);
    let side = |azimuths, nodes| SlopeCounts { azimuths, nodes };
    [side(near_azimuths, near_nodes), side(far_azimuths, far_nodes)]
}

fn bin(edges: &[f64], value: f64) -> usize {
    let octaves = -value.log2();
    edges.iter().rposition(|&edge| octaves >= edge).unwrap_or(0)
}

include!("ggx_counts.rs");

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::{self, ALPHA_MIN_INTEGRAL, Integral, Slopes};
    use crate::pair::MU_MIN;
    use crate::quadrature::{Node, gauss_legendre};
    use crate::slopes::side;
    use rayon::prelude::*;

    const MOST: usize = 250;
    /// The four errors of a texel seldom meet, and never in full.
    const MARGIN: f64 = 3.0;

    fn slopes() -> &'static Slopes {
        let Integral::Slopes(slopes) = models::find("ggx").unwrap().integral else { unreachable!() };
        slopes
    }

    fn integral(mu: f64, alpha: f64, sign: f64, azimuths: usize, nodes: &[Node], tolerance: f64) -> [f64; 2] {
        let map = slopes().map(tolerance);
        let mut sum = [0.0; 2];
        for [c, t_max, inverse, weight] in side(mu, sign, azimuths, tolerance) {
            let end = (map.end)(t_max, alpha);
            for node in nodes {
                let [a, b] = (map.integrand)(end * node.x, [c, t_max, inverse], mu, alpha);
                let weight = weight * end * node.weight;
                sum = [sum[0] + weight * a, sum[1] + weight * b];
            }
        }
        sum
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
        (0..200).into_par_iter().for_each(|k| {
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

    /// For each tolerance the least count that it and all larger ones meet.
    fn least(exact: [f64; 2], of: impl Fn(usize) -> [f64; 2]) -> [u8; DECADES] {
        let mut needed = [1; DECADES];
        let mut quiet = 0;
        for n in 1..MOST {
            let [a, b] = of(n);
            let error = (a - exact[0]).abs().max((b - exact[1]).abs());
            for (decade, needed) in needed.iter_mut().enumerate() {
                if error > 10f64.powi(-1 - decade as i32) / MARGIN {
                    *needed = n as u8 + 1;
                }
            }
            // Converged for good once it has been quiet for a while.
            quiet = if error < 1e-11 { quiet + 1 } else { 0 };
            if quiet > 12 {
                break;
            }
        }
        needed
    }

    /// `cargo test --release -- --ignored print_the_error_model --nocapture > src/models/ndf/ggx_counts.rs`
    /// and cut what is not the table.
    #[test]
    #[ignore = "takes minutes; prints the table"]
    fn print_the_error_model() {
        let rules: Vec<_> = (0..=MOST).map(gauss_legendre).collect();
        let span = |edges: &[f64], k: usize, smallest: f64| {
            let low = edges[k];
            let high = edges.get(k + 1).copied().unwrap_or(-smallest.log2());
            // Every half octave at least, and the edges.
            let samples = (2.0 * (high - low)).ceil().clamp(2.0, 12.0) as usize;
            (0..=samples).map(move |i| 2f64.powf(-(low + (high - low) * i as f64 / samples as f64)))
        };
        let (rows, columns) = (MU_EDGES.len(), ALPHA_EDGES.len());
        let bins: Vec<_> = (0..rows * columns).collect();
        let table: Vec<[[u8; 4]; DECADES]> = bins
            .par_iter()
            .map(|bin| {
                let mut most = [[1; 4]; DECADES];
                for mu in span(&MU_EDGES, bin / columns, MU_MIN) {
                    for alpha in span(&ALPHA_EDGES, bin % columns, ALPHA_MIN_INTEGRAL) {
                        for (k, sign) in [1.0, -1.0].into_iter().enumerate() {
                            // Both maps, each for the tolerances that it serves.
                            for (tolerance, decades) in [(1e-6, 0..6), (1e-10, 6..DECADES)] {
                                let with = |azimuths, nodes: usize| {
                                    integral(mu, alpha, sign, azimuths, &rules[nodes], tolerance)
                                };
                                let nodes = least(with(50, MOST), |n| with(50, n));
                                let azimuths = least(with(140, 100), |n| with(n, 100));
                                for decade in decades {
                                    most[decade][k] = most[decade][k].max(nodes[decade]);
                                    most[decade][2 + k] = most[decade][2 + k].max(azimuths[decade]);
                                }
                            }
                        }
                    }
                }
                most
            })
            .collect();
        println!(
            "/// [near nodes, far nodes, near azimuths, far azimuths] for each tolerance, μ bin and α bin."
        );
        println!("#[rustfmt::skip]\nconst COUNTS: [[[[u8; 4]; 18]; 18]; DECADES] = [");
        for decade in 0..DECADES {
            println!("    [ // 1e-{}", decade + 1);
            for mu in table.chunks(columns) {
                let row: Vec<_> = mu.iter().map(|alpha| format!("{:?}", alpha[decade])).collect();
                println!("        [{}],", row.join(", "));
            }
            println!("    ],");
        }
        println!("];");
    }
}
