//! The warped rule of microfacet lobes: the azimuths and the node counts of each tile of texels.

use crate::base::quadrature::{Node, gauss_legendre};
use crate::base::tolerance::is_fine;
use crate::model::parameters::Setting;
use crate::model::slope_azimuths::side;
use crate::model::{SlopeCounts, SlopeMap, Slopes};
use std::collections::HashMap;

/// The inner integrals in slopes of ωm, one for each (α, μ).
pub(crate) struct SlopeRule {
    pub slopes: &'static Slopes,
    pub tolerance: f64,
    /// Whether the tolerance is beyond f32: the fine map and its kernel are used then.
    pub is_fine: bool,
    pub mus: Vec<f64>,
    /// The azimuths (μe c, t_max, 1/t_max, weight): for each column of a tile as many as the tile takes, one after the other.
    pub azimuths: Vec<[f64; 4]>,
    /// The nodes of all Gauss–Legendre rules, one rule after the other.
    pub nodes: Vec<Node>,
    /// The two sides of each tile, cos φ > 0 and cos φ < 0, one group of α after the other.
    pub tiles: Vec<[SlopeSide; 2]>,
}

/// The azimuths and nodes of a tile on one side of the horizon, cos φ > 0 or cos φ < 0.
#[derive(Clone, Copy)]
pub(crate) struct SlopeSide {
    /// The first azimuth of the tile's first column.
    pub first_azimuth: usize,
    pub first_node: usize,
    pub counts: SlopeCounts,
}

/// The number of α of a tile, whose texels share their node counts.
pub(crate) const TILE_ALPHAS: usize = 4;
/// The number of μ of a tile.
pub(crate) const TILE_COLUMNS: usize = 8;

impl SlopeRule {
    /// The map of slopes that the tolerance takes.
    pub fn map(&self) -> &'static SlopeMap {
        if self.is_fine { &self.slopes.fine } else { &self.slopes.coarse }
    }

    /// The rule for all (α, μ). Each texel takes `spare` azimuths and nodes more than its tolerance asks for.
    pub fn new(
        slopes: &'static Slopes,
        mus: Vec<f64>,
        settings: &[Setting],
        tolerance: f64,
        spare: usize,
    ) -> Self {
        let (mut azimuths, mut nodes) = (Vec::new(), Vec::new());
        // Each Gauss–Legendre rule that some tile takes, and the first indices of its azimuths and its nodes.
        let mut rules = HashMap::new();
        let (mut azimuths_of, mut nodes_of) = (HashMap::new(), HashMap::new());
        let mut tiles = Vec::new();
        for settings in settings.chunks(TILE_ALPHAS) {
            for (group, mus) in mus.chunks(TILE_COLUMNS).enumerate() {
                let counts = max_counts(mus, settings, |mu, setting| (slopes.counts)(mu, setting, tolerance));
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
                    SlopeSide { first_azimuth, first_node, counts }
                };
                tiles.push([(1.0, counts[0]), (-1.0, counts[1])].map(side));
            }
        }
        Self { slopes, tolerance, is_fine: is_fine(tolerance), mus, azimuths, nodes, tiles }
    }

    /// The azimuths of a texel, and the nodes that each of them takes, on both sides.
    pub fn sides(&self, row: usize, column: usize) -> [(&[[f64; 4]], &[Node]); 2] {
        let groups = self.mus.len().div_ceil(TILE_COLUMNS);
        self.tiles[row / TILE_ALPHAS * groups + column / TILE_COLUMNS].map(|side| {
            let SlopeCounts { azimuths, nodes } = side.counts;
            let first = side.first_azimuth + column % TILE_COLUMNS * azimuths;
            (&self.azimuths[first..][..azimuths], &self.nodes[side.first_node..][..nodes])
        })
    }

    /// The number of evaluations of the integrand for the costliest texel.
    pub fn largest_cost(&self) -> usize {
        self.tiles.iter().map(|tile| cost(*tile)).max().unwrap_or(1)
    }

    /// The number of evaluations of the integrand for all texels of `rows` rows of α.
    #[cfg(feature = "lab")]
    pub fn evaluations(&self, rows: usize) -> usize {
        let groups = self.mus.len().div_ceil(TILE_COLUMNS);
        let filled = |tile: usize, size: usize, all: usize| size.min(all - tile * size);
        let texels = |tile: usize| {
            filled(tile / groups, TILE_ALPHAS, rows) * filled(tile % groups, TILE_COLUMNS, self.mus.len())
        };
        self.tiles.iter().enumerate().map(|(k, tile)| texels(k) * cost(*tile)).sum()
    }
}

/// The number of evaluations of the integrand for a texel of a tile.
fn cost(tile: [SlopeSide; 2]) -> usize {
    tile.map(|side| side.counts.azimuths * side.counts.nodes).iter().sum()
}

/// The largest node counts over all (μ, setting).
fn max_counts(
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
