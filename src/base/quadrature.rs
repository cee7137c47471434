//! Quadrature rules on [0, 1]: Gauss–Legendre and midpoints.

use std::f64::consts::PI;
use std::sync::OnceLock;

/// A node and its weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// The node, in [0, 1].
    pub x: f64,
    /// The weight; a rule's weights sum to 1.
    pub weight: f64,
}

/// The Gauss–Legendre rule with `n` nodes, exact for polynomials of degree 2n − 1.
///
/// Newton's iteration on P_n from Tricomi's first guess (Abramowitz & Stegun 1964, 22.16.6; weights
/// 25.4.29). A rule of up to 256 nodes is found once.
pub fn gauss_legendre(n: usize) -> Vec<Node> {
    static FOUND: [OnceLock<Vec<Node>>; 257] = [const { OnceLock::new() }; 257];
    FOUND.get(n).map_or_else(|| legendre_nodes(n), |found| found.get_or_init(|| legendre_nodes(n)).clone())
}

fn legendre_nodes(n: usize) -> Vec<Node> {
    let mut nodes: Vec<_> = (0..n)
        .map(|k| {
            let mut x = (PI * (k as f64 + 0.75) / (n as f64 + 0.5)).cos();
            // Quadratic convergence from a guess good to 1/n²: five steps reach the last bit.
            for _ in 0..8 {
                let (p, dp) = legendre(n, x);
                x -= p / dp;
            }
            let (_, dp) = legendre(n, x);
            Node { x: 0.5 * (1.0 - x), weight: 1.0 / ((1.0 - x * x) * dp * dp) }
        })
        .collect();
    nodes.sort_by(|a, b| a.x.total_cmp(&b.x));
    nodes
}

/// P_n(x) and its derivative, by the three-term recurrence.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut p0, mut p1) = (1.0, x);
    for k in 2..=n {
        let k = k as f64;
        (p0, p1) = (p1, ((2.0 * k - 1.0) * x * p1 - (k - 1.0) * p0) / k);
    }
    (p1, n as f64 * (x * p1 - p0) / (x * x - 1.0))
}

/// The midpoint rule with `n` cells.
pub fn midpoint(n: usize) -> Vec<Node> {
    let n = n as f64;
    (0..n as usize).map(|k| Node { x: (k as f64 + 0.5) / n, weight: 1.0 / n }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gauss_legendre_is_exact_to_degree_2n_minus_1() {
        for n in [1, 2, 5, 16, 40, 64, 256] {
            let rule = gauss_legendre(n);
            for degree in [0, 1, 2 * n - 1] {
                let sum: f64 = rule.iter().map(|g| g.weight * g.x.powi(degree as i32)).sum();
                // n roundings of weights that sum to one, and powi's.
                let budget = 4e-16 * (n as f64 + degree as f64);
                assert!(
                    (sum - 1.0 / (degree as f64 + 1.0)).abs() < budget,
                    "n = {n}, degree {degree}: {sum}"
                );
            }
        }
    }

    #[test]
    fn one_degree_more_is_too_much() {
        let sum: f64 = gauss_legendre(3).iter().map(|g| g.weight * g.x.powi(6)).sum();
        assert!((sum - 1.0 / 7.0).abs() > 1e-5);
    }
}
