//! The error model of GGX's warped rule: how many nodes meet a tolerance.
//!
//! Tabulated, not fitted: the integrand is analytic, but what limits its convergence changes over
//! (μ, α). The table was made by `print_the_error_model` below, from the f64 twin: for each bin the
//! least counts such that these and all larger ones keep the rule's error below a sixth of the
//! tolerance, everywhere in the bin, for each of the four counts on its own.

/// Edges of the bins in −log₂ μ and −log₂ α; the last bins hold all that is smaller.
const MU_EDGES: [f64; 10] = [0.0, 0.25, 0.6, 1.0, 1.5, 2.2, 3.2, 4.5, 6.5, 10.0];
const ALPHA_EDGES: [f64; 10] = [0.0, 0.35, 0.8, 1.4, 2.2, 3.2, 4.5, 6.5, 9.0, 13.0];
/// Tolerances 10⁻¹ … 10⁻¹⁰.
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
    // The decade at or below the tolerance; the slack forgives the rounding of 1e-3.
    let decade = (-tolerance.log10() - 1e-9).ceil().clamp(1.0, DECADES as f64) as usize - 1;
    COUNTS[decade][bin(&MU_EDGES, mu)][bin(&ALPHA_EDGES, alpha)]
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

    fn integral(mu: f64, alpha: f64, sign: f64, azimuths: usize, nodes: &[Node]) -> [f64; 2] {
        let Integral::Slopes(slopes) = models::find("ggx").unwrap().integral else { unreachable!() };
        let mut sum = [0.0; 2];
        for [c, t_max, inverse, weight] in side(mu, sign, azimuths) {
            let end = (slopes.end)(t_max, alpha);
            for node in nodes {
                let [a, b] = (slopes.integrand)(end * node.x, [c, t_max, inverse], mu, alpha);
                let weight = weight * end * node.weight;
                sum = [sum[0] + weight * a, sum[1] + weight * b];
            }
        }
        sum
    }

    /// For each tolerance the least count that it and all larger ones meet.
    fn least(exact: [f64; 2], of: impl Fn(usize) -> [f64; 2]) -> [u8; DECADES] {
        let mut needed = [1; DECADES];
        let mut quiet = 0;
        for n in 1..MOST {
            let [a, b] = of(n);
            let error = (a - exact[0]).abs().max((b - exact[1]).abs());
            for (decade, needed) in needed.iter_mut().enumerate() {
                if error > 10f64.powi(-1 - decade as i32) / 6.0 {
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
            const SAMPLES: usize = 4;
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
                            let exact = integral(mu, alpha, sign, 70, &rules[MOST]);
                            let nodes = least(exact, |n| integral(mu, alpha, sign, 70, &rules[n]));
                            let fine = integral(mu, alpha, sign, 120, &rules[100]);
                            let azimuths = least(fine, |n| integral(mu, alpha, sign, n, &rules[100]));
                            for decade in 0..DECADES {
                                most[decade][k] = most[decade][k].max(nodes[decade]);
                                most[decade][2 + k] = most[decade][2 + k].max(azimuths[decade]);
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
            for mu in 0..10 {
                let row: Vec<_> =
                    (0..10).map(|alpha| format!("{:?}", table[10 * mu + alpha][decade])).collect();
                println!("        [{}],", row.join(", "));
            }
            println!("    ],");
        }
        println!("];");
    }
}
