//! Environment maps in latitude and longitude.

use crate::light::Cell;
use std::f64::consts::{PI, TAU};

/// An environment map. Each texel's radiance fills its cell.
///
/// OpenEXR (*Technical Introduction*, LatLong environment maps; `ImfEnvmap.h`): latitude falls from π/2 at the top border
/// to −π/2 at the bottom one, and longitude from π at the left border to −π at the right one. Latitude π/2 is up, longitude 0 is
/// forward, and longitude π/2 a quarter turn from there. With up = z and forward = x, that is θ = π/2 − latitude and
/// φ = longitude.
#[derive(Debug, Clone, Copy)]
pub struct Map<'a> {
    width: usize,
    height: usize,
    texels: &'a [[f32; 3]],
    rotation: f64,
}

impl<'a> Map<'a> {
    /// A map of so many columns and rows, its texels row by row from the top, turned about the zenith by an angle from +x
    /// towards +y, rad. `None` when the counts do not fit.
    pub fn new(width: usize, height: usize, texels: &'a [[f32; 3]], rotation: f64) -> Option<Self> {
        let fits = width > 0 && height > 0 && width.checked_mul(height) == Some(texels.len());
        fits.then_some(Self { width, height, texels, rotation })
    }

    pub(super) fn width(&self) -> usize {
        self.width
    }

    pub(super) fn height(&self) -> usize {
        self.height
    }

    /// L of a texel.
    pub(super) fn texel(&self, row: usize, column: usize) -> [f64; 3] {
        self.texels[row * self.width + column].map(f64::from)
    }

    /// θ of the border above a row: π/2 less its latitude π/2 − π row/height.
    pub(super) fn theta(&self, row: usize) -> f64 {
        PI * row as f64 / self.height as f64
    }

    /// φ of the border to the left of a column: its longitude π − 2π column/width in the map, which is turned.
    fn phi(&self, column: usize) -> f64 {
        PI + self.rotation - TAU * column as f64 / self.width as f64
    }

    /// What a texel fills. φ falls from column to column.
    pub(super) fn cell(&self, row: usize, column: usize) -> Cell {
        let phi = [self.phi(column + 1), self.phi(column)];
        Cell { row, column, theta: [self.theta(row), self.theta(row + 1)], phi }
    }

    /// L of every texel whose cell has the direction (θ, φ) in it or within `slack`, rad, of its border.
    pub(super) fn radiances(&self, theta: f64, phi: f64, slack: f64) -> Vec<[f64; 3]> {
        let mut found = Vec::new();
        for row in 0..self.height {
            let [top, bottom] = [self.theta(row), self.theta(row + 1)];
            if !(top - slack..=bottom + slack).contains(&theta) {
                continue;
            }
            // At a pole every azimuth is near.
            let around = if theta.sin() > slack { slack / theta.sin() } else { TAU };
            for column in 0..self.width {
                let [first, last] = self.cell(row, column).phi;
                let turn = (phi - first).rem_euclid(TAU);
                if turn <= last - first + around || turn >= TAU - around {
                    found.push(self.texel(row, column));
                }
            }
        }
        found
    }

    /// ∫ L dω, the largest channel's: a scale for tolerances.
    pub(super) fn scale(&self) -> f64 {
        let mut total = [0.0; 3];
        for row in 0..self.height {
            // (cos θ₀ − cos θ₁) Δφ
            let (middle, half) =
                (0.5 * (self.theta(row) + self.theta(row + 1)), 0.5 * PI / self.height as f64);
            let solid_angle = 2.0 * middle.sin() * half.sin() * TAU / self.width as f64;
            for column in 0..self.width {
                let texel = self.texel(row, column);
                (0..3).for_each(|c| total[c] += solid_angle * texel[c]);
            }
        }
        total.into_iter().fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Forward (+x) is in the middle, longitude π/2 (+y) a quarter of the width to its left, up is the first row.
    #[test]
    fn directions_are_where_openexr_has_them() {
        let texels: Vec<_> = (0..32).map(|k| [k as f32; 3]).collect();
        let map = Map::new(8, 4, &texels, 0.0).unwrap();
        let texel = |theta: f64, phi: f64| {
            let found = map.radiances(theta, phi, 0.0);
            assert_eq!(found.len(), 1, "{theta}, {phi}");
            found[0][0] as usize
        };
        assert_eq!(texel(1.5, 0.1), 8 + 3);
        assert_eq!(texel(1.5, -0.1), 8 + 4);
        assert_eq!(texel(1.5, PI / 2.0 + 0.1), 8 + 1);
        assert_eq!(texel(1.5, -PI / 2.0 - 0.1), 8 + 6);
        assert_eq!(texel(0.1, PI - 0.1), 0);
        assert_eq!(texel(3.1, -PI + 0.1), 24 + 7);
        // Turned by a column from +x towards +y, what was at φ is at φ + π/4.
        let turned = Map::new(8, 4, &texels, PI / 4.0).unwrap();
        assert_eq!(turned.radiances(1.5, 0.1 + PI / 4.0, 0.0), map.radiances(1.5, 0.1, 0.0));
        assert_eq!(map.radiances(1.5, 0.0, 1e-9).len(), 2, "a border has both its texels");
        assert_eq!(map.radiances(0.0, 0.0, 1e-9).len(), 8, "a pole has a whole row");
        assert!(Map::new(8, 4, &texels[1..], 0.0).is_none());
    }
}
