//! Tables of what light does: quantity × axes × light, or light on a material, in the same [`Table`] as all others.

use super::exitant::{self, Integrated, View};
use super::harmonics::{self, Coefficients, TRUNCATION};
use super::irradiance::{Prepared, in_closed_form};
use super::{Environment, Frame, Light, direction};
use crate::axis::{Axis, Variable};
use crate::bake::{Evaluator, Observer, Stages};
use crate::check::{Check, reference_of, sample};
use crate::error::{Error, Result};
use crate::plan::{Lobe, constant_lobes};
use crate::reference::light as reference;
use crate::scene::{Distribution, Material, Scene};
use crate::storage::Storage;
use crate::table::{ErrorKind, Table, TableError, indices};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::time::Instant;

/// Relative errors are taken of the value or of this share of the largest in the table, whichever is more: where no
/// light comes from, nothing is relative to it.
pub const FLOOR: f64 = 1e-3;

/// Cuts of a texel that the horizon crosses, at most, along each side.
const FINEST_SPLIT: u32 = 16;

/// What is baked, and how well.
pub struct Order<'a> {
    /// What evaluates.
    pub evaluator: &'a Evaluator,
    /// The light.
    pub light: &'a Light,
    /// What it is called: a file, or the words that describe it.
    pub name: &'a str,
    /// Relative, with [`FLOOR`].
    pub tolerance: f64,
    /// How many texels to compare with the reference.
    pub check: Check,
    /// Who watches.
    pub observer: &'a dyn Observer,
}

/// Values of a table before it is one.
struct Values {
    rgb: Vec<[f64; 3]>,
    rule: String,
    precision: &'static str,
    estimate: Option<f64>,
    seconds: f64,
}

impl Order<'_> {
    /// E over normals: `axes` are θn and φn.
    ///
    /// # Errors
    /// When the device fails, or a value is negative or not finite.
    pub fn irradiance(&self, axes: [Axis; 2], stages: &mut Stages) -> Result<Table> {
        self.observer.begin("irradiance");
        let normals = normals(&axes);
        let start = Instant::now();
        let values = match self.light {
            Light::Map(map) => self.over_map(map, &normals)?,
            light => Values {
                rgb: normals.iter().map(|&n| in_closed_form(light, n).unwrap_or([f64::NAN; 3])).collect(),
                rule: "closed form".into(),
                precision: "f64",
                // Roundings of products and of an arc cosine.
                estimate: Some(1e-12),
                seconds: start.elapsed().as_secs_f64(),
            },
        };
        stages.dispatch += start.elapsed().as_secs_f64();
        let start = Instant::now();
        self.observer.begin("checking irradiance");
        let meridians = match self.light {
            Light::Map(map) => Some(reference::Meridians::new(map)),
            _ => None,
        };
        let truth = |texel: usize| match &meridians {
            Some(meridians) => meridians.irradiance(normals[texel]),
            None => reference::irradiance(self.light, normals[texel]),
        };
        let table = self.table("irradiance", self.name, axes.to_vec(), values, &truth)?;
        stages.check += start.elapsed().as_secs_f64();
        Ok(table)
    }

    /// By twice finer and finer cuts of texels at the horizon, until two agree to half the tolerance.
    fn over_map(&self, map: &Environment, normals: &[[f64; 3]]) -> Result<Values> {
        let map = Prepared::new(map);
        let tick = |share: f64| self.observer.advance(0.25 * share);
        let start = Instant::now();
        let mut split = 1;
        let mut rgb = map.of(self.evaluator, normals, split, &tick)?;
        loop {
            let seconds = start.elapsed().as_secs_f64();
            let finer = map.of(self.evaluator, normals, 2 * split, &tick)?;
            let floor = FLOOR * largest(&finer);
            let apart = rgb.as_flattened().iter().zip(finer.as_flattened());
            let estimate = apart.map(|(a, b)| (a - b).abs() / b.max(floor)).fold(0.0, f64::max);
            split *= 2;
            rgb = finer;
            if estimate <= 0.5 * self.tolerance || split >= FINEST_SPLIT {
                let (on, precision) = match self.evaluator {
                    Evaluator::Device(device) if device.runs_irradiance(&map, split)? => ("", "f32"),
                    Evaluator::Device(_) => (", on the CPU: the device may stop so long a loop", "f64"),
                    Evaluator::Cpu => ("", "f64"),
                };
                let rule = format!("cells, {split} × {split} where the horizon crosses them{on}");
                return Ok(Values { rgb, rule, precision, estimate: Some(estimate), seconds });
            }
        }
    }

    /// Nine coefficients of L, and convolved those of E; with the largest error of E by them against a table of E, as a
    /// share of ∫ L dω, of which it is 3/32 at most.
    ///
    /// # Errors
    /// When the convolved ones miss E by more than the truncation explains.
    pub fn harmonics(&self, irradiance: &Table) -> Result<([Table; 2], f64)> {
        let start = Instant::now();
        let radiance = harmonics::coefficients(self.light);
        let convolved = harmonics::convolved(&radiance);
        let seconds = start.elapsed().as_secs_f64();
        let off = self.truncation(&convolved, &radiance, irradiance);
        if off > TRUNCATION + 1e-4 {
            return Err(Error::Promise(format!(
                "three bands miss the irradiance by {off:.4} of ∫ L dω, and {TRUNCATION} is all that truncation explains"
            )));
        }
        let table = |quantity: &str, unit: &str, coefficients: &Coefficients| -> Result<Table> {
            Ok(Table {
                name: quantity.into(),
                quantity: quantity.into(),
                unit: unit.into(),
                subject: self.name.into(),
                parameters: BTreeMap::new(),
                axes: vec![Axis::listed(Variable::Harmonic, (0..9).map(f64::from).collect())?],
                channels: rgb(),
                values: coefficients.as_flattened().to_vec().into(),
                rule: "closed form of every cell".into(),
                storage: Storage::F32,
                bilinear: None,
                precision: "f64".into(),
                error: unmeasured(ErrorKind::Absolute, None),
                seconds,
            })
        };
        let unit = "W m⁻²";
        Ok(([table("sh", unit, &radiance)?, table("sh_irradiance", unit, &convolved)?], off))
    }

    fn truncation(&self, convolved: &Coefficients, radiance: &Coefficients, irradiance: &Table) -> f64 {
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
        stages: &mut Stages,
    ) -> Result<[Table; 2]> {
        let frames = frames(&axes[0], &axes[1]);
        let directions = || axes[2].values.iter().flat_map(|&t| axes[3].values.iter().map(move |&p| (t, p)));
        let views: Vec<_> = frames
            .iter()
            .flat_map(|&frame| directions().map(move |(theta_e, phi_e)| View { frame, theta_e, phi_e }))
            .collect();
        let settings: Vec<Option<f64>> = match roughness {
            [] => vec![None],
            some => some.iter().copied().map(Some).collect(),
        };
        let (mut exact, mut split, mut lobes) = (Vec::new(), Vec::new(), Vec::new());
        let [mut seconds, mut split_seconds] = [0.0; 2];
        for &setting in &settings {
            let own = lobes_of(material, setting)?;
            self.observer.begin(&format!("{} radiance", material.name));
            let start = Instant::now();
            let quarter = 0.25 * self.tolerance;
            exact.extend(exitant::radiance(
                self.evaluator,
                &own,
                self.light,
                &views,
                quarter,
                self.observer,
            )?);
            seconds += start.elapsed().as_secs_f64();
            let start = Instant::now();
            split.extend(exitant::split_sum(
                self.evaluator,
                &own,
                self.light,
                &views,
                quarter,
                self.observer,
            )?);
            split_seconds += start.elapsed().as_secs_f64();
            lobes.push(own);
        }
        stages.dispatch += seconds + split_seconds;
        let start = Instant::now();
        self.observer.begin("checking radiance");
        let subject = format!("{} under {}", material.name, self.name);
        let swept = (!roughness.is_empty())
            .then(|| Axis::listed(Variable::Roughness, roughness.to_vec()))
            .transpose()?;
        let all_axes: Vec<_> = swept.into_iter().chain(axes).collect();
        let truth = |texel: usize| {
            let (lobes, view) = (&lobes[texel / views.len()], &views[texel % views.len()]);
            self.reference(lobes, view)
        };
        let estimate = estimate(&exact);
        let precision = self.precision();
        let values = Values {
            rgb: exact.iter().map(|one| one.value).collect(),
            rule: "cells, 2 × 2 nodes, quartered until they agree".into(),
            precision,
            estimate: Some(estimate),
            seconds,
        };
        let exact = self.table("radiance", &subject, all_axes.clone(), values, &truth)?;
        let values = Values {
            rgb: split,
            rule: "pre-filtered radiance times the split sum".into(),
            precision,
            estimate: None,
            seconds: split_seconds,
        };
        // It is held to the exact one, all of it.
        let known = |texel: usize| std::array::from_fn(|c| exact.value(texel, c));
        let order = Order { check: Check::All, ..*self };
        let split = order.table("radiance_split_sum", &subject, all_axes, values, &known)?;
        stages.check += start.elapsed().as_secs_f64();
        Ok([exact, split])
    }

    /// M of a material over normals, and M/E. `axes` are θn and φn.
    ///
    /// # Errors
    /// When the material varies or tells azimuths from each other, the device fails, or a value is negative or not finite.
    pub fn radiosity(
        &self,
        scene: &Scene,
        material: &str,
        axes: [Axis; 2],
        stages: &mut Stages,
    ) -> Result<[Table; 2]> {
        let irradiance = self.irradiance(axes.clone(), stages)?;
        self.observer.begin(&format!("{material} radiosity"));
        let start = Instant::now();
        let frames = frames(&axes[0], &axes[1]);
        let quarter = 0.25 * self.tolerance;
        let found = exitant::radiosity(
            self.evaluator,
            (scene, material),
            self.light,
            &frames,
            quarter,
            self.observer,
        )?;
        let seconds = start.elapsed().as_secs_f64();
        stages.dispatch += seconds;
        let subject = format!("{material} under {}", self.name);
        let values = |rgb, estimate| Values {
            rgb,
            rule: "cells, 2 × 2 nodes of ρ_dh, quartered until they agree".into(),
            precision: self.precision(),
            estimate,
            seconds,
        };
        let ratio = found.iter().enumerate().map(|(texel, one)| {
            std::array::from_fn(|c| {
                let e = irradiance.value(texel, c);
                if e > 0.0 { one.value[c] / e } else { 0.0 }
            })
        });
        let ratio = values(ratio.collect(), None);
        let radiosity = values(found.iter().map(|one| one.value).collect(), Some(estimate(&found)));
        // By Le over the hemisphere, which a reference of texels takes too long for: it is held to E and bounds instead.
        let unchecked = Order { check: Check::Sample(0), ..*self };
        let none = |_| [f64::NAN; 3];
        let mut ratio = unchecked.table("reflected_share", &subject, axes.to_vec(), ratio, &none)?;
        ratio.unit = "1".into();
        Ok([unchecked.table("radiosity", &subject, axes.to_vec(), radiosity, &none)?, ratio])
    }

    fn precision(&self) -> &'static str {
        match self.evaluator {
            Evaluator::Device(_) => "f32",
            Evaluator::Cpu => "f64",
        }
    }

    /// Le by the reference.
    fn reference(&self, lobes: &[Lobe], view: &View) -> [f64; 3] {
        let values: Vec<_> = lobes.iter().filter(|lobe| !is_delta(lobe)).collect();
        let f = |(theta_i, phi_i): (f64, f64), (theta_e, phi_e): (f64, f64)| {
            let angles = crate::points::Angles { theta_i, phi_i, theta_e, phi_e };
            values.iter().fold([0.0; 3], |sum: [f64; 3], lobe| {
                let f = reference_of(lobe, &angles);
                std::array::from_fn(|c| sum[c] + lobe.weights[c][0] * f[0] + lobe.weights[c][1] * f[1])
            })
        };
        let width = values.iter().filter_map(|lobe| Some(lobe.model.shape?.measure(lobe.roughness?)));
        let width = width.fold(1.0, f64::min);
        let exit = (view.theta_e, view.phi_e);
        let mut sum = match self.light {
            Light::Map(map) if !values.is_empty() => reference::exitant(map, &view.frame, exit, width, &f),
            Light::Constant(radiance) if !values.is_empty() => {
                let texels = vec![radiance.map(|l| l as f32); 64 * 32];
                let map = Environment::new(64, 32, texels);
                map.map_or([f64::NAN; 3], |map| reference::exitant(&map, &view.frame, exit, width, &f))
            }
            _ if values.is_empty() => [0.0; 3],
            // Other lights have no reference here.
            _ => [f64::NAN; 3],
        };
        for lobe in lobes.iter().filter(|lobe| is_delta(lobe)) {
            let Some(reference) = lobe.model.reference else { return [f64::NAN; 3] };
            let [a, b] = reference.rho_dh(view.theta_e.cos(), &lobe.setting_at(None));
            let seen = self.light.radiance(view.mirror());
            (0..3).for_each(|c| sum[c] += seen[c] * (lobe.weights[c][0] * a + lobe.weights[c][1] * b));
        }
        sum
    }

    /// The table, looked at and compared with the truth of each texel.
    fn table(
        &self,
        quantity: &str,
        subject: &str,
        axes: Vec<Axis>,
        values: Values,
        truth: &(impl Fn(usize) -> [f64; 3] + Sync),
    ) -> Result<Table> {
        let Values { rgb: values, rule, precision, estimate, seconds } = values;
        let shape: Vec<_> = axes.iter().map(Axis::len).collect();
        let texels = match self.check {
            Check::All => (0..values.len()).collect(),
            Check::Sample(n) => sample(&shape, n),
        };
        let floor = FLOOR * largest(&values);
        let mut error = unmeasured(ErrorKind::Relative, estimate);
        error.floor = Some(floor);
        let share = 1.0 / texels.len().max(1) as f64;
        let found = texels.par_iter().map(|&texel| {
            let truth = truth(texel);
            self.observer.advance(share)?;
            Ok((texel, truth))
        });
        let mut squares = 0.0;
        for (texel, truth) in found.collect::<Result<Vec<_>>>()? {
            // What the reference does not know is not compared.
            if truth.iter().all(|x| x.is_nan()) {
                continue;
            }
            error.texels_checked += 1;
            for (c, (value, truth)) in values[texel].into_iter().zip(truth).enumerate() {
                let off = (value - truth).abs() / truth.max(floor).max(f64::MIN_POSITIVE);
                let off = if off.is_nan() { f64::INFINITY } else { off };
                squares += off * off;
                if error.measured_max.is_none_or(|max| off >= max) {
                    error.measured_max = Some(off);
                    let at = axes.iter().zip(indices(&shape, texel));
                    error.worst = at.map(|(axis, k)| (axis.variable.name().into(), axis.values[k])).collect();
                    error.worst.insert("channel".into(), c as f64);
                    error.worst.insert("value".into(), value);
                    error.worst.insert("reference".into(), truth);
                }
            }
        }
        if error.texels_checked > 0 {
            error.measured_rms = Some((squares / (3 * error.texels_checked) as f64).sqrt());
        }
        let unit = if quantity.starts_with("radiance") { "W sr⁻¹ m⁻²" } else { "W m⁻²" };
        let table = Table {
            name: quantity.into(),
            quantity: quantity.into(),
            unit: unit.into(),
            subject: subject.into(),
            parameters: BTreeMap::new(),
            axes,
            channels: rgb(),
            values: values.as_flattened().iter().map(|&x| x as f32).collect::<Vec<_>>().into(),
            rule,
            storage: Storage::F32,
            bilinear: None,
            precision: precision.into(),
            error,
            seconds,
        };
        table.check_sane().map_err(|error| match error {
            Error::Promise(why) => Error::Promise(why.replace("a BRDF is", "light is")),
            error => error,
        })?;
        Ok(table)
    }

    /// Whether a table meets the tolerance, as far as it was measured.
    ///
    /// # Errors
    /// [`Error::Promise`] with the worst texel.
    pub fn within_tolerance(&self, table: &Table) -> Result<()> {
        let off = table.error.measured_max.into_iter().chain(table.error.estimate).fold(0.0, f64::max);
        if off <= self.tolerance {
            return Ok(());
        }
        Err(Error::Promise(format!(
            "table {}: its error is {off:.2e} where {:.0e} is allowed ({:?}); allow more, or bake with --device cpu",
            table.name, self.tolerance, table.error.worst
        )))
    }
}

/// The lobes of a material, at a roughness if one is given in place of its own.
///
/// # Errors
/// When it varies.
pub fn lobes_of(material: &Material, roughness: Option<f64>) -> Result<Vec<Lobe>> {
    let mut material = material.clone();
    for lobe in &mut material.lobes {
        if let (Some(own), Some(given)) = (&mut lobe.roughness, roughness) {
            *own = Distribution::constant(given);
        }
    }
    constant_lobes(&material).map_err(|why| Error::input(format!("{}: {why}", material.name)))
}

fn is_delta(lobe: &Lobe) -> bool {
    lobe.model.is_delta_at(lobe.roughness.unwrap_or(0.0))
}

fn normals(axes: &[Axis; 2]) -> Vec<[f64; 3]> {
    frames(&axes[0], &axes[1]).iter().map(Frame::normal).collect()
}

fn frames(theta: &Axis, phi: &Axis) -> Vec<Frame> {
    let row = |&theta: &f64| phi.values.iter().map(move |&phi| Frame::new(theta, phi));
    theta.values.iter().flat_map(row).collect()
}

/// The largest share of a value that is in doubt.
fn estimate(values: &[Integrated]) -> f64 {
    let mean = |one: &Integrated| one.value.iter().sum::<f64>() / 3.0;
    let floor = FLOOR * values.iter().map(mean).fold(0.0, f64::max);
    let share = |one: &Integrated| one.error / mean(one).max(floor).max(f64::MIN_POSITIVE);
    values.iter().map(share).fold(0.0, f64::max)
}

fn largest(values: &[[f64; 3]]) -> f64 {
    values.as_flattened().iter().copied().fold(0.0, f64::max)
}

fn rgb() -> Vec<String> {
    ["R", "G", "B"].map(String::from).to_vec()
}

fn unmeasured(kind: ErrorKind, estimate: Option<f64>) -> TableError {
    TableError {
        kind,
        floor: None,
        estimate,
        measured_max: None,
        measured_rms: None,
        texels_checked: 0,
        underflows: None,
        interpolation: None,
        worst: BTreeMap::new(),
    }
}

/// The radiance of the mirror direction of a normal, which a perfect mirror shows: the map itself.
pub fn reflected(light: &Light, frame: &Frame, theta_e: f64, phi_e: f64) -> [f64; 3] {
    let [x, y, z] = direction(theta_e, phi_e);
    light.radiance(frame.to_world([-x, -y, z]))
}
