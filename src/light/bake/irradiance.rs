//! Irradiance over normals.

use crate::base::error::Result;
use crate::base::timings::Stopwatch;
use crate::base::timings::Timings;
use crate::light::bake::{FLOOR, Order, RgbValues, Truths, largest, normals, reference_frames, timed};
use crate::light::irradiance::{PreparedMap, in_closed_form};
use crate::light::{Environment, Light};
use crate::table::Table;
use crate::table::axis::Axis;
use crate::table::quantity::IRRADIANCE;
use gonio_reference::light as reference;

/// Pieces of a column that the horizon crosses, at most.
const FINEST_SPLIT: u32 = 16;

impl Order<'_> {
    /// E over normals: `axes` are θn and φn.
    ///
    /// # Errors
    /// When the device fails, or a value is negative or not finite.
    pub fn irradiance(&self, axes: [Axis; 2], stages: &mut Timings) -> Result<Table> {
        self.observer.begin("irradiance");
        let normals = normals(&axes);
        let values = timed(&mut stages.dispatch, || match self.light {
            Light::Map(map) => self.over_map(map, &normals),
            light => Ok(closed(light, &normals)),
        })?;
        self.observer.begin("checking irradiance");
        timed(&mut stages.check, || {
            let truths = self.irradiance_truths(&axes)?;
            self.table(&IRRADIANCE, self.name, &axes, values, FLOOR, &truths)
        })
    }

    /// E of some texels by the reference.
    pub(super) fn irradiance_truths(&self, axes: &[Axis; 2]) -> Result<Truths> {
        let light = self.light.to_reference()?;
        let meridians = match light {
            reference::Light::Map(map) => Some(reference::Meridians::new(map)),
            _ => None,
        };
        let frames = reference_frames(&axes[0], &axes[1]);
        self.truths(axes, &[], &|texel| match &meridians {
            Some(meridians) => meridians.irradiance(frames[texel].normal()),
            None => reference::irradiance(&light, frames[texel].normal()),
        })
    }

    /// By twice finer and finer pieces of columns at the horizon, until two agree to half the tolerance.
    fn over_map(&self, map: &Environment, normals: &[[f64; 3]]) -> Result<RgbValues> {
        let start = Stopwatch::start();
        let map = PreparedMap::new(map);
        let prepared = start.seconds();
        let tick = |share: f64| self.observer.advance(0.25 * share);
        let mut split = 1;
        let mut rgb = map.of(self.evaluator, normals, split, &tick)?;
        loop {
            let start = Stopwatch::start();
            let finer = map.of(self.evaluator, normals, 2 * split, &tick)?;
            let seconds = prepared + start.seconds();
            let floor = FLOOR * largest(&finer);
            let apart = rgb.as_flattened().iter().zip(finer.as_flattened());
            let estimate = apart.map(|(a, b)| (a - b).abs() / b.max(floor)).fold(0.0, f64::max);
            split *= 2;
            rgb = finer;
            if estimate <= 0.5 * self.tolerance || split >= FINEST_SPLIT {
                let rule = format!("cells, {split} × 2 × 2 nodes where the horizon crosses them");
                let precision = self.precision();
                return Ok(RgbValues { rgb, rule, precision, estimate: Some(estimate), seconds });
            }
        }
    }
}

/// By closed forms.
fn closed(light: &Light, normals: &[[f64; 3]]) -> RgbValues {
    let start = Stopwatch::start();
    let rgb = normals.iter().map(|&n| in_closed_form(light, n).unwrap_or([f64::NAN; 3])).collect();
    RgbValues {
        rgb,
        rule: "closed form".into(),
        precision: "f64",
        // Roundings of products and of an arc cosine.
        estimate: Some(1e-12),
        seconds: start.seconds(),
    }
}
