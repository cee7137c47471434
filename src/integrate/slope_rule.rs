//! The warped rule of microfacet lobes: which azimuths and how many nodes for each tile of texels.

use crate::base::quadrature::{Node, gauss_legendre};
use crate::model::parameters::Setting;
use crate::model::slope_azimuths::side;
use crate::model::{SlopeCounts, Slopes};
use std::collections::HashMap;

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
    #[cfg(feature = "lab")]
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
