//! Evaluates a BRDF at any list of pairs of directions. Values come back as the device computes them, never sanitised, so
//! that faults stay visible.
//!
//! ```
//! use gonio::bake::{Evaluator, points::Points};
//! use gonio::{base::angles::Angles, model, model::lobe::Lobe};
//!
//! # fn main() -> gonio::Result<()> {
//! // F0 = 1 and F90 = 1: GGX without Fresnel.
//! let lobe = Lobe::new(model::find("ggx")?, Some(0.3), vec![[1.0, 1.0]])?;
//! let mut points = Points::new(&Evaluator::Cpu, &[lobe])?;
//! let mut values = Vec::new();
//! points.evaluate(&[Angles { theta_i: 0.5, phi_i: 0.0, theta_e: 0.4, phi_e: 3.0 }], &mut values)?;
//! assert_eq!(values.len(), 1);
//! # Ok(())
//! # }
//! ```

use crate::backend::gpu;
use crate::backend::scaled_lobe::ScaledLobe;
use crate::bake::Evaluator;
use crate::base::angles::Angles;
use crate::base::error::{Error, Result};
use crate::base::half_angle::{Azimuth, Pair};
use crate::model::Shape;
use crate::model::lobe::Lobe;
use rayon::prelude::*;

/// Evaluates a sum of lobes at lists of directions. Pipelines and buffers are made once and kept, so a
/// long-lived one is worth having; memory is bounded, however long the lists.
pub struct Points<'a> {
    lobes: Vec<Lobe>,
    path: PointsPath<'a>,
}

/// The path that evaluates points.
enum PointsPath<'a> {
    Device(Box<gpu::PointKernels<'a>>),
    Cpu,
}

impl<'a> Points<'a> {
    /// Makes the evaluator of a sum of lobes, which all have the same channels, 1 to 3.
    ///
    /// # Errors
    /// When a lobe is a delta, the channels do not fit, or the device fails.
    pub fn new(evaluator: &'a Evaluator, lobes: &[Lobe]) -> Result<Self> {
        let channels = lobes.first().map_or(0, |lobe| lobe.weights().len());
        if !(1..=3).contains(&channels) || lobes.iter().any(|lobe| lobe.weights().len() != channels) {
            return Err(Error::input("a list of points takes one lobe or more, all of 1 to 3 channels"));
        }
        if let Some(lobe) = lobes.iter().find(|lobe| lobe.model().is_delta()) {
            return Err(Error::input(format!("{} is a delta and has no values", lobe.model().name)));
        }
        let path = match evaluator {
            Evaluator::Device(device) => PointsPath::Device(Box::new(gpu::PointKernels::new(device, lobes)?)),
            Evaluator::Cpu => PointsPath::Cpu,
        };
        Ok(Self { lobes: lobes.to_vec(), path })
    }

    /// Sets other weights and roughnesses for the same models, and keeps pipelines and buffers.
    ///
    /// # Errors
    /// When the models or the channels differ.
    pub fn set(&mut self, lobes: &[Lobe]) -> Result<()> {
        let shape = |lobe: &Lobe| (lobe.model().name, lobe.weights().len());
        if !self.lobes.iter().map(shape).eq(lobes.iter().map(shape)) {
            return Err(Error::input("a list of points keeps its models and its channels"));
        }
        self.lobes.clone_from_slice(lobes);
        if let PointsPath::Device(points) = &mut self.path {
            points.set(lobes);
        }
        Ok(())
    }

    /// The number of channels of a value.
    pub fn channels(&self) -> usize {
        self.lobes[0].weights().len()
    }

    /// Evaluates f, sr⁻¹, at each pair and for each channel, bit by bit as it is computed, and replaces the contents of
    /// `values`.
    ///
    /// # Errors
    /// When angles are out of range, a lobe that needs a roughness has none, or the device fails.
    pub fn evaluate(&mut self, angles: &[Angles], values: &mut Vec<f32>) -> Result<()> {
        let alphas = self.lobes.iter().map(|lobe| {
            let no_roughness = || Error::input(format!("{} needs a roughness", lobe.model().name));
            let Some(shape) = lobe.model().shape else { return Ok(0.0) };
            in_range(&shape, shape.measure(lobe.roughness().ok_or_else(no_roughness)?))
        });
        let scaled =
            |(lobe, alpha): (&Lobe, Result<f64>)| Ok(ScaledLobe::new(lobe, alpha?, lobe.roughness()));
        let setting = self.lobes.iter().zip(alphas).map(scaled).collect::<Result<Vec<_>>>()?;
        self.run(&[setting], angles, values)
    }

    /// Evaluates f at each of some α, the model's own measure of its shape, which takes the place of every lobe's roughness:
    /// the values of the first α at all pairs come first, then those of the second. It is faster than one evaluation after
    /// the other, as the pairs' half-angle terms are computed once.
    ///
    /// # Errors
    /// When angles or an α are out of range, or the device fails.
    pub fn sweep(&mut self, alphas: &[f64], angles: &[Angles], values: &mut Vec<f32>) -> Result<()> {
        let setting = |alpha: f64| -> Result<Vec<ScaledLobe>> {
            let scaled = |lobe: &Lobe| {
                let Some(shape) = lobe.model().shape else { return Ok(ScaledLobe::new(lobe, 0.0, None)) };
                Ok(ScaledLobe::new(lobe, in_range(&shape, alpha)?, Some(shape.roughness(alpha))))
            };
            self.lobes.iter().map(scaled).collect()
        };
        let settings = alphas.iter().map(|&alpha| setting(alpha)).collect::<Result<Vec<_>>>()?;
        self.run(&settings, angles, values)
    }

    /// Evaluates all settings; a setting has an α and a scale for each lobe.
    fn run(&mut self, settings: &[Vec<ScaledLobe>], angles: &[Angles], values: &mut Vec<f32>) -> Result<()> {
        if let Some((k, Err(why))) =
            angles.par_iter().map(Angles::check).enumerate().find_first(|(_, checked)| checked.is_err())
        {
            return Err(why.at(format!("point {k}")));
        }
        let channels = self.channels();
        let per_setting = angles.len() * channels;
        // A value that is not computed stays NaN.
        values.clear();
        values.resize(settings.len() * per_setting, f32::NAN);
        if values.is_empty() {
            return Ok(());
        }
        match &mut self.path {
            PointsPath::Device(points) => {
                let on_device = |setting: &Vec<ScaledLobe>| -> Vec<ScaledLobe> {
                    let lobes = self.lobes.iter().zip(setting);
                    let rounded = |(lobe, scaled): (&Lobe, &ScaledLobe)| ScaledLobe {
                        alpha: lobe.model().on_device(scaled.alpha),
                        scale: scaled.scale.clone(),
                    };
                    lobes.map(rounded).collect()
                };
                let settings: Vec<_> = settings.iter().map(on_device).collect();
                points.evaluate(&settings, angles, values)
            }
            PointsPath::Cpu => {
                for (k, angles) in angles.chunks(CPU_CHUNK).enumerate() {
                    let factors: Vec<_> = angles.par_iter().map(Angles::factors).collect();
                    for (alphas, values) in settings.iter().zip(values.chunks_mut(per_setting)) {
                        let values = &mut values[k * CPU_CHUNK * channels..][..factors.len() * channels];
                        let points = factors.par_iter().zip(values.par_chunks_mut(channels));
                        points.for_each(|(factors, out)| twins(&self.lobes, alphas, factors, out));
                    }
                }
                Ok(())
            }
        }
    }
}

/// The number of pairs whose half-angle terms the CPU path holds at once: 6 MiB.
const CPU_CHUNK: usize = 1 << 16;

/// Evaluates one value by the lobes' f64 twins.
fn twins(lobes: &[Lobe], setting: &[ScaledLobe], (pair, azimuth): &(Pair, Azimuth), out: &mut [f32]) {
    let mut sums = [0.0; 3];
    for (lobe, scaled) in lobes.iter().zip(setting) {
        let [a, b] = (lobe.model().lobe)(pair, azimuth, &lobe.setting(scaled.alpha));
        let scale = scaled.scale.value(pair.mu_i, pair.mu_e);
        for (sum, [weight_a, weight_b]) in sums.iter_mut().zip(lobe.weights()) {
            *sum += scale * (weight_a * a + weight_b * b);
        }
    }
    for (out, sum) in out.iter_mut().zip(sums) {
        *out = sum as f32;
    }
}

/// Checks that the model has values at a measure of its shape.
fn in_range(shape: &Shape, alpha: f64) -> Result<f64> {
    let &Shape { name, least, most, .. } = shape;
    if (least..=most).contains(&alpha) {
        return Ok(shape.taken(alpha));
    }
    let delta = if least > 0.0 { ": below it is a delta, without values" } else { "" };
    Err(Error::input(format!("{name} = {alpha} is outside [{least:e}, {most}]{delta}")))
}
