//! Irradiance over normals.

use crate::base::error::Result;
use crate::base::timings::Timings;
use crate::light::bake::{FLOOR, Order, Truths, Values, largest, normals, timed};
use crate::light::irradiance::{Prepared, in_closed_form};
use crate::light::{Environment, Light};
use crate::reference::light as reference;
use crate::table::Table;
use crate::table::axis::Axis;
use crate::table::quantity::IRRADIANCE;
use std::time::Instant;

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
            let truths = self.irradiance_truths(&axes, &normals)?;
            self.table(&IRRADIANCE, self.name, &axes, values, FLOOR, &truths)
        })
    }

    /// E of some texels by the reference.
    pub(super) fn irradiance_truths(&self, axes: &[Axis], normals: &[[f64; 3]]) -> Result<Truths> {
        let meridians = match self.light {
            Light::Map(map) => Some(reference::Meridians::new(map)),
            _ => None,
        };
        self.truths(axes, &[], &|texel| match &meridians {
            Some(meridians) => meridians.irradiance(normals[texel]),
            None => reference::irradiance(self.light, normals[texel]),
        })
    }

    /// By twice finer and finer pieces of columns at the horizon, until two agree to half the tolerance.
    fn over_map(&self, map: &Environment, normals: &[[f64; 3]]) -> Result<Values> {
        let start = Instant::now();
        let map = Prepared::new(map);
        let prepared = start.elapsed().as_secs_f64();
        let tick = |share: f64| self.observer.advance(0.25 * share);
        let mut split = 1;
        let mut rgb = map.of(self.evaluator, normals, split, &tick)?;
        loop {
            let start = Instant::now();
            let finer = map.of(self.evaluator, normals, 2 * split, &tick)?;
            let seconds = prepared + start.elapsed().as_secs_f64();
            let floor = FLOOR * largest(&finer);
            let apart = rgb.as_flattened().iter().zip(finer.as_flattened());
            let estimate = apart.map(|(a, b)| (a - b).abs() / b.max(floor)).fold(0.0, f64::max);
            split *= 2;
            rgb = finer;
            if estimate <= 0.5 * self.tolerance || split >= FINEST_SPLIT {
                let rule = format!("cells, {split} × 2 × 2 nodes where the horizon crosses them");
                let precision = self.precision();
                return Ok(Values { rgb, rule, precision, estimate: Some(estimate), seconds });
            }
        }
    }
}

/// By closed forms.
fn closed(light: &Light, normals: &[[f64; 3]]) -> Values {
    let start = Instant::now();
    let rgb = normals.iter().map(|&n| in_closed_form(light, n).unwrap_or([f64::NAN; 3])).collect();
    Values {
        rgb,
        rule: "closed form".into(),
        precision: "f64",
        // Roundings of products and of an arc cosine.
        estimate: Some(1e-12),
        seconds: start.elapsed().as_secs_f64(),
    }
}
