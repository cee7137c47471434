//! The warped rule of microfacet lobes: which azimuths and how many nodes for each tile of texels.

use crate::models::{SlopeCounts, Slopes, is_fine};
use crate::quadrature::{Node, gauss_legendre};
use crate::setting::Setting;
use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_2, PI};

/// Inner integrals in slopes of ωm, for each (α, μ).
pub(crate) struct SlopeWork {
    pub slopes: &'static Slopes,
    pub tolerance: f64,
    pub mus: Vec<f64>,
    /// (μe c, t_max, 1/t_max, weight): for each column of a tile as many as the tile takes, one after the other.
    pub azimuths: Vec<[f64; 4]>,
    /// Gauss–Legendre rules, one after the other.
    pub nodes: Vec<Node>,
    /// α group by α group, what the tiles take where cos φ > 0 and where it is < 0.
    pub tiles: Vec<[Side; 2]>,
}

/// Half of the azimuths of a tile.
#[derive(Clone, Copy)]
pub(crate) struct Side {
    /// Of the tile's first column.
    pub first_azimuth: usize,
    pub first_node: usize,
    pub counts: SlopeCounts,
}

/// Texels that share their counts: so many α …
pub(crate) const TILE_ALPHAS: usize = 4;
/// … times so many μ.
pub(crate) const TILE_COLUMNS: usize = 8;

impl SlopeWork {
    /// Each texel takes `spare` azimuths and nodes more than its tolerance asks for.
    pub fn new(
        slopes: &'static Slopes,
        mus: Vec<f64>,
        settings: &[Setting],
        tolerance: f64,
        spare: usize,
    ) -> Self {
        let (mut azimuths, mut nodes) = (Vec::new(), Vec::new());
        // Each rule that some tile takes, and where its azimuths and its nodes are.
        let mut rules = HashMap::new();
        let (mut azimuths_of, mut nodes_of) = (HashMap::new(), HashMap::new());
        let mut tiles = Vec::new();
        for settings in settings.chunks(TILE_ALPHAS) {
            for (group, mus) in mus.chunks(TILE_COLUMNS).enumerate() {
                let counts = most(mus, settings, |mu, setting| (slopes.counts)(mu, setting, tolerance));
                let counts = counts.map(|SlopeCounts { azimuths, nodes }| SlopeCounts {
                    azimuths: azimuths + spare,
                    nodes: nodes + spare,
                });
                let side = |(sign, counts): (f64, SlopeCounts)| {
                    let first_azimuth = azimuths_of.entry((group, sign > 0.0, counts.azimuths));
                    let first_azimuth = *first_azimuth.or_insert_with(|| {
                        let first = azimuths.len();
                        let rule = rules.entry(counts.azimuths).or_insert_with_key(|&n| gauss_legendre(n));
                        azimuths.extend(mus.iter().flat_map(|&mu| side(mu, sign, rule, tolerance)));
                        first
                    });
                    let first_node = *nodes_of.entry(counts.nodes).or_insert_with(|| {
                        let first = nodes.len();
                        nodes.extend(
                            rules.entry(counts.nodes).or_insert_with_key(|&n| gauss_legendre(n)).iter(),
                        );
                        first
                    });
                    Side { first_azimuth, first_node, counts }
                };
                tiles.push([(1.0, counts[0]), (-1.0, counts[1])].map(side));
            }
        }
        Self { slopes, tolerance, mus, azimuths, nodes, tiles }
    }

    /// What a texel takes, on both sides: azimuths, and the nodes of each.
    pub fn sides(&self, row: usize, column: usize) -> [(&[[f64; 4]], &[Node]); 2] {
        let groups = self.mus.len().div_ceil(TILE_COLUMNS);
        self.tiles[row / TILE_ALPHAS * groups + column / TILE_COLUMNS].map(|side| {
            let SlopeCounts { azimuths, nodes } = side.counts;
            let first = side.first_azimuth + column % TILE_COLUMNS * azimuths;
            (&self.azimuths[first..][..azimuths], &self.nodes[side.first_node..][..nodes])
        })
    }

    /// Evaluations of the integrand for the costliest texel.
    pub fn largest_cost(&self) -> usize {
        self.tiles.iter().map(|tile| cost(*tile)).max().unwrap_or(1)
    }

    /// Evaluations of the integrand for so many rows of α.
    pub fn evaluations(&self, rows: usize) -> usize {
        let groups = self.mus.len().div_ceil(TILE_COLUMNS);
        let share = |first: usize, of: usize, all: usize| of.min(all - first * of);
        let texels = |tile: usize| {
            share(tile / groups, TILE_ALPHAS, rows) * share(tile % groups, TILE_COLUMNS, self.mus.len())
        };
        self.tiles.iter().enumerate().map(|(k, tile)| texels(k) * cost(*tile)).sum()
    }
}

/// Evaluations of the integrand for a texel of a tile.
fn cost(tile: [Side; 2]) -> usize {
    tile.map(|side| side.counts.azimuths * side.counts.nodes).iter().sum()
}

/// The largest counts over all of them.
fn most(
    mus: &[f64],
    settings: &[Setting],
    counts: impl Fn(f64, &Setting) -> [SlopeCounts; 2],
) -> [SlopeCounts; 2] {
    let all = mus.iter().flat_map(|&mu| settings.iter().map(move |setting| (mu, setting)));
    let one = SlopeCounts { azimuths: 1, nodes: 1 };
    all.map(|(mu, setting)| counts(mu, setting)).fold([one; 2], |a, b| {
        [0, 1].map(|k| SlopeCounts {
            azimuths: a[k].azimuths.max(b[k].azimuths),
            nodes: a[k].nodes.max(b[k].nodes),
        })
    })
}

/// An azimuth φ of ωm from that of ωe, and the horizon of ωi there.
pub(crate) struct Turn {
    pub sin: f64,
    pub cos: f64,
    /// tan θe cos φ
    pub c: f64,
    /// tan θm of the normal that reflects ωe onto the horizon.
    pub t_max: f64,
    /// dφ/2π, of all azimuths that it stands for: where one half mirrors the other, dφ/π.
    pub weight: f64,
}

impl Turn {
    /// t_max = c + √(c² + 1), without cancellation where c < 0.
    pub fn new(tan: f64, [cos, sin]: [f64; 2], weight: f64) -> Self {
        let c = tan * cos;
        let root = c.hypot(1.0);
        let t_max = if c > 0.0 { c + root } else { 1.0 / (root - c) };
        Self { sin, cos, c, t_max, weight }
    }
}

/// Azimuths φ = π/2 ∓ d sinh u of ωm from ωe's, u ∈ [0, asinh(π/2d)]: the horizon turns within μ of
/// φ = π/2.
pub(crate) fn turns(mu: f64, sign: f64, rule: &[Node], d: f64) -> impl Iterator<Item = Turn> {
    let tan = ((1.0 - mu) * (1.0 + mu)).sqrt() / mu;
    let u_max = (FRAC_PI_2 / d).asinh();
    rule.iter().map(move |node| {
        let u = u_max * node.x;
        let (sin_turned, cos_turned) = (d * u.sinh()).sin_cos();
        Turn::new(tan, [sign * sin_turned, cos_turned], node.weight * u_max * d * u.cosh() / PI)
    })
}

/// u/u_max of the azimuth where tan θe cos φ is c > 0, if there is one.
pub(crate) fn turn_of(mu: f64, c: f64, d: f64) -> Option<f64> {
    let cos = c * mu / ((1.0 - mu) * (1.0 + mu)).sqrt();
    (cos < 1.0).then(|| (cos.asin() / d).asinh() / (FRAC_PI_2 / d).asinh())
}

/// d for the kernel. Found by search: smaller wastes nodes on a turn that contributes nothing, larger misses it.
pub(crate) fn turn_scale(mu: f64, tolerance: f64) -> f64 {
    mu.max(if is_fine(tolerance) { 1e-3 } else { 0.1 })
}

/// [`turns`] as the kernel takes them: (μe c, t_max, 1/t_max, weight).
pub(crate) fn side(mu: f64, sign: f64, rule: &[Node], tolerance: f64) -> impl Iterator<Item = [f64; 4]> {
    turns(mu, sign, rule, turn_scale(mu, tolerance))
        .map(move |turn| [mu * turn.c, turn.t_max, 1.0 / turn.t_max, turn.weight])
}
