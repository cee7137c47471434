//! Node counts of GGX with height-correlated Smith and Schlick.
//!
//! Method: at each place of μ and α, for each side of the azimuths, the least counts such that these and all larger ones keep
//! the rule's error below a share of the tolerance ([`MARGIN`]), for nodes and azimuths each on its own while the other is
//! plenty, in tenths of a node: where the error crosses the bound between two counts. Where a place is deep, things change with
//! the ratio μ/α, and at μ = 1 with 1 − μ: the table has the most of what is half way to its neighbours.

use super::Tabulated;
use crate::base::half_angle::MU_MIN;
use crate::base::quadrature::{Node, gauss_legendre};
use crate::model::ndf::Ndf;
use crate::model::ndf::ggx::Ggx;
use crate::model::ndf::ggx_nodes::{ALPHA_PLACES, DECADES, MU_PLACES};
use crate::model::slope_azimuths::side;
use crate::model::{self, ALPHA_MIN_INTEGRAL, Integral, SlopeMap};
use rayon::prelude::*;
use std::fmt::Write;

pub(super) const TABLE: Tabulated = Tabulated {
    name: "ggx-counts",
    file: "src/model/ndf/ggx_counts.rs",
    summary: "node counts of GGX, by tolerance, μ and α",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/src/model/ndf/ggx_counts.rs")),
    compute,
};

/// Counts at which everything has converged.
const PLENTY: usize = 250;

/// The four errors of a texel seldom meet, and never in full; f32 rounds at 1e-6, and the finest leave room.
const MARGIN: [f64; DECADES] = [3.3, 3.3, 3.3, 3.3, 3.3, 3.8, 6.0, 6.0, 6.0, 6.0];

/// Octaves from which on a place is deep.
const DEEP_MU: f64 = 4.5;
const DEEP_ALPHA: f64 = 6.5;

/// [near nodes, far nodes, near azimuths, far azimuths] in tenths, for each tolerance.
type MeasuredCounts = [[u16; 4]; DECADES];

fn compute(tick: &(dyn Fn(f64) + Sync)) -> String {
    let rules = rules();
    let [rows, columns] = [MU_PLACES.len(), ALPHA_PLACES.len()];
    let count = |k: usize| {
        let counts = counts_at(&rules, k / columns, k % columns);
        tick(1.0 / (rows * columns) as f64);
        counts
    };
    let table: Vec<MeasuredCounts> = (0..rows * columns).into_par_iter().map(count).collect();
    let mut text = String::from(
        "/// [near nodes, far nodes, near azimuths, far azimuths] in tenths, for each tolerance and place.\n",
    );
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "#[rustfmt::skip]\npub(crate) static COUNTS: [[[[u16; 4]; {columns}]; {rows}]; DECADES] = ["
    );
    for decade in 0..DECADES {
        let _ = writeln!(text, "    [ // 1e-{}", decade + 1);
        for mu in table.chunks(columns) {
            let row: Vec<_> = mu.iter().map(|alpha| format!("{:?}", alpha[decade])).collect();
            let _ = writeln!(text, "        [{}],", row.join(", "));
        }
        text += "    ],\n";
    }
    text + "];\n"
}

fn rules() -> Vec<Vec<Node>> {
    (0..=PLENTY).map(gauss_legendre).collect()
}

/// The counts at a place.
fn counts_at(rules: &[Vec<Node>], mu_place: usize, alpha_place: usize) -> MeasuredCounts {
    let mut largest = [[10; 4]; DECADES];
    for mu in around(&MU_PLACES, mu_place, DEEP_MU, MU_MIN) {
        for alpha in around(&ALPHA_PLACES, alpha_place, DEEP_ALPHA, ALPHA_MIN_INTEGRAL) {
            for (k, sign) in [1.0, -1.0].into_iter().enumerate() {
                // Both maps, each for the tolerances that it serves.
                for (tolerance, decades) in [(1e-6, 0..6), (1e-10, 6..DECADES)] {
                    let rho = |azimuths, nodes: usize| {
                        integral(mu, alpha, sign, azimuths, &rules[nodes], tolerance)
                    };
                    let nodes = least(rho(50, PLENTY), |n| rho(50, n));
                    let azimuths = least(rho(140, 100), |n| rho(n, 100));
                    for decade in decades {
                        largest[decade][k] = largest[decade][k].max(nodes[decade]);
                        largest[decade][2 + k] = largest[decade][2 + k].max(azimuths[decade]);
                    }
                }
            }
        }
    }
    largest
}

/// A place, and where it is deep, half way to its neighbours; and at μ = 1, where azimuths matter no more.
fn around(places: &[f64], k: usize, deep: f64, smallest: f64) -> impl Iterator<Item = f64> {
    let half_way = |other: usize| 0.5 * (places[k] + places[other.min(places.len() - 1)]);
    let all = [places[k], half_way(k.saturating_sub(1)), half_way(k + 1)];
    let count = if k == 0 || places[k] >= deep { 3 } else { 1 };
    all.into_iter().take(count).map(move |octaves| 2f64.powf(-octaves).max(smallest))
}

/// One side of ρ by so many azimuths and by some nodes in r.
fn integral(mu: f64, alpha: f64, sign: f64, azimuths: usize, nodes: &[Node], tolerance: f64) -> [f64; 2] {
    let Some(map) = map(tolerance) else { return [f64::NAN; 2] };
    let setting = alpha.into();
    let mut sum = [0.0; 2];
    for [c, t_max, inverse, weight] in side(mu, sign, &gauss_legendre(azimuths), tolerance) {
        let end = (map.end)(t_max, &setting);
        for node in nodes {
            let [a, b] = (map.integrand)(end * node.x, [c, t_max, inverse], mu, &setting);
            let weight = weight * end * node.weight;
            sum = [sum[0] + weight * a, sum[1] + weight * b];
        }
    }
    sum
}

fn map(tolerance: f64) -> Option<&'static SlopeMap> {
    let Integral::Slopes(slopes) = model::find(Ggx::TERM.name).ok()?.integral else {
        return None;
    };
    Some(slopes.map(tolerance))
}

/// For each tolerance, in tenths, the least count that it and all larger ones meet.
fn least(exact: [f64; 2], rho: impl Fn(usize) -> [f64; 2]) -> [u16; DECADES] {
    let mut errors = vec![f64::INFINITY];
    let mut quiet = 0;
    // Converged for good once it has been quiet for a while.
    while quiet < 12 && errors.len() < PLENTY {
        let [a, b] = rho(errors.len());
        let error = (a - exact[0]).abs().max((b - exact[1]).abs());
        quiet = if error < 1e-12 { quiet + 1 } else { 0 };
        errors.push(error);
    }
    std::array::from_fn(|decade| {
        let bound = 10f64.powi(-1 - decade as i32) / MARGIN[decade];
        let last = errors.iter().rposition(|&error| error > bound).unwrap_or(0);
        let (above, below) = (errors[last], errors.get(last + 1).copied().unwrap_or(0.0));
        let share = if last == 0 || below == 0.0 { 1.0 } else { (above / bound).ln() / (above / below).ln() };
        (10.0 * (last as f64 + share)).ceil() as u16
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::ndf::ggx_nodes::COUNTS;

    /// The table in the source is what the command writes: at some places, of which the deep ones take seconds.
    #[test]
    fn the_table_is_what_the_command_writes_at_some_places() {
        let rules = rules();
        let places = [(0, 0), (0, 7), (3, 3), (5, 12), (8, 1), (10, 10), (13, 5)];
        places.into_par_iter().for_each(|(i, j)| {
            let counts = counts_at(&rules, i, j);
            let source: MeasuredCounts = std::array::from_fn(|decade| COUNTS[decade][i][j]);
            assert_eq!(counts, source, "at μ = 2^-{}, α = 2^-{}", MU_PLACES[i], ALPHA_PLACES[j]);
        });
    }

    /// The same at all places.
    #[test]
    #[ignore = "takes minutes: computes the table of 484 places again"]
    fn the_table_is_what_the_command_writes() {
        assert_eq!(compute(&|_| ()), TABLE.source);
    }
}
