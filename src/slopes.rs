//! The warped rule of microfacet lobes: which azimuths and how many nodes for each tile of texels.

use crate::models::Slopes;
use crate::quadrature::{Node, gauss_legendre};
use std::f64::consts::{FRAC_PI_2, PI};
use std::ops::Range;

/// Inner integrals in slopes of ωm, for each (α, μ).
pub(crate) struct SlopeWork {
    pub slopes: &'static Slopes,
    pub mus: Vec<f64>,
    /// (c, t_max, 1/t_max, weight), column by column.
    pub azimuths: Vec<[f64; 4]>,
    /// For each column the azimuths with cos φ > 0, and those with cos φ < 0.
    pub columns: Vec<[Range<usize>; 2]>,
    /// For each tile, α group by α group, the number of nodes on each side.
    tiles: Vec<[usize; 2]>,
    /// The Gauss–Legendre rules in use, one after the other, in the order of `rules`.
    pub nodes: Vec<Node>,
    rules: Vec<Range<usize>>,
}

/// Texels that share their node counts: so many α …
pub(crate) const TILE_ALPHAS: usize = 4;
/// … times so many μ.
pub(crate) const TILE_COLUMNS: usize = 8;

impl SlopeWork {
    pub fn new(slopes: &'static Slopes, mus: Vec<f64>, alphas: &[f64], tolerance: f64) -> Self {
        let groups: Vec<_> = mus.chunks(TILE_COLUMNS).collect();
        let (mut azimuths, mut columns) = (Vec::new(), Vec::new());
        for group in &groups {
            let counts = most(group, alphas, |mu, alpha| (slopes.azimuths)(mu, alpha, tolerance));
            for &mu in *group {
                columns.push([(1.0, counts[0]), (-1.0, counts[1])].map(|(sign, n)| {
                    let first = azimuths.len();
                    azimuths.extend(side(mu, sign, n, tolerance));
                    first..azimuths.len()
                }));
            }
        }
        let tiles: Vec<_> = alphas
            .chunks(TILE_ALPHAS)
            .flat_map(|alphas| groups.iter().map(move |group| (group, alphas)))
            .map(|(group, alphas)| most(group, alphas, |mu, alpha| (slopes.nodes)(mu, alpha, tolerance)))
            .collect();
        let largest = tiles.as_flattened().iter().copied().max().unwrap_or(0);
        let (mut nodes, mut rules) = (Vec::new(), vec![0..0; largest + 1]);
        for (n, rule) in rules.iter_mut().enumerate() {
            if tiles.as_flattened().contains(&n) {
                *rule = nodes.len()..nodes.len() + n;
                nodes.extend(gauss_legendre(n));
            }
        }
        Self { slopes, mus, azimuths, columns, tiles, nodes, rules }
    }

    /// The nodes of both sides, for a tile.
    pub fn tile(&self, alpha_group: usize, column_group: usize) -> [Range<usize>; 2] {
        let tile = self.tiles[alpha_group * self.mus.len().div_ceil(TILE_COLUMNS) + column_group];
        tile.map(|n| self.rules[n].clone())
    }

    /// Tiles, α group by α group.
    pub fn tiles(&self) -> impl Iterator<Item = [Range<usize>; 2]> {
        self.tiles.iter().map(|tile| tile.map(|n| self.rules[n].clone()))
    }

    /// Evaluations of the integrand for the costliest texel.
    pub fn largest_cost(&self) -> usize {
        let nodes = self.tiles.as_flattened().iter().copied().max().unwrap_or(0);
        let azimuths = self.columns.iter().map(|[near, far]| near.len() + far.len()).max().unwrap_or(0);
        (nodes * azimuths).max(1)
    }
}

/// The largest counts over all of (μ, α).
fn most(mus: &[f64], alphas: &[f64], counts: impl Fn(f64, f64) -> [usize; 2]) -> [usize; 2] {
    let all = mus.iter().flat_map(|&mu| alphas.iter().map(move |&alpha| (mu, alpha)));
    all.map(|(mu, alpha)| counts(mu, alpha)).fold([1, 1], |a, b| [a[0].max(b[0]), a[1].max(b[1])])
}

/// Azimuths φ = π/2 ∓ d sinh u of ωm from ωe's, u ∈ [0, asinh(π/2d)]: the horizon turns within μ of
/// φ = π/2. c = tan θe cos φ; t_max = c + √(c² + 1), without cancellation where c < 0.
pub(crate) fn side(mu: f64, sign: f64, n: usize, tolerance: f64) -> impl Iterator<Item = [f64; 4]> {
    // Found by search: smaller wastes nodes on a turn that contributes nothing, larger misses it.
    let d_min = if tolerance < 0.9e-6 { 1e-3 } else { 0.1 };
    let tan = ((1.0 - mu) * (1.0 + mu)).sqrt() / mu;
    let d = mu.max(d_min);
    let u_max = (FRAC_PI_2 / d).asinh();
    gauss_legendre(n).into_iter().map(move |node| {
        let u = u_max * node.x;
        let c = sign * tan * (d * u.sinh()).sin();
        let root = c.hypot(1.0);
        let t_max = if c > 0.0 { c + root } else { 1.0 / (root - c) };
        // dφ/π: both halves of the azimuth, over 2π
        [c, t_max, 1.0 / t_max, node.weight * u_max * d * u.cosh() / PI]
    })
}
