//! Exitant radiance over roughness, normals and directions, and what the split sum makes of it.

use crate::base::angles::Angles;
use crate::base::error::Result;
use crate::base::timings::Timings;
use crate::check::reference_of;
use crate::light::bake::{FLOOR, MARGIN, Order, Values, estimate, frames, lobes_of, timed};
use crate::light::exitant;
use crate::light::exitant::View;
use crate::model::lobe::Lobe;
use crate::reference::light as reference;
use crate::scene::Material;
use crate::table::Table;
use crate::table::axis::{Axis, Variable};
use crate::table::quantity::{RADIANCE, RADIANCE_SPLIT_SUM};

impl Order<'_> {
    /// Le of a material over roughness (where `roughness` says one or more), normals and ωe, and beside it LD(r) (F0·A +
    /// F90·B). `axes` are θn, φn, θe and φe.
    ///
    /// # Errors
    /// When the material varies, the device fails, or a value is negative or not finite.
    pub fn radiance(
        &self,
        material: &Material,
        roughness: &[f64],
        axes: [Axis; 4],
        stages: &mut Timings,
    ) -> Result<[Table; 2]> {
        let frames = frames(&axes[0], &axes[1]);
        let directions =
            || axes[2].values().iter().flat_map(|&t| axes[3].values().iter().map(move |&p| (t, p)));
        let views: Vec<_> = frames
            .iter()
            .flat_map(|&frame| directions().map(move |(theta_e, phi_e)| View { frame, theta_e, phi_e }))
            .collect();
        let settings: Vec<Option<f64>> = match roughness {
            [] => vec![None],
            some => some.iter().copied().map(Some).collect(),
        };
        let Order { evaluator, light, observer, .. } = *self;
        let tolerance = MARGIN * self.tolerance;
        let (mut exact, mut split, mut lobes) = (Vec::new(), Vec::new(), Vec::new());
        let [mut seconds, mut split_seconds] = [0.0; 2];
        for &setting in &settings {
            let own = lobes_of(material, setting)?;
            observer.begin(&format!("{} radiance", material.name));
            exact.extend(timed(&mut seconds, || {
                exitant::radiance(evaluator, &own, light, &views, tolerance, observer)
            })?);
            split.extend(timed(&mut split_seconds, || {
                exitant::split_sum(evaluator, &own, light, &views, tolerance, observer)
            })?);
            lobes.push(own);
        }
        stages.dispatch += seconds + split_seconds;
        let subject = format!("{} under {}", material.name, self.name);
        let swept = (!roughness.is_empty())
            .then(|| Axis::listed(Variable::Roughness, roughness.to_vec()))
            .transpose()?;
        let axes: Vec<_> = swept.into_iter().chain(axes).collect();
        let precision = self.precision();
        let exact = Values {
            estimate: Some(estimate(&exact)),
            rgb: exact.iter().map(|one| one.value).collect(),
            rule: "cells, 2 × 2 nodes, quartered until they agree".into(),
            precision,
            seconds,
        };
        let split = Values {
            rgb: split,
            rule: "pre-filtered radiance times the split sum".into(),
            precision,
            estimate: None,
            seconds: split_seconds,
        };
        observer.begin("checking radiance");
        timed(&mut stages.check, || {
            let of = |texel: usize| (&lobes[texel / views.len()], &views[texel % views.len()]);
            let truths = self.truths(&axes, &lobes.concat(), &|texel| {
                let (lobes, view) = of(texel);
                self.le_by_the_reference(lobes, view)
            })?;
            let exact = self.table(&RADIANCE, &subject, &axes, exact, FLOOR, &truths)?;
            // It is held to the exact one, all of it.
            let known: Vec<_> =
                (0..exact.texels()).map(|k| (k, std::array::from_fn(|c| exact.value(k, c)))).collect();
            let mut split = self.table(&RADIANCE_SPLIT_SUM, &subject, &axes, split, FLOOR, &known)?;
            split.error.against = Some("the exact radiance".into());
            Ok([exact, split])
        })
    }

    /// Le by the reference: of a delta F L(r), of all else its definition.
    fn le_by_the_reference(&self, lobes: &[Lobe], view: &View) -> [f64; 3] {
        let (deltas, values): (Vec<_>, Vec<_>) = lobes.iter().partition(|lobe| is_delta(lobe));
        let (theta_e, phi_e) = (view.theta_e, view.phi_e);
        let f = |(theta_i, phi_i): reference::Incident| {
            let angles = Angles { theta_i, phi_i, theta_e, phi_e };
            weighed(&values, |lobe| reference_of(lobe, &angles))
        };
        let width = values.iter().filter_map(|lobe| Some(lobe.model().shape?.measure(lobe.roughness()?)));
        let width = width.fold(1.0, f64::min);
        let mut sum = [0.0; 3];
        if !values.is_empty() {
            sum = reference::exitant(self.light, &view.frame, (theta_e, phi_e), width, &f);
        }
        let mirrored = weighed(&deltas, |lobe| match (lobe.model().reference, lobe.setting_at(None)) {
            (Some(reference), Ok(setting)) => reference.rho_dh(theta_e.cos(), &setting),
            _ => [f64::NAN; 2],
        });
        let seen = self.light.radiance(view.mirror());
        (0..3).for_each(|c| sum[c] += seen[c] * mirrored[c]);
        sum
    }
}

/// Σ of a quantity's A and B times what a lobe weighs them with, R, G and B.
pub(super) fn weighed(lobes: &[&Lobe], of: impl Fn(&Lobe) -> [f64; 2]) -> [f64; 3] {
    lobes.iter().fold([0.0; 3], |sum, lobe| {
        let [a, b] = of(lobe);
        std::array::from_fn(|c| sum[c] + lobe.weights()[c][0] * a + lobe.weights()[c][1] * b)
    })
}

fn is_delta(lobe: &Lobe) -> bool {
    lobe.is_delta()
}
