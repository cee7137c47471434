//! Our own models as subjects: a sum of lobes, with parameters that are fixed or have a range.

use crate::bake::points::Points;
use crate::bake::{Evaluator, Unobserved};
use crate::base::error::{Error, Result};
use crate::base::precision::{INTEGRAL_F32, VALUE_F32};
use crate::base::timings::Timings;
use crate::check::{Check, ReferenceLobe, reference_angles};
use crate::integrate::scale::LobeScale;
use crate::model::compensation::{Compensation, Factor};
use crate::model::lobe::Lobe;
use crate::model::parameters::Parameters;
use crate::model::{Integral, Violation};
use crate::plan::TablePlan;
use crate::scene::Material;
use crate::scene::planner::constant_lobes;
use crate::table::Table;
use crate::table::axis::{Axis, Variable};
use crate::table::quantity::FixedDirection;
use crate::table::quantity::RHO_DH;
use crate::verify::{Angles, Declared, FAINT, ParameterRange, Subject, Symmetry, Tolerances, albedo};
use std::cell::OnceCell;
use std::f64::consts::FRAC_PI_2;

/// A sum of weighted lobes: a material, or a model alone.
///
/// Where its parameters reach a delta, it has no values but integrals: values are then checked over the rest
/// of the range.
pub struct Sum<'a> {
    name: String,
    evaluator: &'a Evaluator,
    /// As given, for integrals; and the part of it that has values.
    whole: Vec<ParameterRange>,
    parameters: Vec<ParameterRange>,
    lobes: LobesAt<'a>,
    declared: Vec<Declared>,
    points: Option<Points<'a>>,
    /// The lobes of the setting that was evaluated last.
    last: (Vec<f64>, Vec<Lobe>),
    /// Those by the reference, once they are asked for.
    last_references: OnceCell<Option<Vec<ReferenceLobe>>>,
}

/// The lobes at a setting of the parameters.
type LobesAt<'a> = Box<dyn Fn(&[f64]) -> Result<Vec<Lobe>> + 'a>;

/// Azimuths of incidence whose ρ_dh is checked, where they differ: the others are mirror images.
const PHIS: [f64; 5] = [0.0, 0.3, 0.8, 1.2, FRAC_PI_2];

/// R, G and B, also where they are alike: the kernel of `gonio eval`, and so its bits.
const CHANNELS: usize = 3;

impl<'a> Sum<'a> {
    /// A material over all that varies in it.
    ///
    /// # Errors
    /// When a model is unknown, or the device fails.
    pub fn material(evaluator: &'a Evaluator, material: &'a Material) -> Result<Self> {
        let varying = material.varying();
        let names: Vec<_> = varying.iter().map(|(name, _)| name.clone()).collect();
        let parameters = varying.into_iter().map(|(name, [low, high])| ParameterRange::new(name, low, high));
        let lobes = move |setting: &[f64]| {
            let setting: Vec<_> = names.iter().cloned().zip(setting.iter().copied()).collect();
            constant_lobes(&material.at(&setting)?).map_err(Error::input)
        };
        let parameters = parameters.collect::<Result<_>>()?;
        let violations = material.violation().into_iter().collect();
        Self::new(material.name.clone(), evaluator, parameters, Box::new(lobes), violations)
    }

    /// A model over some of its parameters, by their names in recipes (`roughness` or `alpha`, and the weights
    /// of its components); `lobe` has the rest.
    ///
    /// # Errors
    /// When the model has no parameter of such a name, or the device fails.
    pub fn model(evaluator: &'a Evaluator, lobe: Lobe, parameters: Vec<ParameterRange>) -> Result<Self> {
        Self::compensated(evaluator, lobe, Compensation::None, parameters)
    }

    /// The same with energy compensation.
    ///
    /// # Errors
    /// When the model has no parameter of such a name, is nothing to compensate, or the device fails.
    pub fn compensated(
        evaluator: &'a Evaluator,
        lobe: Lobe,
        compensation: Compensation,
        parameters: Vec<ParameterRange>,
    ) -> Result<Self> {
        let model = lobe.model();
        let known = |name: &str| {
            model.shape.is_some_and(|shape| name == "roughness" || name == shape.name)
                || model.parameters.iter().any(|parameter| parameter.name == name)
                || model.components.iter().any(|component| component.weight == name)
        };
        if let Some(unknown) = parameters.iter().find(|parameter| !known(&parameter.name)) {
            return Err(Error::input(format!("{} has no parameter \"{}\"", model.name, unknown.name)));
        }
        let names: Vec<_> = parameters.iter().map(|parameter| parameter.name.clone()).collect();
        let lobes = move |setting: &[f64]| {
            let mut lobe = lobe.clone();
            for (name, &value) in names.iter().zip(setting) {
                match model.components.iter().position(|component| component.weight == name) {
                    Some(k) => {
                        let mut weights = lobe.weights().to_vec();
                        weights.iter_mut().for_each(|pair| pair[k] = value);
                        lobe = lobe.with_weights(weights)?;
                    }
                    None => lobe.set(name, value)?,
                }
            }
            compensation.lobes(lobe)
        };
        let violations = model.violation().into_iter().collect();
        Self::new(model.name.into(), evaluator, parameters, Box::new(lobes), violations)
    }

    fn new(
        name: String,
        evaluator: &'a Evaluator,
        whole: Vec<ParameterRange>,
        lobes: LobesAt<'a>,
        mut violations: Vec<Violation>,
    ) -> Result<Self> {
        let setting: Vec<_> = whole.iter().map(|parameter| parameter.high).collect();
        let first = lobes(&setting)?;
        let parameters = whole.iter().map(|p| with_values(p, &first)).collect::<Result<Vec<_>>>()?;
        let points = if has_values(&first) { Some(Points::new(evaluator, &first)?) } else { None };
        // What a factor breaks is said once, and of the largest bound.
        for violation in first.iter().flat_map(|lobe| lobe.factors()).flat_map(Factor::violations) {
            match violations.iter_mut().find(|known| known.property == violation.property) {
                Some(known) if known.bound >= violation.bound => {}
                Some(known) => *known = violation,
                None => violations.push(violation),
            }
        }
        let declared = violations.into_iter().map(|Violation { property, bound, source }| Declared {
            property,
            bound,
            citation: source.into(),
        });
        let declared = declared.collect();
        Ok(Self {
            name,
            evaluator,
            whole,
            parameters,
            lobes,
            declared,
            points,
            last: (setting, first),
            last_references: OnceCell::new(),
        })
    }

    /// The relative error of values in f32, the largest over the ends of the parameters.
    fn value_f32(&self) -> f64 {
        let lobes = self.corners().filter_map(|setting| (self.lobes)(&setting).ok()).flatten();
        lobes.filter_map(|lobe| value_f32_of(&lobe)).fold(VALUE_F32, f64::max)
    }

    /// Both ends of each parameter with those of the others.
    fn corners(&self) -> impl Iterator<Item = Vec<f64>> {
        (0..1usize << self.whole.len().min(8)).map(|corner| {
            let end = |(k, p): (usize, &ParameterRange)| if corner >> k & 1 == 1 { p.high } else { p.low };
            self.whole.iter().enumerate().map(end).collect()
        })
    }

    /// Whether a factor makes a lobe that is there at the parameters' upper ends depend on which direction is which.
    fn is_one_sided(&self) -> bool {
        let high: Vec<_> = self.parameters.iter().map(|parameter| parameter.high).collect();
        (self.lobes)(&high).unwrap_or_default().iter().any(|lobe| {
            let scale = LobeScale::new(lobe.factors(), lobe.roughness());
            let [there, back] = [scale.value(1.0, 0.3), scale.value(0.3, 1.0)];
            let is_there = lobe.weights().iter().any(|weight| *weight != [0.0; 2]);
            is_there && (there - back).abs() > 1e-3 * there.max(back)
        })
    }

    /// The relative error of factors, at the least roughness: there they have the fewest digits.
    fn factor_error(&self) -> f64 {
        let low: Vec<_> = self.parameters.iter().map(|parameter| parameter.low).collect();
        let lobes = (self.lobes)(&low).unwrap_or_default();
        let error = |lobe: &Lobe| match lobe.factors() {
            [] => 0.0,
            factors => LobeScale::new(factors, lobe.roughness()).error(),
        };
        lobes.iter().map(error).fold(0.0, f64::max)
    }

    /// ρ_dh by the reference, the largest of the channels.
    fn reference_rho(&self, setting: &[f64], theta_i: f64) -> Option<f64> {
        let mut rho = [0.0; CHANNELS];
        for lobe in &(self.lobes)(setting).ok()? {
            let mu = theta_i.cos().max(0.0);
            let [a, b] = ReferenceLobe::exact(lobe, None)?.rho_dh(mu, 0.0, FixedDirection::Incident);
            for (rho, [weight_a, weight_b]) in rho.iter_mut().zip(lobe.weights()) {
                *rho += weight_a * a + weight_b * b;
            }
        }
        rho.into_iter().reduce(f64::max)
    }

    /// ρ_dh of one component model over all the roughnesses and angles that are asked for.
    fn bake(&self, lobe: &Lobe, roughnesses: Vec<f64>, thetas: Vec<f64>) -> Result<Table> {
        let model = lobe.model();
        let rough = model.shape.map(|_| Axis::listed(Variable::Roughness, roughnesses));
        let axes = rough.into_iter().chain([Axis::listed(Variable::ThetaI, thetas)]);
        let about = Axis::listed(Variable::PhiI, PHIS.to_vec());
        let axes = axes.chain(model.is_anisotropic().then_some(about)).collect::<Result<_>>()?;
        let plan = TablePlan::basis(model.name, &RHO_DH, model, None, axes)?;
        let lobes = plan.lobes().iter().map(|basis| {
            basis.clone().with_parameters(lobe.parameters()).with_factors(lobe.factors().to_vec())
        });
        let lobes = lobes.collect();
        let plan = plan.with_lobes(lobes)?.with_tolerance(INTEGRAL_F32)?;
        self.evaluator.bake(&plan, Check::Sample(0), &mut Timings::default(), &Unobserved)
    }
}

/// Lobes by the reference; `None` where one has none, or a model refuses its parameters: nothing is promised of it.
fn references_of(lobes: &[Lobe]) -> Option<Vec<ReferenceLobe>> {
    let reference = |lobe: &Lobe| match lobe.model().refused(&lobe.parameters()) {
        Some(_) => None,
        None => ReferenceLobe::exact(lobe, None),
    };
    lobes.iter().map(reference).collect()
}

impl Subject for Sum<'_> {
    fn name(&self) -> String {
        self.name.clone()
    }

    fn parameters(&self) -> &[ParameterRange] {
        &self.parameters
    }

    fn integral_parameters(&self) -> &[ParameterRange] {
        &self.whole
    }

    fn channels(&self) -> usize {
        CHANNELS
    }

    fn has_values(&self, setting: &[f64]) -> bool {
        self.points.is_some() && (self.lobes)(setting).is_ok_and(|lobes| has_values(&lobes))
    }

    fn evaluate(&mut self, setting: &[f64], angles: &[Angles], out: &mut Vec<f32>) -> Result<()> {
        let points = self.points.as_mut();
        let points = points.ok_or_else(|| Error::input(format!("{} is a delta: no values", self.name)))?;
        if self.last.0 != setting {
            self.last = (setting.to_vec(), (self.lobes)(setting)?);
            self.last_references = OnceCell::new();
        }
        points.set(&self.last.1)?;
        let mut values = Vec::new();
        points.evaluate(angles, &mut values)?;
        out.append(&mut values);
        Ok(())
    }

    fn reference(&self, setting: &[f64], angles: &Angles) -> Option<Vec<f64>> {
        let at = reference_angles(angles);
        let (new_lobes, new_references);
        let (lobes, references) = if self.last.0 == setting {
            (&self.last.1, self.last_references.get_or_init(|| references_of(&self.last.1)).as_ref()?)
        } else {
            new_lobes = (self.lobes)(setting).ok()?;
            new_references = references_of(&new_lobes)?;
            (&new_lobes, &new_references)
        };
        let mut f = vec![0.0; CHANNELS];
        for (lobe, reference) in lobes.iter().zip(references) {
            let [a, b] = reference.brdf(&at)?;
            for (f, [weight_a, weight_b]) in f.iter_mut().zip(lobe.weights()) {
                *f += weight_a * a + weight_b * b;
            }
        }
        Some(f)
    }

    /// By the tables that a bake makes: ρ_dh of each model, at the tolerance that f32 has.
    fn rho_dh(&mut self, settings: &[Vec<f64>], thetas: &[f64]) -> Result<Option<Vec<f64>>> {
        let sums = settings.iter().map(|setting| (self.lobes)(setting)).collect::<Result<Vec<_>>>()?;
        if sums.iter().flatten().any(|lobe| matches!(lobe.model().integral, Integral::Unbounded(_))) {
            return Ok(None); // no table has it: the generic integral shows what is gained
        }
        let mut rho = vec![0.0; settings.len() * thetas.len() * CHANNELS];
        for k in 0..sums.first().map_or(0, Vec::len) {
            let lobes: Vec<_> = sums.iter().map(|lobes| &lobes[k]).collect();
            let roughness = |lobe: &Lobe| lobe.roughness().unwrap_or(0.0);
            let columns = sorted(thetas.iter().copied());
            // A table for each setting of what it has no axis for, over the roughnesses that come with it.
            let mut tables: Vec<(Parameters, &[Factor], Vec<f64>, Table)> = Vec::new();
            for (lobe, rho) in lobes.iter().zip(rho.chunks_exact_mut(thetas.len() * CHANNELS)) {
                if lobe.model().refused(&lobe.parameters()).is_some() {
                    continue; // nothing is promised of it
                }
                let is_of = |lobe: &Lobe, parameters: &Parameters, factors: &[Factor]| {
                    lobe.parameters() == *parameters && lobe.factors() == factors
                };
                let index = tables.iter().position(|(p, f, ..)| is_of(lobe, p, f));
                let index = match index {
                    Some(index) => index,
                    None => {
                        let alike =
                            lobes.iter().filter(|other| is_of(other, &lobe.parameters(), lobe.factors()));
                        let roughnesses = sorted(alike.map(|lobe| roughness(lobe)));
                        let table = self.bake(lobe, roughnesses.clone(), columns.clone())?;
                        tables.push((lobe.parameters(), lobe.factors(), roughnesses, table));
                        tables.len() - 1
                    }
                };
                let (.., roughnesses, table) = &tables[index];
                let row = lobe.model().shape.map_or(0, |_| index_of(roughnesses, roughness(lobe)));
                // Of azimuths, the one that reflects most.
                let azimuths = if lobe.model().is_anisotropic() { PHIS.len() } else { 1 };
                for (&theta, rho) in thetas.iter().zip(rho.chunks_exact_mut(CHANNELS)) {
                    let first = (row * columns.len() + index_of(&columns, theta)) * azimuths;
                    let texels: Vec<_> = (first..first + azimuths).map(|k| table.texel(k)).collect();
                    for (rho, weights) in rho.iter_mut().zip(lobe.weights()) {
                        let reflectance = |texel: &Vec<f64>| -> f64 {
                            weights.iter().zip(texel).map(|(weight, value)| weight * value).sum()
                        };
                        *rho += texels.iter().map(reflectance).fold(0.0, f64::max);
                    }
                }
            }
        }
        Ok(Some(rho))
    }

    /// Values as their f32 budget has it. Everything is evaluated from δφ, whose sign and turns are exact, so
    /// that symmetries cost nothing, and an exchange of ωi and ωe no more than sums in another order.
    /// Each lobe's integral is off by [`INTEGRAL_F32`] for A and for B.
    fn tolerances(&self) -> Tolerances {
        Tolerances {
            reciprocity: 1e-6,
            isotropy: 1e-6,
            bilateral: 0.0,
            agreement: self.value_f32() + self.factor_error(),
            energy: 2.0 * INTEGRAL_F32 * self.last.1.len() as f64,
        }
    }

    /// Of lobes that nothing multiplies, as it is asked for every value.
    fn agreement_at(&self, setting: &[f64]) -> Option<f64> {
        let (last, lobes) = &self.last;
        let is_known = last == setting && lobes.iter().all(|lobe| lobe.factors().is_empty());
        let errors = || lobes.iter().filter_map(value_f32_of);
        is_known.then(|| errors().fold(VALUE_F32, f64::max))
    }

    /// Where α differ, a common turn changes f.
    fn symmetry(&self) -> Symmetry {
        let anisotropic = self.last.1.iter().any(|lobe| lobe.model().is_anisotropic());
        Symmetry { isotropic: !anisotropic, bilateral: true }
    }

    fn faint(&self) -> f64 {
        self.last.1.iter().filter_map(|lobe| lobe.model().faint()).fold(FAINT, f64::max)
    }

    fn declared(&self) -> &[Declared] {
        &self.declared
    }

    /// Whether these parameters can show a declared gain of energy is for the reference to say. ρ_dh is
    /// linear in each weight, so its maximum over weights is at a corner of the ranges; of a shape both ends
    /// are tried and what is between, and θi on a list. Where the reference gains more than the device's
    /// tolerance there, the device must too.
    fn shows(&self, property: &str) -> bool {
        if property == "reciprocity" {
            return self.is_one_sided();
        }
        self.corners().chain(albedo::sweeps(&self.whole)).any(|setting: Vec<f64>| {
            let thetas = [0.0, 60.0, 80.0, 87.0, 89.5].map(f64::to_radians).into_iter().chain([FRAC_PI_2]);
            thetas.into_iter().any(|theta| {
                self.reference_rho(&setting, theta)
                    .is_some_and(|rho| rho > 1.0 + 2.0 * self.tolerances().energy)
            })
        })
    }

    fn notes(&self) -> Vec<String> {
        if self.points.is_none() {
            return vec!["a delta has no values: it is checked through its integrals alone".into()];
        }
        let low: Vec<_> = self.whole.iter().map(|parameter| parameter.low).collect();
        let lobes = (self.lobes)(&low).unwrap_or_default();
        let refused = lobes.iter().find_map(|lobe| lobe.model().refused(&lobe.parameters()));
        let refused = refused.map(|why| format!("not judged where it is refused: {why}"));
        let clipped = self.parameters.iter().zip(&self.whole).filter(|(values, whole)| values != whole);
        let clipped = clipped.map(|(values, whole)| {
            let ParameterRange { name, low, .. } = values;
            format!(
                "{name} from {} to {low} is a delta, without values: checked through its integrals alone",
                whole.low
            )
        });
        clipped.chain(refused).collect()
    }
}

fn has_values(lobes: &[Lobe]) -> bool {
    !lobes.iter().any(|lobe| lobe.is_delta())
}

/// The part of a parameter's range that has values.
fn with_values(parameter: &ParameterRange, lobes: &[Lobe]) -> Result<ParameterRange> {
    let ParameterRange { name, low, high, .. } = parameter;
    let shapes = || lobes.iter().filter_map(|lobe| lobe.model().shape);
    let least = match name.ends_with("roughness") {
        true => shapes().map(|shape| shape.roughness(shape.least)).fold(0.0, f64::max),
        false => shapes().filter(|shape| shape.name == name).map(|shape| shape.least).fold(0.0, f64::max),
    };
    if least == 0.0 {
        return Ok(parameter.clone());
    }
    if *high < least { Ok(parameter.clone()) } else { ParameterRange::new(name, low.max(least), *high) }
}

/// Increasing, each once.
fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<_> = values.collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}

/// The index of one of them.
fn index_of(values: &[f64], value: f64) -> usize {
    values.partition_point(|&v| v < value)
}

/// The relative error of a lobe's values in f32 at its own setting.
fn value_f32_of(lobe: &Lobe) -> Option<f64> {
    Some(lobe.model().value_f32_at(&lobe.setting_at(None).ok()?))
}
