//! Nine spherical-harmonic coefficients, of a light's radiance and of its irradiance.

use crate::bake::Evaluator;
use crate::base::error::{Error, Result};
use crate::base::precision::Precision;
use crate::base::timings::Timings;
use crate::check::Check;
use crate::light::Light;
use crate::light::bake::{Order, RgbValues, normals, timed};
use crate::light::harmonics;
use crate::light::harmonics::{Coefficients, MapFactors, TRUNCATION};
use crate::table::Table;
use crate::table::axis::{Axis, Variable};
use crate::table::quantity::{Quantity, SH, SH_IRRADIANCE};
use gonio_reference::light as reference;

/// Roundings of a term on the device, one after the other: of its two factors and products, and of sums of 16 terms and of
/// 16 such sums.
const ROUNDINGS: f64 = 36.0;
/// max |Y| over Y of l = 0, √5 of Y₂₀ at a pole: no coefficient's terms are more, all together, than this times the first
/// coefficient.
const PEAK: f64 = 2.236_067_977_499_79;

impl Order<'_> {
    /// Nine coefficients of L, and convolved those of E; with the largest error of E by them against a table of E, as a
    /// share of ∫ L dω, of which it is 3/32 at most. Their errors are relative to the largest coefficient, as the others may be
    /// what is left of terms as large.
    ///
    /// # Errors
    /// When the device fails, or the convolved ones miss E by more than the truncation explains.
    pub fn harmonics(&self, irradiance: &Table, stages: &mut Timings) -> Result<([Table; 2], f64)> {
        self.observer.begin("harmonics");
        let mut seconds = 0.0;
        let (radiance, on_device) = timed(&mut seconds, || match (self.light, self.evaluator) {
            (Light::Map(map), Evaluator::Device(_)) => {
                MapFactors::new(map).of(self.evaluator).map(|coefficients| (coefficients, true))
            }
            (light, _) => Ok((harmonics::coefficients(light), false)),
        })?;
        stages.dispatch += seconds;
        let (precision, estimate) = match on_device {
            true => (Precision::F32, PEAK * ROUNDINGS * 0.5f64.powi(24)),
            // Differences of sines over cells of 16384 columns.
            false => (Precision::F64, 1e-11),
        };
        let axes = [Axis::listed(Variable::Harmonic, (0..9).map(f64::from).collect())?];
        let table = |quantity: &'static Quantity, values: &Coefficients, truth: &Coefficients| {
            let rule = if let Light::Map(_) = self.light { "cells in closed form" } else { "closed form" };
            let values = RgbValues {
                rgb: values.to_vec(),
                rule: rule.into(),
                precision,
                estimate: Some(estimate),
                seconds,
            };
            // All nine are integrated at once.
            let truths: Vec<_> = match self.check {
                Check::Sample(0) => Vec::new(),
                _ => truth.iter().copied().enumerate().collect(),
            };
            self.table(quantity, self.name, &axes, values, 1.0, &truths)
        };
        timed(&mut stages.check, || {
            let convolved = harmonics::convolved(&radiance);
            let off = truncation(&convolved, &radiance, irradiance);
            if off > TRUNCATION + 1e-4 {
                return Err(Error::Promise(format!(
                    "three bands miss the irradiance by {off:.4} of ∫ L dω, and {TRUNCATION} is all that truncation \
                     explains"
                )));
            }
            let truth = match self.check {
                Check::Sample(0) => radiance,
                _ => reference::harmonics(&self.light.to_reference()?),
            };
            let tables = [
                table(&SH, &radiance, &truth)?,
                table(&SH_IRRADIANCE, &convolved, &harmonics::convolved(&truth))?,
            ];
            Ok((tables, off))
        })
    }
}

/// By how much the coefficients miss a table of E, as a share of ∫ L dω.
fn truncation(convolved: &Coefficients, radiance: &Coefficients, irradiance: &Table) -> f64 {
    // ∫ L dω = √(4π) L₀.
    let total = radiance[0].map(|x| x * (4.0 * std::f64::consts::PI).sqrt());
    let normals = normals(&[irradiance.axes[0].clone(), irradiance.axes[1].clone()]);
    let mut off = 0.0f64;
    for (texel, &normal) in normals.iter().enumerate() {
        let by_bands = harmonics::evaluate(convolved, normal);
        for (c, (by_bands, total)) in by_bands.into_iter().zip(total).enumerate() {
            let apart = (by_bands - irradiance.value(texel, c)).abs();
            off = off.max(if total > 0.0 { apart / total } else { 0.0 });
        }
    }
    off
}
