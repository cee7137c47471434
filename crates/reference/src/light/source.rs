//! A light is split into cells of latitude and longitude about a pole of its frame.

use crate::light::{Cell, Light, Map, Sky};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A light with an extent, in cells in each of which L is smooth: a map's texels, a sky on either side of the horizon, the
/// inside of a disk.
pub(super) struct Source<'a> {
    kind: Kind<'a>,
    /// x, y and the pole of its frame, in the world.
    axes: [DVec3; 3],
    rows: usize,
    columns: usize,
    /// θ from 0 to here.
    end: f64,
}

enum Kind<'a> {
    Map(Map<'a>),
    Sky(Sky),
    Disk([f64; 3]),
}

impl<'a> Source<'a> {
    /// Of all lights but one from a single direction, which has no extent.
    pub fn new(light: &Light<'a>) -> Option<Self> {
        let sky = |sky| Self { kind: Kind::Sky(sky), axes: DVec3::AXES, rows: 32, columns: 64, end: PI };
        match light {
            Light::Directional { .. } => None,
            Light::Constant(radiance) => {
                Some(sky(Sky { zenith: *radiance, horizon: *radiance, ground: *radiance }))
            }
            Light::Sky(gradient) => Some(sky(*gradient)),
            Light::Disk(disk) => {
                let pole = DVec3::from(disk.direction);
                let (x, y) = pole.any_orthonormal_pair();
                let kind = Kind::Disk(disk.radiance);
                Some(Self { kind, axes: [x, y, pole], rows: 8, columns: 16, end: disk.radius })
            }
            Light::Map(map) => Some(Self {
                kind: Kind::Map(*map),
                axes: DVec3::AXES,
                rows: map.height(),
                columns: map.width(),
                end: PI,
            }),
        }
    }

    /// All cells.
    pub fn cells(&self) -> impl Iterator<Item = Cell> {
        (0..self.rows).flat_map(move |row| (0..self.columns).map(move |column| self.cell(row, column)))
    }

    fn cell(&self, row: usize, column: usize) -> Cell {
        if let Kind::Map(map) = self.kind {
            return map.cell(row, column);
        }
        let part = |k: usize, of: usize, whole: f64| [k, k + 1].map(|k| whole * k as f64 / of as f64);
        let theta = part(row, self.rows, self.end);
        Cell { row, column, theta, phi: part(column, self.columns, TAU) }
    }

    /// L at θ of a cell, R, G, B.
    pub fn radiance(&self, cell: &Cell, theta: f64) -> [f64; 3] {
        match &self.kind {
            Kind::Map(map) => map.texel(cell.row, cell.column),
            Kind::Disk(radiance) => *radiance,
            // Cells end at the horizon.
            Kind::Sky(sky) if cell.theta[0] + cell.theta[1] > 2.0 * FRAC_PI_2 => sky.ground,
            Kind::Sky(sky) => {
                let cos = theta.cos();
                std::array::from_fn(|c| sky.zenith[c] * cos + sky.horizon[c] * (1.0 - cos))
            }
        }
    }

    /// What all cells together may be off, for each of them. Errors of a map's texels have no common sign and add up as
    /// their squares; those of a smooth light may have.
    pub fn share(&self, whole: f64) -> f64 {
        let cells = (self.rows * self.columns) as f64;
        if matches!(self.kind, Kind::Map(_)) { whole / cells.sqrt() } else { whole / cells }
    }

    /// A vector of the world in its frame.
    pub fn to_local(&self, world: [f64; 3]) -> DVec3 {
        let world = DVec3::from(world);
        DVec3::from(self.axes.map(|axis| axis.dot(world)))
    }

    /// A vector of its frame in the world.
    pub fn to_world(&self, local: DVec3) -> DVec3 {
        local.x * self.axes[0] + local.y * self.axes[1] + local.z * self.axes[2]
    }
}

/// The unit vector at (θ, φ).
pub(super) fn unit_vector(theta: f64, phi: f64) -> DVec3 {
    let ((st, ct), (sp, cp)) = (theta.sin_cos(), phi.sin_cos());
    DVec3::new(st * cp, st * sp, ct)
}

/// Gauss–Legendre of three nodes on [−1, 1] (Abramowitz & Stegun 1964, table 25.4).
pub(super) const GAUSS: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];
