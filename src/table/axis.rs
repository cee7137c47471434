//! Axes: the variable that a table runs over and where its samples lie.

use crate::base::error::{Error, Result};
use serde::Serialize;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A variable that a table can have as an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Variable {
    /// Perceptual roughness r ∈ [0, 1]; α = r².
    Roughness,
    /// μ = cos θe ∈ [0, 1].
    Mu,
    /// θi ∈ [0, π/2], rad: zenith angle of incidence.
    ThetaI,
    /// θe ∈ [0, π/2], rad: zenith angle of exitance.
    ThetaE,
    /// δφ = φe − φi − π, rad; 0 is the mirror direction. Isotropic tables use [0, π].
    DeltaPhi,
    /// φi ∈ [0, 2π], rad: azimuth of incidence from the tangent. Where an integral keeps ωe, its azimuth is φe.
    PhiI,
    /// φe ∈ [0, 2π], rad: azimuth of exitance from the tangent.
    PhiE,
    /// θn ∈ [0, π], rad: zenith angle of a surface's normal in the world.
    ThetaN,
    /// φn ∈ [0, 2π], rad: azimuth of a surface's normal in the world.
    PhiN,
    /// The index l(l+1) + m of a spherical harmonic of the first three bands.
    Harmonic,
}

impl Variable {
    /// All variables.
    pub const ALL: [Self; 10] = [
        Self::Roughness,
        Self::Mu,
        Self::ThetaI,
        Self::ThetaE,
        Self::DeltaPhi,
        Self::PhiI,
        Self::PhiE,
        Self::ThetaN,
        Self::PhiN,
        Self::Harmonic,
    ];

    /// The zenith angle that a value of a direction's θ or μ stands for.
    pub(crate) fn zenith(self, value: f64) -> f64 {
        if self == Self::Mu { value.acos() } else { value }
    }

    /// The cosine of the zenith angle that a value of a direction's θ or μ stands for.
    #[cfg(feature = "check")]
    pub(crate) fn cosine(self, value: f64) -> f64 {
        if self == Self::Mu { value } else { value.cos() }
    }

    /// The name in recipes, files and manifests.
    pub fn name(self) -> &'static str {
        match self {
            Self::Roughness => "roughness",
            Self::Mu => "mu",
            Self::ThetaI => "theta_i",
            Self::ThetaE => "theta_e",
            Self::DeltaPhi => "delta_phi",
            Self::PhiI => "phi_i",
            Self::PhiE => "phi_e",
            Self::ThetaN => "theta_n",
            Self::PhiN => "phi_n",
            Self::Harmonic => "harmonic",
        }
    }

    /// The symbol in print.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Roughness => "roughness",
            Self::Mu => "μ = cos θ",
            Self::ThetaI => "θi",
            Self::ThetaE => "θe",
            Self::DeltaPhi => "δφ",
            Self::PhiI => "φi",
            Self::PhiE => "φe",
            Self::ThetaN => "θn",
            Self::PhiN => "φn",
            Self::Harmonic => "l(l+1) + m",
        }
    }

    /// `rad`, or `1` for a pure number.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Roughness | Self::Mu | Self::Harmonic => "1",
            _ => "rad",
        }
    }

    /// The default range of an axis, which is also the widest it may take.
    pub fn natural_range(self) -> [f64; 2] {
        match self {
            Self::Roughness | Self::Mu => [0.0, 1.0],
            Self::ThetaI | Self::ThetaE => [0.0, FRAC_PI_2],
            Self::DeltaPhi => [0.0, PI],
            Self::PhiI | Self::PhiE | Self::PhiN => [0.0, TAU],
            Self::ThetaN => [0.0, PI],
            Self::Harmonic => [0.0, 8.0],
        }
    }

    /// The default positions of samples: angles lie on nodes, so that the specular peak is
    /// sampled; μ, roughness and normals lie on texel centres, as samplers read them.
    pub fn natural_positions(self) -> Positions {
        match self {
            Self::Roughness | Self::Mu | Self::ThetaN | Self::PhiN => Positions::Centers,
            _ => Positions::Nodes,
        }
    }
}

/// The positions of an axis's samples in its unit interval u ∈ [0, 1].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Positions {
    /// u = k / (n − 1): both ends included.
    Nodes,
    /// u = (k + ½) / n: texel centres.
    Centers,
    /// Listed one by one.
    Values,
}

/// The mapping of the unit interval to the range [a, b].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Mapping {
    /// value = a + (b − a) u
    Linear,
    /// value = a + (b − a) u²: a reader finds u as a square root.
    Sqrt,
}

/// One axis of a table: a variable and the values it takes, strictly increasing.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    variable: Variable,
    mapping: Mapping,
    positions: Positions,
    range: [f64; 2],
    values: Vec<f64>,
}

/// The largest number of samples of an axis: one row must fit a device buffer with room to spare.
pub(crate) const MAX_COUNT: usize = 1 << 20;

impl Axis {
    /// Makes an axis of `count` samples over the natural range, at the natural positions (see [`Variable`]).
    pub fn natural(variable: Variable, count: usize) -> Result<Self> {
        Self::new(variable, count, variable.natural_range(), variable.natural_positions(), Mapping::Linear)
    }

    /// Makes an axis of `count` samples over `range`.
    ///
    /// # Errors
    /// When the range is empty, reversed, not finite or wider than the variable's natural range,
    /// or when the count is 0, above 2²⁰, or 1 on nodes of a range that is not one point.
    pub fn new(
        variable: Variable,
        count: usize,
        range: [f64; 2],
        positions: Positions,
        mapping: Mapping,
    ) -> Result<Self> {
        let name = variable.name();
        let [a, b] = range;
        check_inside(variable, a)?;
        check_inside(variable, b)?;
        if a > b {
            return Err(Error::input(format!("{name}: the range [{a}, {b}] is reversed")));
        }
        if count == 0 || count > MAX_COUNT {
            return Err(Error::input(format!("{name}: {count} samples; give 1 to {MAX_COUNT}")));
        }
        if a == b && count > 1 {
            return Err(Error::input(format!(
                "{name}: {count} samples over the single point {a}; give values = [{a}]"
            )));
        }
        if count == 1 && a < b && positions == Positions::Nodes {
            return Err(Error::input(format!(
                "{name}: one node cannot have both ends of [{a}, {b}]; give values = [x], or 2 or more"
            )));
        }
        let n = count as f64;
        let values = (0..count)
            .map(|k| {
                let u = match positions {
                    Positions::Nodes if count == 1 => 0.0,
                    Positions::Nodes => k as f64 / (n - 1.0),
                    Positions::Centers => (k as f64 + 0.5) / n,
                    Positions::Values => {
                        return Err(Error::input(format!("{name}: positions \"values\" need a list")));
                    }
                };
                let u = if mapping == Mapping::Sqrt { u * u } else { u };
                // Exact at both ends, so that 90° is 90°.
                Ok(if u == 1.0 { b } else { a + (b - a) * u })
            })
            .collect::<Result<Vec<_>>>()?;
        Ok(Self { variable, mapping, positions, range, values })
    }

    /// Makes an axis of listed values, strictly increasing.
    pub fn listed(variable: Variable, values: Vec<f64>) -> Result<Self> {
        let name = variable.name();
        let (Some(&a), Some(&b)) = (values.first(), values.last()) else {
            return Err(Error::input(format!("{name}: the list of values is empty")));
        };
        for &value in &values {
            check_inside(variable, value)?;
        }
        if let Some(k) = values.windows(2).position(|pair| pair[0] >= pair[1]) {
            return Err(Error::input(format!(
                "{name}: values must increase, but {} is followed by {}",
                values[k],
                values[k + 1]
            )));
        }
        if values.len() > MAX_COUNT {
            return Err(Error::input(format!("{name}: {} values; give 1 to {MAX_COUNT}", values.len())));
        }
        Ok(Self { variable, mapping: Mapping::Linear, positions: Positions::Values, range: [a, b], values })
    }

    /// The variable that the axis samples.
    pub fn variable(&self) -> Variable {
        self.variable
    }

    /// The mapping of u ∈ [0, 1] to a value.
    pub fn mapping(&self) -> Mapping {
        self.mapping
    }

    /// The positions of the samples in u.
    pub fn positions(&self) -> Positions {
        self.positions
    }

    /// The range [a, b] that u = 0 and u = 1 stand for.
    pub fn range(&self) -> [f64; 2] {
        self.range
    }

    /// The values, in the variable's unit, strictly increasing unless a target reversed them.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The axis with another number of samples over the same range.
    ///
    /// # Errors
    /// The errors of [`Axis::new`]; listed values have no other count.
    pub fn with_count(&self, count: usize) -> Result<Self> {
        Self::new(self.variable, count, self.range, self.positions, self.mapping)
    }

    #[cfg(feature = "check")]
    /// The axis at some values within its range, which need not increase: for comparisons, not for tables that are baked.
    pub(crate) fn at_values(&self, values: Vec<f64>) -> Self {
        Self { positions: Positions::Values, mapping: Mapping::Linear, values, ..*self }
    }

    #[cfg(feature = "batch")]
    /// The axis at the samples of some indices, for a preview.
    pub(crate) fn thinned(&self, indices: &[usize]) -> Self {
        Self { values: indices.iter().map(|&k| self.values[k]).collect(), ..*self }
    }

    /// The axis with its samples from the last to the first, for readers whose axis runs down: the one axis whose values
    /// decrease. A square-root mapping has no reversed form, so that its values are listed.
    #[cfg(feature = "files")]
    pub(crate) fn reversed(&self) -> Self {
        let [a, b] = self.range;
        let (mapping, positions) = match self.mapping {
            Mapping::Linear => (self.mapping, self.positions),
            Mapping::Sqrt => (Mapping::Linear, Positions::Values),
        };
        let values = self.values.iter().rev().copied().collect();
        Self { variable: self.variable, mapping, positions, range: [b, a], values }
    }

    /// Number of samples.
    #[allow(clippy::len_without_is_empty)] // an axis has at least one
    pub fn len(&self) -> usize {
        self.values.len()
    }
}

fn check_inside(variable: Variable, value: f64) -> Result<()> {
    let [a, b] = variable.natural_range();
    if (a..=b).contains(&value) {
        return Ok(());
    }
    let b = if variable.unit() == "rad" { format!("{b:.6} rad") } else { b.to_string() };
    Err(Error::input(format!("{}: {value} is outside [{a}, {b}]", variable.name())))
}
