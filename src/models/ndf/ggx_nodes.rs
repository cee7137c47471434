//! The error model of GGX's warped rule: how many nodes meet a tolerance.
//!
//! Tabulated, not fitted: the integrand is analytic, but what limits its convergence changes over
//! (μ, α). The table was made by `print_the_error_model` below, from the f64 twin: for each bin the
//! least counts such that these and all larger ones keep the rule's error below a quarter of the
//! tolerance, everywhere in the bin, for each of the four counts on its own.

use crate::models::decade;

/// Edges of the bins in −log₂ μ and −log₂ α; the last bins hold all that is smaller.
const MU_EDGES: [f64; 10] = [0.0, 0.25, 0.6, 1.0, 1.5, 2.2, 3.2, 4.5, 6.5, 10.0];
const ALPHA_EDGES: [f64; 10] = [0.0, 0.35, 0.8, 1.4, 2.2, 3.2, 4.5, 6.5, 9.0, 13.0];
const DECADES: usize = 10;

/// Azimuths with cos φ > 0 and with cos φ < 0.
pub(crate) fn azimuths(mu: f64, alpha: f64, tolerance: f64) -> [usize; 2] {
    let [_, _, near, far] = counts(mu, alpha, tolerance);
    [near.into(), far.into()]
}

/// Nodes in r, on each of these sides.
pub(crate) fn nodes(mu: f64, alpha: f64, tolerance: f64) -> [usize; 2] {
    let [near, far, _, _] = counts(mu, alpha, tolerance);
    [near.into(), far.into()]
}

fn counts(mu: f64, alpha: f64, tolerance: f64) -> [u8; 4] {
    COUNTS[decade(tolerance)][bin(&MU_EDGES, mu)][bin(&ALPHA_EDGES, alpha)]
}

fn bin(edges: &[f64], value: f64) -> usize {
    let octaves = -value.log2();
    edges.iter().rposition(|&edge| octaves >= edge).unwrap_or(0)
}

include!("ggx_counts.rs");

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::{self, ALPHA_MIN_INTEGRAL, Integral};
    use crate::pair::MU_MIN;
    use crate::quadrature::{Node, gauss_legendre};
    use crate::slopes::side;
    use rayon::prelude::*;

    const MOST: usize = 250;

    fn integral(mu: f64, alpha: f64, sign: f64, azimuths: usize, nodes: &[Node], tolerance: f64) -> [f64; 2] {
        let Integral::Slopes(slopes) = models::find("ggx").unwrap().integral else { unreachable!() };
        let mut sum = [0.0; 2];
        for [c, t_max, inverse, weight] in side(mu, sign, azimuths, tolerance) {
            let end = (slopes.end)(t_max, alpha);
            for node in nodes {
                let [a, b] = (slopes.integrand)(end * node.x, [c, t_max, inverse], mu, alpha);
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
            let [near, far] = nodes(mu, alpha, tolerance);
            let azimuths = azimuths(mu, alpha, tolerance);
            [(1.0, near, azimuths[0]), (-1.0, far, azimuths[1])].map(|(sign, nodes, azimuths)| {
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
                if error > 10f64.powi(-1 - decade as i32) / 4.0 {
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
            const SAMPLES: usize = 6;
            (0..=SAMPLES).map(move |i| 2f64.powf(-(low + (high - low) * i as f64 / SAMPLES as f64)))
        };
        let bins: Vec<_> = (0..100).collect();
        let table: Vec<[[u8; 4]; DECADES]> = bins
            .par_iter()
            .map(|bin| {
                let mut most = [[1; 4]; DECADES];
                for mu in span(&MU_EDGES, bin / 10, MU_MIN) {
                    for alpha in span(&ALPHA_EDGES, bin % 10, ALPHA_MIN_INTEGRAL) {
                        for (k, sign) in [1.0, -1.0].into_iter().enumerate() {
                            // Both maps of the azimuth, each for the tolerances that it serves.
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
        println!("#[rustfmt::skip]\nconst COUNTS: [[[[u8; 4]; 10]; 10]; DECADES] = [");
        for decade in 0..DECADES {
            println!("    [ // 1e-{}", decade + 1);
            for mu in table.chunks(10) {
                let row: Vec<_> = mu.iter().map(|alpha| format!("{:?}", alpha[decade])).collect();
                println!("        [{}],", row.join(", "));
            }
            println!("    ],");
        }
        println!("];");
    }
}
