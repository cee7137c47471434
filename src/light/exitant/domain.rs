//! Where a light comes from: cells of directions, in each of which L is smooth or a block of texels.

use crate::light::exitant::nodes::NODE;
use crate::light::{Disk, Environment, Frame, Light, Radiance, Sky, angles};
use std::borrow::Cow;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The directions that a light comes from, as latitudes and longitudes of the light's frame.
pub(super) struct Domain<'a> {
    shape: DirectionMap<'a>,
    rows: usize,
    columns: usize,
    /// θ from 0 to here.
    end: f64,
}

enum DirectionMap<'a> {
    Map(Cow<'a, Environment>),
    Sky(Sky),
    Disk(&'a Disk, Frame),
}

impl<'a> Domain<'a> {
    /// Rows and columns that cells begin from.
    const BEGIN: [usize; 2] = [32, 64];

    pub fn new(light: &'a Light) -> Self {
        let [rows, columns] = Self::BEGIN;
        let sky = |sky| Self { shape: DirectionMap::Sky(sky), rows, columns, end: PI };
        match light {
            Light::Constant(radiance) => sky(Sky::uniform(*radiance)),
            Light::Sky(gradient) => sky(*gradient),
            Light::Disk(disk) => {
                let (theta, phi) = angles(disk.direction());
                Self {
                    shape: DirectionMap::Disk(disk, Frame::new(theta, phi)),
                    rows: 4,
                    columns: 16,
                    end: disk.radius(),
                }
            }
            Light::Map(map) => {
                let map = map.at_least(columns, rows);
                let (rows, columns) = (map.height(), map.width());
                Self { shape: DirectionMap::Map(map), rows, columns, end: PI }
            }
            // A delta has no extent; `refine` evaluates it by itself.
            Light::Directional(_) => sky(Sky::uniform(Radiance::BLACK)),
        }
    }

    /// The cells that every view begins from.
    pub fn cells(&self) -> Vec<DomainCell> {
        let [down, across] =
            [self.rows.div_ceil(Self::BEGIN[0]), self.columns.div_ceil(Self::BEGIN[1])].map(|n| n.max(1));
        let rows = (0..self.rows).step_by(down).map(|row| [row, (row + down).min(self.rows)]);
        let block = |rows: [usize; 2], columns: [usize; 2]| self.block(rows, columns);
        rows.flat_map(|rows| {
            let columns = (0..self.columns).step_by(across);
            columns.map(move |column| block(rows, [column, (column + across).min(self.columns)]))
        })
        .collect()
    }

    fn block(&self, rows: [usize; 2], columns: [usize; 2]) -> DomainCell {
        DomainCell {
            theta: rows.map(|row| self.end * row as f64 / self.rows as f64),
            psi: columns.map(|column| TAU * column as f64 / self.columns as f64),
            rows: rows.map(|n| n as u32),
            columns: columns.map(|n| n as u32),
            depth: 0,
        }
    }

    pub fn quarters(&self, cell: &DomainCell) -> Vec<DomainCell> {
        let halves = |[a, b]: [u32; 2]| {
            let middle = a + (b - a) / 2;
            if middle == a { vec![[a, b]] } else { vec![[a, middle], [middle, b]] }
        };
        if !cell.is_flat() {
            let columns = halves(cell.columns);
            let of = |rows: [u32; 2]| {
                let wide = |n: [u32; 2]| n.map(|n| n as usize);
                columns.iter().map(move |&columns| self.block(wide(rows), wide(columns))).collect::<Vec<_>>()
            };
            return halves(cell.rows).into_iter().flat_map(of).collect();
        }
        let halves = |[a, b]: [f64; 2]| [[a, 0.5 * (a + b)], [0.5 * (a + b), b]];
        let of =
            |theta| halves(cell.psi).map(|psi| DomainCell { theta, psi, depth: cell.depth + 1, ..*cell });
        halves(cell.theta).into_iter().flat_map(of).collect()
    }

    /// A vector of the domain's frame in the world, or back.
    pub fn to_world(&self, v: [f64; 3]) -> [f64; 3] {
        match &self.shape {
            DirectionMap::Map(map) => map.turn(v),
            DirectionMap::Sky(_) => v,
            DirectionMap::Disk(_, frame) => frame.to_world(v),
        }
    }

    pub fn to_domain(&self, v: [f64; 3]) -> [f64; 3] {
        match &self.shape {
            DirectionMap::Map(map) => map.turn(v),
            DirectionMap::Sky(_) => v,
            DirectionMap::Disk(_, frame) => frame.to_local(v),
        }
    }

    /// L at a cosine of θ, in a cell where it is smooth.
    pub fn radiance(&self, cell: &DomainCell, cos: f64) -> [f64; 3] {
        match &self.shape {
            DirectionMap::Map(map) => {
                map.texel(cell.rows[0] as usize, cell.columns[0] as usize).map(f64::from)
            }
            // The middle decides: borders of cells lie on the horizon.
            DirectionMap::Sky(sky) if cell.theta[0] + cell.theta[1] > PI => sky.ground(),
            DirectionMap::Sky(sky) => {
                std::array::from_fn(|c| sky.horizon()[c] + (sky.zenith()[c] - sky.horizon()[c]) * cos)
            }
            DirectionMap::Disk(disk, _) => disk.radiance(),
        }
    }

    /// L Δω of each texel of a block, as shares of its four nodes.
    pub fn shares(&self, cell: &DomainCell) -> [[f64; 3]; 4] {
        let mut shares = [[0.0; 3]; 4];
        let DirectionMap::Map(map) = &self.shape else { return shares };
        let [rows, columns] = [cell.rows, cell.columns].map(|[a, b]| a as usize..b as usize);
        // The middle of texel k of n, in [−1, 1]; and the two linear functions that are 1 at one node and 0 at the other.
        let hats = |k: usize, n: usize| {
            let x = (2 * k + 1) as f64 / n as f64 - 1.0;
            [0.5 - 0.5 * x / NODE, 0.5 + 0.5 * x / NODE]
        };
        for (i, row) in rows.clone().enumerate() {
            let solid = map.cell(row, 0).solid_angle();
            let down = hats(i, rows.len());
            for (j, column) in columns.clone().enumerate() {
                let across = hats(j, columns.len());
                let texel = map.texel(row, column);
                for (k, share) in shares.iter_mut().enumerate() {
                    let weight = solid * down[k / 2] * across[k % 2];
                    (0..3).for_each(|c| share[c] += weight * f64::from(texel[c]));
                }
            }
        }
        shares
    }
}

/// Some directions of a domain.
#[derive(Debug, Clone, Copy)]
pub(super) struct DomainCell {
    pub theta: [f64; 2],
    pub psi: [f64; 2],
    /// Texels from the first to before the last; of less than one, that one.
    rows: [u32; 2],
    columns: [u32; 2],
    /// How often its texel was halved.
    pub depth: u32,
}

impl DomainCell {
    /// Whether L is smooth in it.
    pub fn is_flat(&self) -> bool {
        self.rows[1] - self.rows[0] == 1 && self.columns[1] - self.columns[0] == 1
    }

    pub fn middle(&self) -> (f64, f64) {
        (0.5 * (self.theta[0] + self.theta[1]), 0.5 * (self.psi[0] + self.psi[1]))
    }

    pub fn half(&self) -> [f64; 2] {
        [0.5 * (self.theta[1] - self.theta[0]), 0.5 * (self.psi[1] - self.psi[0])]
    }

    /// How wide it is at most, rad.
    pub fn size(&self) -> f64 {
        let [t, p] = self.half();
        let sin = self.theta[1].min(PI - self.theta[0]).min(FRAC_PI_2).sin();
        2.0 * t.max(p * sin)
    }
}
