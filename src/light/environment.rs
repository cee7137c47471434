//! Environment maps: piecewise-constant radiance over cells of latitude and longitude.

use crate::base::error::{Error, Result};
use crate::base::radiometry::DirectionCell;
use std::borrow::Cow;
use std::f64::consts::{PI, TAU};

/// An environment map: the function that is constant over each texel's cell, with the cell's exact solid angle.
///
/// As OpenEXR's LatLong maps have it (OpenEXR, "Technical Introduction", environment maps), latitude falls from the zenith
/// at the top to the nadir at the bottom, and longitude from π at the left to −π at the right: seen from inside,
/// nothing is mirrored. +x is in the middle, +y a quarter of the width to its left.
#[derive(Debug, Clone, PartialEq)]
pub struct Environment {
    width: usize,
    height: usize,
    /// R, G, B, row by row from the top.
    texels: Vec<[f32; 3]>,
    /// The rotation about the zenith, from +x towards +y, rad.
    rotation: f64,
}

/// The most texels of a map: 400 MiB in memory.
pub const MAX_TEXELS: usize = 1 << 25;

/// The most columns, or rows.
const MAX_SIDE: usize = 1 << 16;

/// The texels of a map that were no radiance and were replaced: their number, and the first in words.
#[derive(Debug, Clone, PartialEq, Eq, Default, serde::Serialize)]
pub struct Clamped {
    /// Texels with a channel that is no radiance.
    pub texels: usize,
    /// "row 3, column 7: R is NaN".
    pub first: Option<String>,
}

impl Environment {
    /// Builds a map of `width` columns and `height` rows.
    ///
    /// # Errors
    /// When the counts do not fit, or a texel is no radiance: negative, infinite or NaN.
    pub fn new(width: usize, height: usize, texels: Vec<[f32; 3]>) -> Result<Self> {
        Self::checked(width, height, texels, "clamp it")
    }

    /// Builds a map, or refuses it with a message that ends in this remedy.
    pub(super) fn checked(width: usize, height: usize, texels: Vec<[f32; 3]>, remedy: &str) -> Result<Self> {
        let map = Self::unchecked(width, height, texels)?;
        match map.faults() {
            Clamped { first: Some(first), texels } => Err(Error::input(format!(
                "{first}, and so {texels} of {} texels are no radiance; mend the map, or {remedy}",
                map.texels.len()
            ))),
            _ => Ok(map),
        }
    }

    /// Builds a map, replacing negative and NaN texels by 0, and infinite ones by the largest finite value.
    ///
    /// # Errors
    /// When the counts do not fit.
    pub fn clamped(width: usize, height: usize, texels: Vec<[f32; 3]>) -> Result<(Self, Clamped)> {
        let mut map = Self::unchecked(width, height, texels)?;
        let faults = map.faults();
        if faults.texels > 0 {
            let finite = map.texels.as_flattened().iter().filter(|x| x.is_finite());
            let largest = finite.copied().fold(0.0, f32::max);
            for x in map.texels.as_flattened_mut() {
                *x = if x.is_nan() { 0.0 } else { x.clamp(0.0, largest) };
            }
        }
        Ok((map, faults))
    }

    fn unchecked(width: usize, height: usize, texels: Vec<[f32; 3]>) -> Result<Self> {
        check_size(width, height)?;
        if width * height != texels.len() {
            return Err(Error::input(format!(
                "{} texels for {width} columns and {height} rows; give {}",
                texels.len(),
                width * height
            )));
        }
        Ok(Self { width, height, texels, rotation: 0.0 })
    }

    /// Counts the texels that are no radiance.
    fn faults(&self) -> Clamped {
        // −0 is 0.
        let fault = |x: &f32| !x.is_finite() || *x < 0.0;
        let mut faults = Clamped::default();
        for (k, texel) in self.texels.iter().enumerate() {
            let Some(channel) = texel.iter().position(fault) else { continue };
            faults.texels += 1;
            if faults.first.is_none() {
                let [row, column] = [k / self.width, k % self.width];
                let name = ["R", "G", "B"][channel];
                faults.first = Some(format!("row {row}, column {column}: {name} is {:?}", texel[channel]));
            }
        }
        faults
    }

    /// Rotates the map about the zenith, from +x towards +y, rad.
    pub fn rotated(self, by: f64) -> Self {
        Self { rotation: (self.rotation + by).rem_euclid(TAU), ..self }
    }

    /// Columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The rotation about the zenith, rad.
    pub fn rotation(&self) -> f64 {
        self.rotation
    }

    /// The texels, row by row from the top.
    pub fn texels(&self) -> &[[f32; 3]] {
        &self.texels
    }

    /// A texel.
    pub fn texel(&self, row: usize, column: usize) -> [f32; 3] {
        self.texels[row * self.width + column]
    }

    /// Returns θ of the upper border of a row; `height` gives the nadir.
    pub fn theta(&self, row: usize) -> f64 {
        PI * row as f64 / self.height as f64
    }

    /// Returns the longitude from the map's left edge to the left border of a column, rad. It rises with columns.
    pub(crate) fn psi(&self, column: usize) -> f64 {
        TAU * column as f64 / self.width as f64
    }

    /// Returns the cell of a texel in the world. Its azimuths rise while columns fall.
    pub fn cell(&self, row: usize, column: usize) -> DirectionCell {
        let phi = |column: usize| PI + self.rotation - self.psi(column);
        DirectionCell { theta: [self.theta(row), self.theta(row + 1)], phi: [phi(column + 1), phi(column)] }
    }

    /// Returns L from a direction of the world, a unit vector: the texel whose cell contains it.
    pub fn radiance(&self, direction: [f64; 3]) -> [f64; 3] {
        let (theta, psi) = crate::light::angles(self.turn(direction));
        let row = (theta / PI * self.height as f64) as usize;
        let column = (psi.rem_euclid(TAU) / TAU * self.width as f64) as usize;
        self.texel(row.min(self.height - 1), column.min(self.width - 1)).map(f64::from)
    }

    /// Transforms a vector between the world and the map's frame, whose azimuth is [`Environment::psi`]: ψ = π + rotation − φ, a reflection, which is its own inverse.
    pub(crate) fn turn(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let (sin, cos) = self.rotation.sin_cos();
        [-(cos * x + sin * y), -sin * x + cos * y, z]
    }

    /// Repeats texels until the map has at least this many columns and rows. It stays the same function.
    pub(crate) fn at_least(&self, width: usize, height: usize) -> Cow<'_, Self> {
        let [across, down] = [width.div_ceil(self.width), height.div_ceil(self.height)];
        if across <= 1 && down <= 1 {
            return Cow::Borrowed(self);
        }
        let rows = self.texels.chunks_exact(self.width);
        let texels = rows.flat_map(|row| {
            let wide: Vec<_> = row.iter().flat_map(|&texel| std::iter::repeat_n(texel, across)).collect();
            std::iter::repeat_n(wide, down).flatten()
        });
        let texels = texels.collect();
        let (width, height) = (self.width * across, self.height * down);
        Cow::Owned(Self { width, height, texels, rotation: self.rotation })
    }

    /// Averages the map down to at most this many columns and rows, weighted by solid angle: another function, for
    /// pictures.
    pub fn reduced(&self, width: usize, height: usize) -> Self {
        let [across, down] = [self.width.div_ceil(width), self.height.div_ceil(height)];
        let [columns, rows] = [self.width.div_ceil(across), self.height.div_ceil(down)];
        let mut sums = vec![[0.0f64; 4]; columns * rows];
        for row in 0..self.height {
            let weight = self.cell(row, 0).solid_angle();
            for column in 0..self.width {
                let sum = &mut sums[row / down * columns + column / across];
                let texel = self.texel(row, column).map(f64::from);
                (0..3).for_each(|c| sum[c] += weight * texel[c]);
                sum[3] += weight;
            }
        }
        // If the counts do not divide, the last cells are narrower; pictures ignore that.
        let texels = sums.iter().map(|[r, g, b, weight]| [r, g, b].map(|x| (x / weight) as f32)).collect();
        Self { width: columns, height: rows, texels, rotation: self.rotation }
    }

    /// ∫ L dω over all directions, W m⁻².
    pub fn total(&self) -> [f64; 3] {
        let mut total = [0.0; 3];
        for (row, texels) in self.texels.chunks_exact(self.width).enumerate() {
            let weight = self.cell(row, 0).solid_angle();
            (0..3).for_each(|c| total[c] += weight * texels.iter().map(|t| f64::from(t[c])).sum::<f64>());
        }
        total
    }
}

/// Refuses a map that has no texels, or too many.
pub(super) fn check_size(width: usize, height: usize) -> Result<()> {
    if width == 0 || height == 0 {
        return Err(Error::input(format!("{width} × {height} texels; a map has at least one")));
    }
    if width.max(height) > MAX_SIDE {
        return Err(Error::input(format!(
            "{width} × {height} texels, and rows and columns have at most {MAX_SIDE}; give a map that is twice as wide as high"
        )));
    }
    if width.checked_mul(height).is_none_or(|texels| texels > MAX_TEXELS) {
        return Err(Error::input(format!(
            "{width} × {height} texels, more than the {MAX_TEXELS} that are read; give a map of 8192 × 4096 at most"
        )));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::{direction, dot};

    fn map() -> Environment {
        let texels = (0..32).map(|k| [k as f32, 1.0, 0.5]).collect();
        Environment::new(8, 4, texels).unwrap().rotated(0.7)
    }

    #[test]
    fn a_texel_is_where_its_cell_is() {
        let map = map();
        for (row, column) in [(0, 0), (1, 3), (3, 7), (2, 5)] {
            let cell = map.cell(row, column);
            let middle = |[a, b]: [f64; 2]| 0.5 * (a + b);
            let towards = direction(middle(cell.theta), middle(cell.phi));
            assert_eq!(map.radiance(towards), map.texel(row, column).map(f64::from));
        }
    }

    /// Unturned, +x is in the middle, between columns 3 and 4, and +y to its left, between 1 and 2.
    #[test]
    fn seen_from_inside_nothing_is_mirrored() {
        let map = Environment { rotation: 0.0, ..map() };
        let column = |v: [f64; 3]| map.radiance(v)[0] % 8.0;
        assert_eq!(column(direction(1.5, 0.1)), 3.0);
        assert_eq!(column(direction(1.5, -0.1)), 4.0);
        assert_eq!(column([0.1, 1.0, 0.0]), 2.0);
        assert_eq!(column([0.1, -1.0, 0.0]), 5.0);
    }

    #[test]
    fn turning_twice_is_not_turning() {
        let map = map();
        let v = direction(1.1, 2.3);
        let back = map.turn(map.turn(v));
        assert!((dot(v, back) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn the_same_function_on_a_finer_grid() {
        let map = map();
        let fine = map.at_least(20, 9);
        assert_eq!((fine.width, fine.height), (24, 12));
        for k in 0..100 {
            let v = direction(0.03 * f64::from(k), 0.61 * f64::from(k));
            assert_eq!(map.radiance(v), fine.radiance(v));
        }
        let [a, b] = [map.total()[0], fine.total()[0]];
        assert!((a - b).abs() < 1e-12 * a);
        let coarse = map.reduced(4, 2).total()[0];
        assert!((coarse - a).abs() < 1e-6 * a, "means keep the total");
    }

    #[test]
    fn what_is_no_radiance_is_refused_by_its_place() {
        let mut texels = vec![[1.0f32; 3]; 8];
        texels[6][1] = f32::NAN;
        texels[7][2] = f32::INFINITY;
        let why = Environment::new(4, 2, texels.clone()).unwrap_err().to_string();
        assert!(why.contains("row 1, column 2: G is NaN") && why.contains("2 of 8"), "{why}");
        let (map, faults) = Environment::clamped(4, 2, texels).unwrap();
        assert_eq!(faults.texels, 2);
        assert_eq!((map.texel(1, 2), map.texel(1, 3)), ([1.0, 0.0, 1.0], [1.0; 3]));
        assert!(Environment::new(4, 2, vec![[-1.0, 0.0, 0.0]; 8]).is_err());
        assert!(Environment::new(3, 2, vec![[0.0; 3]; 8]).is_err());
        assert!(Environment::new(0, 2, vec![]).is_err());
    }
}
