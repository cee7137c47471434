//! What the picture of a light shows: the light, its irradiance beside it, and a sphere of the material lit by it.

use crate::bake::{Evaluator, Observer};
use crate::base::error::Result;
use crate::figure::light;
use crate::figure::light::{Ball, Sheet};
use crate::light::bake::lobes_of;
use crate::light::exitant;
use crate::light::exitant::View;
use crate::light::irradiance::{PreparedMap, in_closed_form};
use crate::light::{Frame, Light, direction};
use crate::model::lobe::Lobe;
use crate::scene::Material;
use std::f64::consts::{PI, TAU};

/// Columns and rows of the light and of its irradiance, as they are drawn.
const LIGHT: [usize; 2] = [640, 320];
const IRRADIANCE: [usize; 2] = [160, 80];
/// Pixels along a sphere's side; of one that only mirrors, which takes no integral, as many as are drawn.
const SIDE: usize = 36;
const MIRROR_SIDE: usize = 240;
/// Of a sphere that is looked at: single pixels may be off by so much, and most are by far less.
const TOLERANCE: f64 = 0.1;
/// Spheres in a picture.
const MOST: usize = 5;

/// The bytes of a PNG file.
pub fn draw(
    light: &Light,
    name: &str,
    materials: &[&Material],
    roughness: &[f64],
    evaluator: &Evaluator,
    observer: &dyn Observer,
) -> Result<Vec<u8>> {
    let radiance = over(LIGHT, |towards| light.radiance(towards));
    let irradiance = irradiance(light, evaluator, observer)?;
    let mut balls = Vec::new();
    for material in materials {
        let settings: Vec<_> = match roughness {
            [] => vec![None],
            some => some.iter().take(MOST).copied().map(Some).collect(),
        };
        for setting in settings {
            let label = match setting {
                Some(roughness) => format!("{}, roughness {roughness}", material.name),
                None => material.name.clone(),
            };
            let lobes = lobes_of(material, setting)?;
            let side = if lobes.iter().all(is_delta) { MIRROR_SIDE } else { SIDE };
            balls.push(Ball { label, side, pixels: ball(&lobes, side, light, evaluator, observer)? });
        }
    }
    // What a white diffuse surface sends, in the median of its orientations, is a middle grey.
    let mut greys: Vec<f64> = irradiance.iter().map(|e| e.iter().sum::<f64>() / (3.0 * PI)).collect();
    greys.sort_by(f64::total_cmp);
    let white = greys[greys.len() / 2].max(1e-3 * greys[greys.len() - 1]).max(f64::MIN_POSITIVE);
    let scaled = |values: Vec<[f64; 3]>, by: f64| -> Vec<[f64; 3]> {
        values.into_iter().map(|v| v.map(|x| 0.6 * x / (white * by))).collect()
    };
    for ball in &mut balls {
        ball.pixels = scaled(std::mem::take(&mut ball.pixels), 1.0);
    }
    light::draw(&Sheet {
        title: name.to_owned(),
        subtitle: light.summary(),
        radiance: (LIGHT[0], scaled(radiance, 1.0)),
        irradiance: (IRRADIANCE[0], scaled(irradiance, PI)),
        balls,
    })
}

/// What is seen from inside in each direction, row by row from the zenith, longitude falling from π to −π.
fn over<T>([columns, rows]: [usize; 2], mut at: impl FnMut([f64; 3]) -> T) -> Vec<T> {
    let mut all = Vec::with_capacity(columns * rows);
    for row in 0..rows {
        for column in 0..columns {
            let theta = PI * (row as f64 + 0.5) / rows as f64;
            let phi = PI - TAU * (column as f64 + 0.5) / columns as f64;
            all.push(at(direction(theta, phi)));
        }
    }
    all
}

fn irradiance(light: &Light, evaluator: &Evaluator, observer: &dyn Observer) -> Result<Vec<[f64; 3]>> {
    let normals = over(IRRADIANCE, |normal| normal);
    match light {
        Light::Map(map) => {
            PreparedMap::new(map).of(evaluator, &normals, 1, &|share| observer.advance(0.2 * share))
        }
        light => Ok(normals.iter().map(|&n| in_closed_form(light, n).unwrap_or_default()).collect()),
    }
}

/// Le of each pixel of a sphere, towards an eye far away at −x that has z above it: behind the sphere it sees the middle
/// of the map. Deltas show the map itself, and the rest a coarser one, which is what they blur it to anyway.
fn ball(
    lobes: &[Lobe],
    side: usize,
    light: &Light,
    evaluator: &Evaluator,
    observer: &dyn Observer,
) -> Result<Vec<[f64; 3]>> {
    let eye = [-1.0, 0.0, 0.0];
    let middle = |k: usize| (2 * k + 1) as f64 / side as f64 - 1.0;
    let (mut places, mut views) = (Vec::new(), Vec::new());
    for row in 0..side {
        for column in 0..side {
            let (right, up) = (middle(column), -middle(row));
            let towards = 1.0 - right * right - up * up;
            if towards <= 0.0 {
                continue;
            }
            let normal = [-towards.sqrt(), -right, up];
            let (theta, phi) = (right.hypot(normal[0]).atan2(up), normal[1].atan2(normal[0]));
            let frame = Frame::new(theta, phi);
            let [x, y, z] = frame.to_local(eye);
            places.push(row * side + column);
            views.push(View { frame, theta_e: x.hypot(y).atan2(z), phi_e: y.atan2(x) });
        }
    }
    let (deltas, rest): (Vec<_>, Vec<_>) = lobes.iter().cloned().partition(is_delta);
    let coarse = match light {
        Light::Map(map) => Light::Map(map.reduced(64, 32)),
        light => light.clone(),
    };
    let mut pixels = vec![[f64::NAN; 3]; side * side];
    let sharp = exitant::radiance(evaluator, &deltas, light, &views, TOLERANCE, observer)?;
    let soft = exitant::radiance(evaluator, &rest, &coarse, &views, TOLERANCE, observer)?;
    for ((place, sharp), soft) in places.into_iter().zip(sharp).zip(soft) {
        pixels[place] = std::array::from_fn(|c| sharp.value[c] + soft.value[c]);
    }
    Ok(pixels)
}

fn is_delta(lobe: &Lobe) -> bool {
    lobe.is_delta()
}
