//! Lights that have closed forms. Their constructors check them, so that no wrong light can be built.

use crate::base::error::{Error, Result};
use crate::base::radiometry::minus_sin;
use crate::light::{angles, dot};
use std::f64::consts::{FRAC_PI_2, PI};

/// The radiance of a light that is the same from all directions, W sr⁻¹ m⁻².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Radiance([f64; 3]);

impl Radiance {
    /// L = 0 in all channels.
    pub(crate) const BLACK: Self = Self([0.0; 3]);
    /// L = 1 in all channels.
    pub(crate) const WHITE: Self = Self([1.0; 3]);

    /// Checks R, G and B.
    ///
    /// # Errors
    /// When a channel is negative or not finite.
    pub fn new(rgb: [f64; 3]) -> Result<Self> {
        check_radiance("constant", &rgb)?;
        Ok(Self(rgb))
    }

    /// R, G and B.
    pub fn rgb(&self) -> [f64; 3] {
        self.0
    }
}

/// Light from one direction, as of a star: a delta, so it has an irradiance and no radiance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Directional {
    direction: [f64; 3],
    irradiance: [f64; 3],
}

impl Directional {
    /// Builds a light from `direction`, a unit vector towards it, with the irradiance E of a surface that faces it,
    /// W m⁻².
    ///
    /// # Errors
    /// When the direction is not unit, or the irradiance is negative or not finite.
    pub fn new(direction: [f64; 3], irradiance: [f64; 3]) -> Result<Self> {
        check_direction(&direction)?;
        check_irradiance("directional", &irradiance)?;
        Ok(Self { direction, irradiance })
    }

    /// The unit vector towards the light.
    pub fn direction(&self) -> [f64; 3] {
        self.direction
    }

    /// E of a surface that faces the light, W m⁻².
    pub fn irradiance(&self) -> [f64; 3] {
        self.irradiance
    }
}

/// A disk in the sky, or a sphere: radiance L within an angle σ of its middle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disk {
    direction: [f64; 3],
    radius: f64,
    radiance: [f64; 3],
}

impl Disk {
    /// Builds a disk from the unit vector towards its middle, its half angle σ ∈ (0, π/2] in rad (the sun's is 4.65e-3)
    /// and its radiance L, W sr⁻¹ m⁻².
    ///
    /// # Errors
    /// When the direction is not unit, the half angle is outside (0, π/2], or the radiance is negative or not finite.
    pub fn new(direction: [f64; 3], radius: f64, radiance: [f64; 3]) -> Result<Self> {
        check_direction(&direction)?;
        check_radiance("disk", &radiance)?;
        if radius > 0.0 && radius <= FRAC_PI_2 {
            return Ok(Self { direction, radius, radiance });
        }
        Err(Error::input(format!("disk: its half angle {radius} rad is outside (0, π/2]; give one in it")))
    }

    /// The unit vector towards the middle.
    pub fn direction(&self) -> [f64; 3] {
        self.direction
    }

    /// The half angle σ, rad.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// L, W sr⁻¹ m⁻².
    pub fn radiance(&self) -> [f64; 3] {
        self.radiance
    }

    pub(super) fn radiance_from(&self, direction: [f64; 3]) -> [f64; 3] {
        // The chord is compared, because cosines near 1 have lost their digits.
        let away: f64 = (0..3).map(|k| (direction[k] - self.direction[k]).powi(2)).sum();
        let inside = 0.5 * away.sqrt() <= (0.5 * self.radius).sin();
        if inside { self.radiance } else { [0.0; 3] }
    }

    /// Computes E/L of a surface whose normal is at θ from the middle: Snyder 1996, "Area light sources for real-time graphics",
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
}

/// A gradient: L = horizon + (zenith − horizon) cos θ above the horizon, and L = ground below.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sky {
    zenith: [f64; 3],
    horizon: [f64; 3],
    ground: [f64; 3],
}

impl Sky {
    /// Builds a gradient from the radiance at the zenith, at the horizon and from the ground, W sr⁻¹ m⁻².
    ///
    /// # Errors
    /// When a radiance is negative or not finite.
    pub fn new(zenith: [f64; 3], horizon: [f64; 3], ground: [f64; 3]) -> Result<Self> {
        [zenith, horizon, ground].iter().try_for_each(|radiance| check_radiance("sky", radiance))?;
        Ok(Self { zenith, horizon, ground })
    }

    /// The same radiance from all directions.
    pub fn uniform(Radiance(rgb): Radiance) -> Self {
        Self { zenith: rgb, horizon: rgb, ground: rgb }
    }

    /// L at the zenith.
    pub fn zenith(&self) -> [f64; 3] {
        self.zenith
    }

    /// L at the horizon.
    pub fn horizon(&self) -> [f64; 3] {
        self.horizon
    }

    /// L from below the horizon.
    pub fn ground(&self) -> [f64; 3] {
        self.ground
    }

    pub(super) fn radiance_from(&self, direction: [f64; 3]) -> [f64; 3] {
        let z = direction[2];
        if z < 0.0 {
            return self.ground;
        }
        std::array::from_fn(|k| self.horizon[k] + (self.zenith[k] - self.horizon[k]) * z)
    }

    /// Computes E of a surface whose normal is at θ from the zenith. The directions above both horizons form a lune. From
    /// it, uniform radiance sends ½ π (1 + cos θ); for L = cos θi, in coordinates about the lune's poles, where dω = cos ψ dψ dχ, z = cos ψ cos χ and
    /// n·ω = cos ψ cos(χ − θ),
    ///
    /// ```text
    /// ∫ cos³ ψ dψ ∫ cos χ cos(χ − θ) dχ over χ ∈ [θ − π/2, π/2]  =  ⅔ ((π − θ) cos θ + sin θ)
    /// ```
    ///
    /// With t = π − θ that is ⅔ (2 t sin²(t/2) − (t − sin t)), and ½ π (1 + cos θ) = π sin²(t/2): differences that lose no
    /// digits where the surface faces down, and no term of which is below 0.
    pub fn irradiance(&self, normal: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = normal;
        let (t, _) = angles([x, y, -z]);
        let (sin, cos) = (0.5 * t).sin_cos();
        let above = PI * sin * sin;
        let below = PI * cos * cos;
        let gradient = (2.0 * t * sin * sin - minus_sin(t)) / 1.5;
        std::array::from_fn(|k| {
            self.horizon[k] * (above - gradient) + self.zenith[k] * gradient + self.ground[k] * below
        })
    }
}

fn check_radiance(light: &str, radiance: &[f64; 3]) -> Result<()> {
    check_finite(light, "a radiance", radiance)
}

fn check_irradiance(light: &str, irradiance: &[f64; 3]) -> Result<()> {
    check_finite(light, "an irradiance", irradiance)
}

fn check_finite(light: &str, quantity: &str, rgb: &[f64; 3]) -> Result<()> {
    match rgb.iter().find(|x| !x.is_finite() || **x < 0.0) {
        None => Ok(()),
        Some(x) => Err(Error::input(format!("{light}: {quantity} of {x}; give finite numbers from 0 up"))),
    }
}

fn check_direction(direction: &[f64; 3]) -> Result<()> {
    let length = dot(*direction, *direction).sqrt();
    if (length - 1.0).abs() < 1e-9 {
        return Ok(());
    }
    Err(Error::input(format!("a direction of length {length}; give a unit vector")))
}
