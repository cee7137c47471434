//! Lights in closed form: a disk, a gradient.

use crate::base::error::{Error, Result};
use crate::light::{angles, dot};
use std::f64::consts::{FRAC_PI_2, PI};

/// A disk in the sky, or a sphere: radiance L within an angle σ of its middle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disk {
    /// Towards its middle, unit.
    pub direction: [f64; 3],
    /// σ ∈ (0, π/2], rad: its half angle. The sun's is 4.65e-3.
    pub radius: f64,
    /// L, W sr⁻¹ m⁻².
    pub radiance: [f64; 3],
}

impl Disk {
    pub(super) fn radiance_from(&self, direction: [f64; 3]) -> [f64; 3] {
        // Of the chord, as cosines near 1 have lost their digits.
        let away: f64 = (0..3).map(|k| (direction[k] - self.direction[k]).powi(2)).sum();
        let inside = 0.5 * away.sqrt() <= (0.5 * self.radius).sin();
        if inside { self.radiance } else { [0.0; 3] }
    }

    /// E/L of a surface whose normal is at θ from the middle: Snyder 1996, "Area light sources for real-time graphics",
    /// by Stokes's theorem. E/L = n·½∮ ω × dω around what is above the horizon: the disk's rim, ω × dω = (sin² σ c −
    /// sin σ cos σ r(ψ)) dψ for |ψ| < ψ₀, cos ψ₀ = −cot σ cot θ, and the horizon's arc, which n sees at ½ dψ. So
    ///
    /// ```text
    /// E/L = ψ₀ sin² σ cos θ − sin ψ₀ sin σ cos σ sin θ + β,   cos β = cos σ / sin θ
    /// ```
    ///
    /// where the horizon cuts it, and π sin² σ cos θ where all of it is above. With R² = sin² σ − cos² θ, ψ₀ is the angle of
    /// (−cos σ cos θ, R), β that of (cos σ, R), and sin ψ₀ sin σ sin θ = R, which keep the digits of a small disk.
    pub fn form_factor(&self, normal: [f64; 3]) -> f64 {
        let [x, y, z] = [0, 1, 2].map(|k| {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            normal[i] * self.direction[j] - normal[j] * self.direction[i]
        });
        let (sin, cos) = ((x * x + y * y + z * z).sqrt(), dot(normal, self.direction));
        let (theta, sigma) = (sin.atan2(cos), self.radius);
        if theta + sigma <= FRAC_PI_2 {
            return PI * sigma.sin().powi(2) * cos;
        }
        if theta - sigma >= FRAC_PI_2 {
            return 0.0;
        }
        let (s, c) = sigma.sin_cos();
        let root = ((s - cos) * (s + cos)).max(0.0).sqrt();
        let (rim, horizon) = (root.atan2(-c * cos), root.atan2(c));
        (rim * s * s * cos + (horizon - root * c)).max(0.0)
    }

    pub(super) fn check(&self) -> Result<()> {
        check_direction(&self.direction)?;
        check_radiance("disk", &self.radiance)?;
        if self.radius > 0.0 && self.radius <= FRAC_PI_2 {
            return Ok(());
        }
        Err(Error::input(format!("disk: its half angle {} rad is outside (0, π/2]", self.radius)))
    }
}

/// L = horizon + (zenith − horizon) cos θ above the horizon, and the ground's below.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sky {
    /// L at the zenith, W sr⁻¹ m⁻².
    pub zenith: [f64; 3],
    /// L at the horizon.
    pub horizon: [f64; 3],
    /// L from below.
    pub ground: [f64; 3],
}

impl Sky {
    pub(super) fn radiance_from(&self, direction: [f64; 3]) -> [f64; 3] {
        let z = direction[2];
        if z < 0.0 {
            return self.ground;
        }
        std::array::from_fn(|k| self.horizon[k] + (self.zenith[k] - self.horizon[k]) * z)
    }

    /// E of a surface whose normal is at θ from the zenith. Of what is above both horizons, a lune, a uniform radiance
    /// sends ½ π (1 + cos θ); and L = cos θi, about the lune's own poles, where dω = cos ψ dψ dχ, z = cos ψ cos χ and
    /// n·ω = cos ψ cos(χ − θ),
    ///
    /// ```text
    /// ∫ cos³ ψ dψ ∫ cos χ cos(χ − θ) dχ over χ ∈ [θ − π/2, π/2]  =  ⅔ ((π − θ) cos θ + sin θ)
    /// ```
    pub fn irradiance(&self, normal: [f64; 3]) -> [f64; 3] {
        let (theta, _) = angles(normal);
        let (sin, cos) = theta.sin_cos();
        let above = 0.5 * PI * (1.0 + cos);
        let below = 0.5 * PI * (1.0 - cos);
        let gradient = ((PI - theta) * cos + sin) / 1.5;
        std::array::from_fn(|k| {
            self.horizon[k] * (above - gradient) + self.zenith[k] * gradient + self.ground[k] * below
        })
    }

    pub(super) fn check(&self) -> Result<()> {
        [self.zenith, self.horizon, self.ground]
            .iter()
            .try_for_each(|radiance| check_radiance("sky", radiance))
    }
}

pub(super) fn check_radiance(what: &str, radiance: &[f64; 3]) -> Result<()> {
    match radiance.iter().find(|x| !x.is_finite() || **x < 0.0) {
        None => Ok(()),
        Some(x) => Err(Error::input(format!("{what}: a radiance of {x}; give numbers from 0 up"))),
    }
}

pub(super) fn check_direction(direction: &[f64; 3]) -> Result<()> {
    let length = dot(*direction, *direction).sqrt();
    if (length - 1.0).abs() < 1e-9 {
        return Ok(());
    }
    Err(Error::input(format!("a direction of length {length}; give a unit vector")))
}
