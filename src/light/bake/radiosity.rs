//! Radiosity over normals, and what share of the irradiance it is.

use crate::base::error::Result;
use crate::base::timings::Timings;
use crate::check::{Check, ReferenceLobe};
use crate::light::bake::radiance::weighed;
use crate::light::bake::{
    FLOOR, MARGIN, Order, RgbValues, Truths, estimate, frames, lobes_of, reference_frames, timed,
};
use crate::light::exitant;
use crate::model::lobe::Lobe;
use crate::scene::Scene;
use crate::table::Table;
use crate::table::axis::Axis;
use crate::table::quantity::{FixedDirection, RADIOSITY, REFLECTED_SHARE};
use gonio_reference::light as reference;

impl Order<'_> {
    /// M of a material over normals, and M/E. `axes` are θn and φn.
    ///
    /// # Errors
    /// When the material varies or tells azimuths from each other, the device fails, or a value is negative or not finite.
    pub fn radiosity(
        &self,
        scene: &Scene,
        material: &str,
        axes: [Axis; 2],
        stages: &mut Timings,
    ) -> Result<[Table; 2]> {
        let lobes = lobes_of(scene.material(material)?, None)?;
        // E is held to the reference with M.
        let unchecked = Order { check: Check::Sample(0), ..*self };
        let irradiance = unchecked.irradiance(axes.clone(), stages)?;
        self.observer.begin(&format!("{material} radiosity"));
        let frames = frames(&axes[0], &axes[1]);
        let tolerance = MARGIN * self.tolerance;
        let mut seconds = 0.0;
        let found = timed(&mut seconds, || {
            let lit = (scene, material);
            exitant::radiosity(self.evaluator, lit, self.light, &frames, tolerance, self.observer)
        })?;
        stages.dispatch += seconds;
        let subject = format!("{material} under {}", self.name);
        let values = |rgb, estimate| RgbValues {
            rgb,
            rule: "cells, 2 × 2 nodes of ρ_dh, quartered until they agree".into(),
            precision: self.precision(),
            estimate,
            seconds,
        };
        let share =
            |m: [f64; 3], e: [f64; 3]| std::array::from_fn(|c| if e[c] > 0.0 { m[c] / e[c] } else { 0.0 });
        let e = |texel| std::array::from_fn(|c| irradiance.value(texel, c));
        let ratio = found.iter().enumerate().map(|(texel, one)| share(one.value, e(texel)));
        let ratio = values(ratio.collect(), None);
        let radiosity = values(found.iter().map(|one| one.value).collect(), Some(estimate(&found)));
        self.observer.begin(&format!("checking {material} radiosity"));
        timed(&mut stages.check, || {
            let m = self.radiosity_truths(&axes, &lobes)?;
            let e = if m.is_empty() { Vec::new() } else { self.irradiance_truths(&axes)? };
            let shares: Vec<_> =
                m.iter().zip(&e).map(|(&(texel, m), &(_, e))| (texel, share(m, e))).collect();
            Ok([
                self.table(&RADIOSITY, &subject, &axes, radiosity, FLOOR, &m)?,
                self.table(&REFLECTED_SHARE, &subject, &axes, ratio, FLOOR, &shares)?,
            ])
        })
    }

    /// M of some texels by the reference.
    fn radiosity_truths(&self, axes: &[Axis; 2], lobes: &[Lobe]) -> Result<Truths> {
        let references: Option<Vec<_>> =
            lobes.iter().map(|lobe| Some((lobe, ReferenceLobe::exact(lobe, None)?))).collect();
        let Some(references) = references.filter(|_| self.check != Check::Sample(0)) else {
            return Ok(Vec::new());
        };
        let albedo = reference::Albedo::new(&|theta_i: f64| {
            weighed(&references, |lobe| lobe.rho_dh(theta_i.cos(), 0.0, FixedDirection::Incident))
        });
        let (light, frames) = (self.light.to_reference()?, reference_frames(&axes[0], &axes[1]));
        self.truths(axes, lobes, &|texel| reference::radiosity(&light, &frames[texel], &albedo))
    }
}
