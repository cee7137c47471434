//! Radiometry: the quantities that define a BRDF, from solid angle to photons. SI units: lengths in m, areas in m², angles in
//! rad, solid angles in sr, power in W, time in s.
//!
//! | quantity | symbol | unit | here |
//! |---|---|---|---|
//! | solid angle | Ω, dω = sin θ dθ dφ | sr | [`DirectionCell`], [`cone`], [`triangle`], [`polygon`], [`Rectangle`] |
//! | projected solid angle | ∫ cos θ dω | sr | [`DirectionCell::projected`], [`projected_cone`], [`projected_polygon`] |
//! | apparent area | cos θ_A ΔA / R² | sr | [`apparent`] |
//! | radiance | L | W sr⁻¹ m⁻² | [`Beam`] |
//! | power, energy | Φ, Q | W, J | [`Beam::power`], [`Beam::energy`] |
//! | photons | Q λ / (h c) | 1 | [`photons`] |
//! | irradiance, radiosity | E, M | W m⁻² | [`light`](crate::light) |

use crate::base::error::{Error, Result};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// h, the Planck constant, J s: exact in the SI since 2019.
pub const PLANCK: f64 = 6.626_070_15e-34;

/// c, the speed of light in vacuum, m s⁻¹: exact in the SI.
pub const LIGHT_SPEED: f64 = 299_792_458.0;

/// A cell of directions: θ from `theta[0]` to `theta[1]` and φ from `phi[0]` to `phi[1]`, rad, both ascending.
///
/// Its integrals are products and sums of terms of one sign, of the middle and the differences of the angles, so a cell
/// of 1e-8 rad has them to its last digits: cos θ₀ − cos θ₁ does not.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DirectionCell {
    /// Zenith angles, in [0, π].
    pub theta: [f64; 2],
    /// Azimuths, at most 2π apart.
    pub phi: [f64; 2],
}

impl DirectionCell {
    /// The middle of the two zenith angles, and their difference.
    fn band(&self) -> (f64, f64) {
        let [a, b] = self.theta;
        (0.5 * (a + b), b - a)
    }

    /// Δφ, rad.
    fn width(&self) -> f64 {
        self.phi[1] - self.phi[0]
    }

    /// ∫ sin θ dθ dφ = (cos θ₀ − cos θ₁) Δφ = 2 sin θm sin(Δθ/2) Δφ, sr.
    pub fn solid_angle(&self) -> f64 {
        let (middle, height) = self.band();
        2.0 * middle.sin() * (0.5 * height).sin() * self.width()
    }

    /// ∫ cos θ dω = ½ (sin² θ₁ − sin² θ₀) Δφ = ½ sin 2θm sin Δθ Δφ, sr: negative below the horizon θ = π/2, and that
    /// much less where a cell lies on both sides of it.
    pub fn projected(&self) -> f64 {
        let (middle, height) = self.band();
        0.5 * (2.0 * middle).sin() * height.sin() * self.width()
    }

    /// The vector ∫ ω dω, sr. A radiance L in the cell gives a surface of normal n the irradiance L n·∫ ω dω, if all of the
    /// cell is above the surface.
    pub fn vector(&self) -> [f64; 3] {
        let [x, y] = chord(self.phi);
        let s = sin2(self.theta);
        [s * x, s * y, self.projected()]
    }
}

/// ∫ (cos φ, sin φ) dφ = 2 sin(Δφ/2) (cos φm, sin φm).
pub(crate) fn chord([a, b]: [f64; 2]) -> [f64; 2] {
    let (sin, cos) = (0.5 * (a + b)).sin_cos();
    let length = 2.0 * (0.5 * (b - a)).sin();
    [length * cos, length * sin]
}

/// ∫ sin² θ dθ = ½ (Δθ − sin Δθ) + sin Δθ sin² θm: both terms are non-negative.
pub(crate) fn sin2([a, b]: [f64; 2]) -> f64 {
    let (middle, height) = (0.5 * (a + b), b - a);
    0.5 * minus_sin(height) + height.sin() * middle.sin().powi(2)
}

/// Computes x − sin x for x ∈ [0, π]. The difference loses all digits where x is small, so the series
/// x³/3! − x⁵/5! + … takes its place there, whose terms fall by x²/20 and faster.
pub(crate) fn minus_sin(x: f64) -> f64 {
    /// Above this x the difference loses at most 2 bits; below it eight terms of the series leave 1e-17.
    const SERIES: f64 = 1.0;
    if x.abs() > SERIES {
        return x - x.sin();
    }
    let (mut term, mut sum) = (x * x * x / 6.0, 0.0);
    for k in 2..10 {
        sum += term;
        let n = f64::from(2 * k);
        term *= -x * x / (n * (n + 1.0));
    }
    sum
}

/// The solid angle of a cone of half angle σ ∈ [0, π], sr: 2π (1 − cos σ) = 4π sin²(σ/2).
pub fn cone(sigma: f64) -> f64 {
    4.0 * PI * (0.5 * sigma).sin().powi(2)
}

/// The projected solid angle of a cone of half angle σ around a direction at θ from the normal, all of it above the
/// horizon (θ + σ ≤ π/2), sr: π sin² σ cos θ.
pub fn projected_cone(sigma: f64, theta: f64) -> f64 {
    PI * sigma.sin().powi(2) * theta.cos()
}

/// The solid angle of a triangle seen from the origin, sr, positive if its corners run counter-clockwise as seen from
/// there: van Oosterom & Strackee 1983, eq. 8,
/// tan(Ω/2) = a·(b × c) / (abc + (a·b) c + (a·c) b + (b·c) a). Corners are at any distance but 0.
pub fn triangle(corners: [[f64; 3]; 3]) -> f64 {
    // Seen from inside, counter-clockwise is the other way round.
    let [a, b, c] = corners.map(|corner| DVec3::from_array(corner).normalize());
    // Of the differences, so that a small triangle keeps its digits: a·(b × c) = a·((b − a) × (c − a)).
    let volume = -a.dot((b - a).cross(c - a));
    2.0 * volume.atan2(1.0 + a.dot(b) + a.dot(c) + b.dot(c))
}

/// The solid angle of a polygon seen from the origin, sr, the sum of a fan of [`triangle`]s: it may be concave, and its
/// corners need not lie in a plane.
pub fn polygon(corners: &[[f64; 3]]) -> f64 {
    let Some((&first, rest)) = corners.split_first() else { return 0.0 };
    rest.windows(2).map(|pair| triangle([first, pair[0], pair[1]])).sum()
}

/// The projected solid angle of a polygon above the horizon of a normal, ∫ n·ω dω, sr, signed as [`polygon`]: Lambert
/// 1760; Baum, Rushmeier & Winget 1989, eq. 5: ½ Σ γ n·(a × b)/|a × b|, γ the angle between neighbouring corners.
pub fn projected_polygon(corners: &[[f64; 3]], normal: [f64; 3]) -> f64 {
    let normal = DVec3::from_array(normal);
    let corners: Vec<_> = corners.iter().map(|&corner| DVec3::from_array(corner).normalize()).collect();
    let edge = |(k, &a): (usize, &DVec3)| {
        let cross = a.cross(corners[(k + 1) % corners.len()]);
        let (sin, cos) = (cross.length(), a.dot(corners[(k + 1) % corners.len()]));
        if sin == 0.0 { 0.0 } else { -0.5 * sin.atan2(cos) * normal.dot(cross) / sin }
    };
    corners.iter().enumerate().map(edge).sum()
}

/// A flat rectangle in space, such as a light or a patch of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rectangle {
    /// Its middle, m.
    pub centre: [f64; 3],
    /// The vectors from the middle to the middles of two neighbouring sides, m, perpendicular to each other. It faces along
    /// their cross product.
    pub half_sides: [[f64; 3]; 2],
}

impl Rectangle {
    /// Its corners, counter-clockwise as seen from where it faces.
    pub fn corners(&self) -> [[f64; 3]; 4] {
        let [u, v] = self.half_sides;
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
            .map(|[s, t]| std::array::from_fn(|k| self.centre[k] + s * u[k] + t * v[k]))
    }

    /// Its area, m².
    pub fn area(&self) -> f64 {
        let [u, v] = self.half_sides.map(DVec3::from_array);
        4.0 * u.cross(v).length()
    }

    /// The solid angle of the rectangle as seen from a point, sr; positive if it faces the point.
    pub fn solid_angle(&self, from: [f64; 3]) -> f64 {
        polygon(&self.corners().map(|corner| std::array::from_fn(|k| corner[k] - from[k])))
    }

    /// The approximation Ω ≈ cos θ_A ΔA / R² as seen from a point: [`apparent`] with R to the middle.
    pub fn apparent(&self, from: [f64; 3]) -> f64 {
        let [u, v] = self.half_sides.map(DVec3::from_array);
        let away = DVec3::from_array(from) - DVec3::from_array(self.centre);
        apparent(self.area(), u.cross(v).normalize().dot(away.normalize()), away.length())
    }

    /// The relative error of [`Rectangle::apparent`] against the exact solid angle. It falls with the square of
    /// size over distance: of a square of side s, seen from straight above at R, s²/(4 R²).
    pub fn apparent_error(&self, from: [f64; 3]) -> f64 {
        let exact = self.solid_angle(from);
        (self.apparent(from) - exact) / exact
    }
}

/// The solid angle of a small area far away, sr: Ω ≈ cos θ_A ΔA / R², θ_A between its normal and the line of sight.
pub fn apparent(area: f64, cos_theta: f64, distance: f64) -> f64 {
    cos_theta * area / (distance * distance)
}

/// Radiance through a patch of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beam {
    /// L, W sr⁻¹ m⁻².
    pub radiance: f64,
    /// cos θ, θ between the beam and the patch's normal.
    pub cos_theta: f64,
    /// ΔA, m².
    pub area: f64,
    /// Δω, sr.
    pub solid_angle: f64,
}

impl Beam {
    /// Returns the beam that carries a power Φ, W, through a patch: L = Φ / (cos θ ΔA Δω).
    ///
    /// # Errors
    /// When the patch's étendue is not positive and finite, or the power is negative or not finite.
    pub fn of_power(power: f64, cos_theta: f64, area: f64, solid_angle: f64) -> Result<Self> {
        let empty = Self { radiance: 0.0, cos_theta, area, solid_angle };
        let etendue = empty.etendue();
        if !(etendue > 0.0 && etendue.is_finite()) {
            return Err(Error::input(format!("cos θ ΔA Δω is {etendue} m² sr; give a beam of some étendue")));
        }
        if !(power >= 0.0 && power.is_finite()) {
            return Err(Error::input(format!("a power of {power} W; give a finite number from 0 up")));
        }
        Ok(Self { radiance: power / etendue, ..empty })
    }

    /// The étendue cos θ ΔA Δω, m² sr, which a beam keeps along its way.
    pub fn etendue(&self) -> f64 {
        self.cos_theta * self.area * self.solid_angle
    }

    /// The power Φ = L cos θ ΔA Δω, W.
    pub fn power(&self) -> f64 {
        self.radiance * self.etendue()
    }

    /// The energy Q = L cos θ ΔA Δω Δt, J, over Δt in s.
    pub fn energy(&self, duration: f64) -> f64 {
        self.power() * duration
    }
}

/// The number of photons of wavelength λ, m, in an energy Q, J: Q λ / (h c).
pub fn photons(energy: f64, wavelength: f64) -> f64 {
    energy * wavelength / (PLANCK * LIGHT_SPEED)
}

/// The energy of one photon of a wavelength λ, m: h c / λ, J.
pub fn photon_energy(wavelength: f64) -> f64 {
    PLANCK * LIGHT_SPEED / wavelength
}

/// The solid angle of all directions, 4π sr.
pub const SPHERE: f64 = 2.0 * TAU;

/// The solid angle of all directions above a surface, 2π sr. Its projected solid angle is π.
pub const HEMISPHERE: f64 = TAU;
