//! Exitant radiance Le(ωe) = ∫ f L cos θi dωi, its pre-filtered approximation, and radiosity.
//!
//! The directions are the host's (`domain`, `nodes`), f the device's, and where more of them are needed is found from what
//! it says (`refine`). Lambert's lobe needs none of this: f is constant, so Le = f E, which is exact. A mirror's is what it
//! is defined to be: Le(ωe) = F L(r), r the mirror direction of ωe.

mod domain;
mod nodes;
mod prefiltered;
mod radiosity;
mod refine;

pub use prefiltered::{prefiltered, split_sum};
pub use radiosity::radiosity;

use crate::bake::points::Points;
use crate::bake::{Evaluator, Observer};
use crate::base::angles::Angles;
use crate::base::error::{Error, Result};
use crate::integrate::scale::LobeScale;
use crate::light::irradiance;
use crate::light::{Frame, Light, direction};
use crate::model::lobe::Lobe;
use crate::model::{Integral, LAMBERT};
use std::f64::consts::PI;

/// A surface and where it is seen from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// The surface's frame in the world.
    pub frame: Frame,
    /// θe ∈ [0, π/2], rad.
    pub theta_e: f64,
    /// φe, rad, in the surface's frame.
    pub phi_e: f64,
}

impl View {
    /// Where a mirror would show: the mirror direction of ωe, in the world.
    pub fn mirror(&self) -> [f64; 3] {
        let [x, y, z] = direction(self.theta_e, self.phi_e);
        self.frame.to_world([-x, -y, z])
    }
}

/// An integral over incident light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Integrated {
    /// R, G, B.
    pub value: [f64; 3],
    /// What it may be off by its own estimate: of the mean of the channels.
    pub error: f64,
}

/// Le of a sum of lobes of three channels under a light, of each view. The tolerance is relative to Le.
///
/// # Errors
/// When a lobe needs a roughness, or the device fails.
pub fn radiance(
    evaluator: &Evaluator,
    lobes: &[Lobe],
    light: &Light,
    views: &[View],
    tolerance: f64,
    observer: &dyn Observer,
) -> Result<Vec<Integrated>> {
    let mut all = vec![Integrated { value: [0.0; 3], error: 0.0 }; views.len()];
    let is_flat = |lobe: &&Lobe| lobe.model() == &LAMBERT && lobe.factors().is_empty();
    let is_delta = |lobe: &&Lobe| lobe.is_delta();
    let flat: Vec<_> = lobes.iter().filter(is_flat).collect();
    let deltas: Vec<_> = lobes.iter().filter(is_delta).collect();
    let rest: Vec<_> = lobes.iter().filter(|lobe| !is_flat(lobe) && !is_delta(lobe)).cloned().collect();

    if !flat.is_empty() {
        let normals: Vec<_> = views.iter().map(|view| view.frame.normal()).collect();
        let irradiances = irradiance_of(evaluator, light, &normals)?;
        for (one, e) in all.iter_mut().zip(&irradiances) {
            for lobe in &flat {
                (0..3).for_each(|c| one.value[c] += lobe.weights()[c][0] * e[c] / PI);
            }
        }
    }
    for lobe in deltas {
        for (one, view) in all.iter_mut().zip(views) {
            let [a, b] = delta(lobe, view.theta_e)?;
            let seen = light.radiance(view.mirror());
            (0..3).for_each(|c| {
                one.value[c] += seen[c] * (lobe.weights()[c][0] * a + lobe.weights()[c][1] * b)
            });
        }
    }
    if !rest.is_empty() {
        let mut points = Points::new(evaluator, &rest)?;
        let mut f = |angles: &[Angles], values: &mut Vec<f32>| points.evaluate(angles, values);
        let width = rest.iter().map(width).fold(f64::INFINITY, f64::min);
        let found = refine::integrate(&mut f, width, light, views, tolerance, observer)?;
        for (one, more) in all.iter_mut().zip(found) {
            (0..3).for_each(|c| one.value[c] += more.value[c]);
            one.error += more.error;
        }
    }
    Ok(all)
}

/// What a delta reflects of L(r): A and B at θe, as its integrals have them, times its factors at θi = θe.
fn delta(lobe: &Lobe, theta_e: f64) -> Result<[f64; 2]> {
    let (mu, setting) = (theta_e.cos().max(0.0), lobe.setting_at(None)?);
    let components = match lobe.model().integral {
        Integral::Delta(directional) => directional(mu, &setting),
        Integral::Slopes(slopes) => (slopes.mirror_limit)(mu, &setting),
        _ => {
            let why = format!("{} at this roughness is a delta; give it more", lobe.model().name);
            return Err(Error::input(why));
        }
    };
    let factor = LobeScale::new(lobe.factors(), lobe.roughness()).value(mu, mu);
    Ok(components.map(|component| factor * component))
}

/// About half the width of a lobe around the mirror direction, rad: α, and less where it is stretched.
fn width(lobe: &Lobe) -> f64 {
    let stretched = if lobe.model().is_anisotropic() { 0.1 } else { 1.0 };
    match (lobe.model().shape, lobe.roughness()) {
        (Some(shape), Some(roughness)) => shape.measure(roughness).clamp(1e-6, 1.0) * stretched,
        _ => 1.0,
    }
}

/// E of some normals, by whichever way the light has; neighbours that are equal are integrated once.
fn irradiance_of(evaluator: &Evaluator, light: &Light, normals: &[[f64; 3]]) -> Result<Vec<[f64; 3]>> {
    let mut distinct: Vec<[f64; 3]> = Vec::new();
    let mut places = Vec::with_capacity(normals.len());
    for &normal in normals {
        if distinct.last() != Some(&normal) {
            distinct.push(normal);
        }
        places.push(distinct.len() - 1);
    }
    let found = irradiance_of_each(evaluator, light, &distinct)?;
    Ok(places.into_iter().map(|place| found[place]).collect())
}

fn irradiance_of_each(evaluator: &Evaluator, light: &Light, normals: &[[f64; 3]]) -> Result<Vec<[f64; 3]>> {
    let Light::Map(map) = light else {
        let closed = |&normal: &[f64; 3]| irradiance::in_closed_form(light, normal).unwrap_or([f64::NAN; 3]);
        return Ok(normals.iter().map(closed).collect());
    };
    let map = irradiance::PreparedMap::new(map);
    map.of(evaluator, normals, 2, &|_| Ok(()))
}
