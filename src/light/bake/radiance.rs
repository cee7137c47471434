//! Exitant radiance over roughness, normals and directions, and what the split sum makes of it.

use crate::base::angles::delta_phi;
use crate::base::error::Result;
use crate::base::timings::Timings;
use crate::check::ReferenceLobe;
use crate::light::bake::{
    FLOOR, MARGIN, Order, RgbValues, check_size, estimate, frames, lobes_of, reference_frames, timed,
};
use crate::light::exitant;
use crate::light::exitant::View;
use crate::model::lobe::Lobe;
use crate::scene::Material;
use crate::table::Table;
use crate::table::axis::{Axis, Variable};
use crate::table::quantity::{FixedDirection, RADIANCE, RADIANCE_SPLIT_SUM};
use gonio_reference::{Angles, light as reference};

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
        check_size(&axes, roughness.len().max(1))?;
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
        let angles_axes = axes.clone();
        let axes: Vec<_> = swept.into_iter().chain(axes).collect();
        let precision = self.precision();
        let exact = RgbValues {
            estimate: Some(estimate(&exact)),
            rgb: exact.iter().map(|one| one.value).collect(),
            rule: "cells, 2 × 2 nodes, quartered until they agree".into(),
            precision,
            seconds,
        };
        let split = RgbValues {
            rgb: split,
            rule: "pre-filtered radiance times the split sum".into(),
            precision,
            estimate: None,
            seconds: split_seconds,
        };
        observer.begin("checking radiance");
        timed(&mut stages.check, || {
            let light = self.light.to_reference()?;
            let frames = reference_frames(&angles_axes[0], &angles_axes[1]);
            let directions = views.len() / frames.len();
            let references: Vec<_> = lobes.iter().map(|lobes| References::new(lobes)).collect();
            let truths = self.truths(&axes, &lobes.concat(), &|texel| {
                let View { theta_e, phi_e, frame } = views[texel % views.len()];
                let seen = self.light.radiance(View { theta_e, phi_e, frame }.mirror());
                let frame = &frames[texel % views.len() / directions];
                let Some(references) = &references[texel / views.len()] else { return [f64::NAN; 3] };
                references.le(&light, frame, [theta_e, phi_e], seen)
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
}

/// The lobes of a material by the reference.
struct References<'a> {
    /// Those that are deltas, and those that have values.
    deltas: Vec<(&'a Lobe, ReferenceLobe)>,
    values: Vec<(&'a Lobe, ReferenceLobe)>,
    /// Their least width.
    width: f64,
}

impl<'a> References<'a> {
    /// `None` where one has no reference.
    fn new(lobes: &'a [Lobe]) -> Option<Self> {
        let all: Vec<_> = lobes
            .iter()
            .map(|lobe| Some((lobe, ReferenceLobe::exact(lobe, None)?)))
            .collect::<Option<_>>()?;
        let (deltas, values): (Vec<_>, Vec<_>) = all.into_iter().partition(|(lobe, _)| is_delta(lobe));
        let width = values.iter().filter_map(|(_, lobe)| lobe.width()).fold(1.0, f64::min);
        Some(Self { deltas, values, width })
    }

    /// Le: of a delta F L(r), of all else its definition. `seen` is L(r) as the light says it, which the reference
    /// allows where r is on a border between radiances.
    fn le(
        &self,
        light: &reference::Light,
        frame: &reference::Frame,
        exit: [f64; 2],
        seen: [f64; 3],
    ) -> [f64; 3] {
        let [theta_e, phi_e] = exit;
        let mut sum = [0.0; 3];
        if !self.values.is_empty() {
            let f = |(theta_i, phi_i): reference::Incident| {
                let angles = Angles { theta_i, phi_i, theta_e, delta_phi: delta_phi(phi_i, phi_e) };
                weighed(&self.values, |lobe| lobe.brdf(&angles).unwrap_or([f64::NAN; 2]))
            };
            sum = reference::exitant(light, frame, (theta_e, phi_e), self.width, &f);
        }
        if !self.deltas.is_empty() {
            let radiances = light.radiances(frame.mirror(theta_e, phi_e));
            let here = if radiances.contains(&seen) { Some(seen) } else { radiances.first().copied() };
            let mirrored =
                weighed(&self.deltas, |lobe| lobe.rho_dh(theta_e.cos(), 0.0, FixedDirection::Exitant));
            (0..3).for_each(|c| sum[c] += here.map_or(f64::NAN, |radiance| radiance[c]) * mirrored[c]);
        }
        sum
    }
}

/// Σ of a quantity's A and B times what a lobe weighs them with, R, G and B.
pub(super) fn weighed(
    lobes: &[(&Lobe, ReferenceLobe)],
    components: impl Fn(&ReferenceLobe) -> [f64; 2],
) -> [f64; 3] {
    lobes.iter().fold([0.0; 3], |sum, (lobe, reference)| {
        let [a, b] = components(reference);
        std::array::from_fn(|c| sum[c] + lobe.weights()[c][0] * a + lobe.weights()[c][1] * b)
    })
}

fn is_delta(lobe: &Lobe) -> bool {
    lobe.is_delta()
}
