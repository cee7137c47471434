//! Exitant radiance and radiosity by their definitions.

use crate::light::albedo::Albedo;
use crate::light::source::{GAUSS, Source, unit_vector};
use crate::light::{Cell, Frame, Light, peak_of};
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

/// (θi, φi) in the surface's frame.
pub type Incident = (f64, f64);

/// Of Le, what all cells together may be off.
const SPLIT: f64 = 1e-5;
/// Quarters of quarters: to 1e-9 of a cell.
const DEPTH: u32 = 30;

/// Le(ωe) = ∫ f L cos θi dωi of a surface in a frame under a light, R, G, B. `f` is the BRDF of ωi, R, G, B, for the one
/// ωe = `exit` (θe, φe), all in the surface's frame; `width` is about that of its lobe around the mirror direction, rad.
///
/// Each cell is integrated by Gauss–Legendre of 3 × 3, down meridians of which only what is above the surface counts,
/// and again in quarters; where both differ, the quarters are done so, each by itself. Of a light from one direction it
/// is f E cos θi.
pub fn exitant(
    light: &Light,
    frame: &Frame,
    exit: (f64, f64),
    width: f64,
    f: &dyn Fn(Incident) -> [f64; 3],
) -> [f64; 3] {
    let Some(source) = Source::new(light) else { return directional(light, frame, f) };
    let wo = unit_vector(exit.0, exit.1);
    let mirror = source.to_local(frame.to_world([-wo.x, -wo.y, wo.z]));
    let surface =
        Surface { source: &source, frame, normal: source.to_local(frame.normal()), mirror, width, f };
    let whole = |share: f64| {
        let cells = source.cells().filter(|cell| {
            let is_lit = cell.theta.iter().any(|&theta| source.radiance(cell, theta) != [0.0; 3]);
            is_lit && !surface.is_below(cell)
        });
        cells.fold([0.0; 3], |sum, cell| plus(sum, surface.adaptive(&cell, share, 0)))
    };
    // First for its size.
    let size = whole(f64::INFINITY).into_iter().fold(0.0, f64::max);
    whole(source.share(SPLIT * size.max(f64::MIN_POSITIVE)))
}

/// A delta of light: Le = f E cos θi.
fn directional(light: &Light, frame: &Frame, f: &dyn Fn(Incident) -> [f64; 3]) -> [f64; 3] {
    let Light::Directional { direction, irradiance } = light else { return [f64::NAN; 3] };
    let local = DVec3::from(frame.to_local(*direction));
    if local.z <= 0.0 {
        return [0.0; 3];
    }
    let f = f(angles(local));
    std::array::from_fn(|c| f[c] * irradiance[c] * local.z)
}

/// M = ∫ Le cos θe dωe of a surface in a frame under a light, R, G, B. Both integrals may change places, whatever f is
/// (Fubini; f L is not negative): M = ∫ ρ_dh(ωi) L cos θi dωi, which is an [`exitant`] with ρ_dh in place of f.
pub fn radiosity(light: &Light, frame: &Frame, albedo: &Albedo) -> [f64; 3] {
    exitant(light, frame, (0.0, 0.0), 1.0, &|(theta_i, _)| albedo.at(theta_i))
}

struct Surface<'a> {
    source: &'a Source<'a>,
    frame: &'a Frame,
    /// Of the source's frame, as is `mirror`.
    normal: DVec3,
    mirror: DVec3,
    width: f64,
    f: &'a dyn Fn(Incident) -> [f64; 3],
}

impl Surface<'_> {
    /// ∫ f L max(0, cos θi) dω over a cell, until quarters agree to `tolerance`.
    fn adaptive(&self, cell: &Cell, tolerance: f64, depth: u32) -> [f64; 3] {
        let [theta, phi] = [cell.theta, cell.phi].map(|[a, b]| 0.5 * (a + b));
        let size = (cell.theta[1] - cell.theta[0]).max((cell.phi[1] - cell.phi[0]) * theta.sin());
        let away = (unit_vector(theta, phi) - self.mirror).length();
        let near = away < 2.0 * size && size > 0.25 * self.width;
        let coarse = self.gauss(cell);
        if depth == DEPTH || tolerance.is_infinite() && !near {
            return coarse;
        }
        let quarters = quarters(cell);
        if !near {
            let fine = quarters.iter().fold([0.0; 3], |sum, cell| plus(sum, self.gauss(cell)));
            let off = (0..3).map(|c| (fine[c] - coarse[c]).abs()).fold(0.0, f64::max);
            if off <= tolerance {
                return fine;
            }
        }
        // Half, as errors of quarters have no common sign.
        quarters.iter().fold([0.0; 3], |sum, cell| plus(sum, self.adaptive(cell, 0.5 * tolerance, depth + 1)))
    }

    fn gauss(&self, cell: &Cell) -> [f64; 3] {
        let ([t0, t1], [p0, p1]) = (cell.theta, cell.phi);
        let mut sum = [0.0; 3];
        for (x, wx) in GAUSS {
            let phi = 0.5 * (p0 + p1) + 0.5 * (p1 - p0) * x;
            // n·ω = A cos θ + B sin θ > 0 within a quarter turn of its peak.
            let peak = peak_of(self.normal.z, self.normal.x * phi.cos() + self.normal.y * phi.sin());
            let (low, high) = (t0.max(peak - FRAC_PI_2), t1.min(peak + FRAC_PI_2));
            if low >= high {
                continue;
            }
            for (y, wy) in GAUSS {
                let theta = 0.5 * (low + high) + 0.5 * (high - low) * y;
                let world = self.source.to_world(unit_vector(theta, phi));
                let local = DVec3::from(self.frame.to_local(world.to_array()));
                if local.z <= 0.0 {
                    continue;
                }
                let weight = wx * wy * 0.25 * (p1 - p0) * (high - low) * theta.sin() * local.z;
                let (f, light) = ((self.f)(angles(local)), self.source.radiance(cell, theta));
                sum = std::array::from_fn(|c| sum[c] + weight * f[c] * light[c]);
            }
        }
        sum
    }

    /// Whether all of a cell is surely below: its middle is farther than it is wide.
    fn is_below(&self, cell: &Cell) -> bool {
        let [theta, phi] = [cell.theta, cell.phi].map(|[a, b]| 0.5 * (a + b));
        let size = (cell.theta[1] - cell.theta[0]) + (cell.phi[1] - cell.phi[0]);
        unit_vector(theta, phi).dot(self.normal) < -size
    }
}

fn quarters(cell: &Cell) -> [Cell; 4] {
    let [theta, phi] = [cell.theta, cell.phi].map(|[a, b]| [[a, 0.5 * (a + b)], [0.5 * (a + b), b]]);
    std::array::from_fn(|k| Cell { theta: theta[k / 2], phi: phi[k % 2], ..*cell })
}

/// (θ, φ) of a unit vector.
fn angles(v: DVec3) -> (f64, f64) {
    (v.x.hypot(v.y).atan2(v.z), v.y.atan2(v.x))
}

fn plus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|c| a[c] + b[c])
}
