//! Irradiance by its definition: of a map along its meridians, of a disk and a sky in rings.

use crate::light::{Disk, Light, Map, Sky, peak_of};
use crate::quadrature::integrate;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// Of an integral's own scale, how far the irradiance may be off.
const RELATIVE: f64 = 1e-8;

/// A map's sums down its meridians: at a fixed φ, n·ω = A cos θ + B sin θ with A = nz and B = nx cos φ + ny sin φ is above
/// 0 in one stretch of θ, and the integral over that is in closed form, A ∫ L cos θ sin θ dθ + B ∫ L sin² θ dθ. That over
/// φ is then adaptive, column by column, as L changes there.
pub struct Meridians<'a> {
    map: Map<'a>,
    /// For each column and each border of rows: R, G, B of both integrals from the zenith.
    sums: Vec<[[f64; 3]; 2]>,
    scale: f64,
}

impl<'a> Meridians<'a> {
    /// The sums of a map.
    pub fn new(map: Map<'a>) -> Self {
        let mut sums = Vec::with_capacity(map.width() * (map.height() + 1));
        for column in 0..map.width() {
            let mut sum = [[0.0; 3]; 2];
            sums.push(sum);
            for row in 0..map.height() {
                let texel = map.texel(row, column);
                let [a, b] = [map.theta(row), map.theta(row + 1)];
                let parts = [cos_sin(b) - cos_sin(a), sin_sin(b) - sin_sin(a)];
                for (sum, part) in sum.iter_mut().zip(parts) {
                    (0..3).for_each(|c| sum[c] += texel[c] * part);
                }
                sums.push(sum);
            }
        }
        Self { scale: map.scale(), map, sums }
    }

    /// E of a normal of the world, R, G, B; NaN where it did not converge.
    pub fn irradiance(&self, normal: [f64; 3]) -> [f64; 3] {
        let tolerance = RELATIVE * self.scale / self.map.width() as f64;
        let mut sum = [0.0; 3];
        for column in 0..self.map.width() {
            let [a, b] = self.map.cell(0, column).phi;
            let over = |first: usize, second: usize| {
                let f = |phi: f64| {
                    let along = self.along(column, phi, normal);
                    [along[first], along[second]]
                };
                integrate(f, &[a, b], tolerance).value_or_nan()
            };
            let ([r, g], [blue, _]) = (over(0, 1), over(2, 2));
            sum = [sum[0] + r, sum[1] + g, sum[2] + blue];
        }
        sum
    }

    /// The integral down one meridian.
    fn along(&self, column: usize, phi: f64, normal: [f64; 3]) -> [f64; 3] {
        let (a, b) = (normal[2], normal[0] * phi.cos() + normal[1] * phi.sin());
        let peak = peak_of(a, b);
        let (low, high) = ((peak - FRAC_PI_2).max(0.0), (peak + FRAC_PI_2).min(PI));
        if low >= high {
            return [0.0; 3];
        }
        let [from, to] = [self.down_to(column, low), self.down_to(column, high)];
        std::array::from_fn(|c| a * (to[0][c] - from[0][c]) + b * (to[1][c] - from[1][c]))
    }

    /// Both integrals from the zenith to θ.
    fn down_to(&self, column: usize, theta: f64) -> [[f64; 3]; 2] {
        let rows = self.map.height();
        let row = ((theta / PI * rows as f64) as usize).min(rows - 1);
        let texel = self.map.texel(row, column);
        let start = self.map.theta(row);
        let part = [cos_sin(theta) - cos_sin(start), sin_sin(theta) - sin_sin(start)];
        let sums = self.sums[column * (rows + 1) + row];
        std::array::from_fn(|k| std::array::from_fn(|c| sums[k][c] + texel[c] * part[k]))
    }
}

/// An antiderivative of cos θ sin θ.
fn cos_sin(theta: f64) -> f64 {
    0.5 * theta.sin().powi(2)
}

/// An antiderivative of sin² θ.
fn sin_sin(theta: f64) -> f64 {
    0.5 * theta - 0.25 * (2.0 * theta).sin()
}

/// E of a normal under any light that is no map, by the definition; NaN where it did not converge.
pub fn irradiance(light: &Light, normal: [f64; 3]) -> [f64; 3] {
    match light {
        Light::Constant(radiance) => {
            by_sky(&Sky { zenith: *radiance, horizon: *radiance, ground: *radiance }, normal)
        }
        Light::Directional { direction, irradiance } => {
            irradiance.map(|e| e * DVec3::from(*direction).dot(DVec3::from(normal)).max(0.0))
        }
        Light::Disk(disk) => by_disk(disk, normal),
        Light::Sky(sky) => by_sky(sky, normal),
        Light::Map(map) => Meridians::new(*map).irradiance(normal),
    }
}

/// ∫ max(0, n·ω) sin t dt dψ about the disk's middle. The inner integrand turns at n·ω = 0, where a break is.
fn by_disk(disk: &Disk, normal: [f64; 3]) -> [f64; 3] {
    let axis = DVec3::from(disk.direction);
    let side = DVec3::from(normal).reject_from(axis);
    let (up, across) = (DVec3::from(normal).dot(axis), side.length());
    let ring = |t: f64| {
        let (a, b) = (up * t.cos(), across * t.sin());
        // a + b cos ψ > 0 for |ψ| < end.
        let end = if b <= a.abs() { if a > 0.0 { PI } else { 0.0 } } else { (-a / b).acos() };
        let inner = integrate(|psi: f64| [a + b * psi.cos(), 0.0], &[0.0, end.max(f64::MIN_POSITIVE)], 1e-13);
        [2.0 * inner.value_or_nan()[0] * t.sin(), 0.0]
    };
    // Where the rim of what is inside t reaches the horizon, the integrand in t turns.
    let kink = (FRAC_PI_2 - across.atan2(up)).abs();
    let mut breaks = vec![0.0, disk.radius];
    if kink > 0.0 && kink < disk.radius {
        breaks.insert(1, kink);
    }
    let [factor, _] = integrate(ring, &breaks, 1e-12).value_or_nan();
    disk.radiance.map(|l| l * factor)
}

/// ∫ L(θ) max(0, n·ω) dω about the zenith, halves above and below the horizon apart.
fn by_sky(sky: &Sky, normal: [f64; 3]) -> [f64; 3] {
    let (nz, nh) = (normal[2], normal[0].hypot(normal[1]));
    let ring = |theta: f64| {
        let (a, b) = (nz * theta.cos(), nh * theta.sin());
        let end = if b <= a.abs() { if a > 0.0 { PI } else { 0.0 } } else { (-a / b).acos() };
        let inner = integrate(|phi: f64| [a + b * phi.cos(), 0.0], &[0.0, end.max(f64::MIN_POSITIVE)], 1e-13);
        2.0 * inner.value_or_nan()[0] * theta.sin()
    };
    let tilt = nh.atan2(nz);
    let mut breaks = vec![0.0, (FRAC_PI_2 - tilt).abs(), FRAC_PI_2];
    breaks.dedup();
    let above = integrate(|theta| ring(theta).pipe(|e| [e, e * theta.cos()]), &breaks, 1e-12).value_or_nan();
    let mut breaks = vec![FRAC_PI_2, PI - (FRAC_PI_2 - tilt).abs(), PI];
    breaks.dedup();
    let [below, _] = integrate(|theta| [ring(theta), 0.0], &breaks, 1e-12).value_or_nan();
    std::array::from_fn(|c| {
        sky.horizon[c] * (above[0] - above[1]) + sky.zenith[c] * above[1] + sky.ground[c] * below
    })
}

/// So that an integrand can use a value twice.
trait Pipe: Sized {
    fn pipe<T>(self, f: impl FnOnce(Self) -> T) -> T {
        f(self)
    }
}

impl Pipe for f64 {}
