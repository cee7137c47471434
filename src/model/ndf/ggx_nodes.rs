//! The error model of GGX's warped rule: how many nodes meet a tolerance.
//!
//! Tabulated, not fitted: the integrand is analytic, but what limits its convergence changes over
//! (μ, α). The table was made by `print_the_error_model` below, from the f64 twin: at each place the
//! least counts such that these and all larger ones keep the rule's error below a share of the tolerance
//! (`MARGIN`), for each of the four counts on its own, in tenths: where the error crosses between two
//! counts. Between the places they are interpolated, and rounded up at last.

use crate::base::tolerance::decade;
use crate::model::SlopeCounts;

/// The places in −log₂ μ and −log₂ α. Deep down things change with the ratio μ/α; there, and at μ = 1, the
/// table has the most of what is half way to the neighbours.
const MU_PLACES: [f64; 22] = [
    0.0, 0.12, 0.25, 0.42, 0.6, 0.8, 1.0, 1.25, 1.5, 1.85, 2.2, 2.7, 3.2, 3.8, 4.5, 5.5, 6.5, 8.0, 10.0,
    13.0, 17.0, 24.0,
];
const ALPHA_PLACES: [f64; 22] = [
    0.0, 0.17, 0.35, 0.57, 0.8, 1.1, 1.4, 1.8, 2.2, 2.7, 3.2, 3.8, 4.5, 5.5, 6.5, 7.7, 9.0, 11.0, 13.0, 17.0,
    24.0, 40.0,
];
const DECADES: usize = 10;

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
    use crate::base::half_angle::MU_MIN;
    use crate::base::quadrature::{Node, gauss_legendre};
    use crate::model;
    use crate::model::slope_azimuths::side;
    use crate::model::{ALPHA_MIN_INTEGRAL, Integral, Slopes};
    use rayon::prelude::*;

    const MOST: usize = 250;
    /// The four errors of a texel seldom meet, and never in full; f32 rounds at 1e-6, and the finest leave room.
    const MARGIN: [f64; DECADES] = [3.3, 3.3, 3.3, 3.3, 3.3, 3.8, 6.0, 6.0, 6.0, 6.0];

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

    /// For each tolerance, in tenths, the least count that it and all larger ones meet.
    fn least(exact: [f64; 2], of: impl Fn(usize) -> [f64; 2]) -> [u16; DECADES] {
        let mut errors = vec![f64::INFINITY];
        let mut quiet = 0;
        // Converged for good once it has been quiet for a while.
        while quiet < 12 && errors.len() < MOST {
            let [a, b] = of(errors.len());
            let error = (a - exact[0]).abs().max((b - exact[1]).abs());
            quiet = if error < 1e-12 { quiet + 1 } else { 0 };
            errors.push(error);
        }
        std::array::from_fn(|decade| {
            let bound = 10f64.powi(-1 - decade as i32) / MARGIN[decade];
            let last = errors.iter().rposition(|&error| error > bound).unwrap_or(0);
            let (above, below) = (errors[last], errors.get(last + 1).copied().unwrap_or(0.0));
            let share =
                if last == 0 || below == 0.0 { 1.0 } else { (above / bound).ln() / (above / below).ln() };
            (10.0 * (last as f64 + share)).ceil() as u16
        })
    }

    /// `cargo test --release -- --ignored print_the_error_model --nocapture > src/models/ndf/ggx_counts.rs`
    /// and cut what is not the table.
    #[test]
    #[ignore = "takes minutes; prints the table"]
    fn print_the_error_model() {
        let rules: Vec<_> = (0..=MOST).map(gauss_legendre).collect();
        // A place, and where it is deep, half way to its neighbours; and at μ = 1, where azimuths matter no more.
        let around = |places: &[f64], k: usize, deep: f64, smallest: f64| {
            let half_way = |other: usize| 0.5 * (places[k] + places[other.min(places.len() - 1)]);
            let all = [places[k], half_way(k.saturating_sub(1)), half_way(k + 1)];
            let count = if k == 0 || places[k] >= deep { 3 } else { 1 };
            all.into_iter().take(count).map(move |octaves| 2f64.powf(-octaves).max(smallest))
        };
        let (rows, columns) = (MU_PLACES.len(), ALPHA_PLACES.len());
        let places: Vec<_> = (0..rows * columns).collect();
        let table: Vec<[[u16; 4]; DECADES]> = places
            .par_iter()
            .map(|place| {
                let mut most = [[10; 4]; DECADES];
                for mu in around(&MU_PLACES, place / columns, 4.5, MU_MIN) {
                    for alpha in around(&ALPHA_PLACES, place % columns, 6.5, ALPHA_MIN_INTEGRAL) {
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
            "/// [near nodes, far nodes, near azimuths, far azimuths] in tenths, for each tolerance and place."
        );
        println!("#[rustfmt::skip]\nstatic COUNTS: [[[[u16; 4]; {columns}]; {rows}]; DECADES] = [");
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
