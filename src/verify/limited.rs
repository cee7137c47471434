//! A subject with other tolerances, with promises that it may break, and on a part of the zenith angles.

use crate::base::error::{Error, Result};
use crate::verify::{Angles, Declared, ParameterRange, Subject, Symmetry, Tolerances};
use std::f64::consts::FRAC_PI_2;

/// What a check is to forgive.
#[derive(Debug, Clone, PartialEq)]
pub struct Exceptions {
    tolerances: Vec<(&'static str, f64)>,
    allowed: Vec<Declared>,
    theta: [f64; 2],
}

impl Default for Exceptions {
    fn default() -> Self {
        Self { tolerances: Vec::new(), allowed: Vec::new(), theta: [0.0, FRAC_PI_2] }
    }
}

/// The promises that have a tolerance, and those that may be allowed to be broken.
const TOLERANT: [&str; 5] = ["reciprocity", "isotropy", "bilateral", "agreement", "energy"];
const BOUNDED: [&str; 6] = ["non-negative", "reciprocity", "isotropy", "bilateral", "agreement", "energy"];

impl Exceptions {
    /// Holds a promise to another tolerance; the last one counts.
    ///
    /// # Errors
    /// When the promise has none, or it is no number from 0 on.
    pub fn tolerance(&mut self, promise: &str, tolerance: f64) -> Result<()> {
        let promise = name(promise, &TOLERANT)?;
        if !tolerance.is_finite() || tolerance < 0.0 {
            return Err(Error::input(format!(
                "a tolerance of {tolerance} for {promise} is no number from 0 on"
            )));
        }
        self.tolerances.push((promise, tolerance));
        Ok(())
    }

    /// Allows a promise to be broken up to a worst value, as a finding states it: energy = 1.56 allows ρ_dh of 1.56.
    ///
    /// # Errors
    /// When the promise has no such value, or it is no number from 0 on.
    pub fn allow(&mut self, promise: &str, bound: f64, citation: &str) -> Result<()> {
        let property = name(promise, &BOUNDED)?;
        if !bound.is_finite() || bound < 0.0 {
            return Err(Error::input(format!("a bound of {bound} for {property} is no number from 0 on")));
        }
        self.allowed.retain(|other| other.property != property);
        self.allowed.push(Declared { property, bound, citation: citation.into() });
        Ok(())
    }

    /// Judges by pairs whose zenith angles are both within a range, rad.
    ///
    /// # Errors
    /// When the range is not within [0, π/2], the lower end first.
    pub fn theta(&mut self, [low, high]: [f64; 2]) -> Result<()> {
        if !(0.0 <= low && low < high && high <= FRAC_PI_2) {
            return Err(Error::input(format!(
                "zenith angles from {low} to {high} rad are no range within 0..90deg"
            )));
        }
        self.theta = [low, high];
        Ok(())
    }
}

fn name(promise: &str, known: &[&'static str]) -> Result<&'static str> {
    known.iter().copied().find(|known| *known == promise).ok_or_else(|| {
        Error::input(format!("\"{promise}\" is no promise with such a value; there are {}", known.join(", ")))
    })
}

/// A subject with exceptions.
pub struct Limited<'a> {
    subject: &'a mut dyn Subject,
    exceptions: Exceptions,
    declared: Vec<Declared>,
}

impl<'a> Limited<'a> {
    /// What the subject declares itself stays declared.
    pub fn new(subject: &'a mut dyn Subject, exceptions: &Exceptions) -> Self {
        let mut declared = subject.declared().to_vec();
        declared.retain(|d| exceptions.allowed.iter().all(|allowed| allowed.property != d.property));
        declared.extend(exceptions.allowed.iter().cloned());
        Self { subject, exceptions: exceptions.clone(), declared }
    }
}

impl Subject for Limited<'_> {
    fn name(&self) -> String {
        self.subject.name()
    }

    fn parameters(&self) -> &[ParameterRange] {
        self.subject.parameters()
    }

    fn channels(&self) -> usize {
        self.subject.channels()
    }

    fn evaluate(&mut self, setting: &[f64], angles: &[Angles], out: &mut Vec<f32>) -> Result<()> {
        self.subject.evaluate(setting, angles, out)
    }

    fn reference(&self, setting: &[f64], angles: &Angles) -> Option<Vec<f64>> {
        self.subject.reference(setting, angles)
    }

    fn rho_dh(&mut self, settings: &[Vec<f64>], thetas: &[f64]) -> Result<Option<Vec<f64>>> {
        self.subject.rho_dh(settings, thetas)
    }

    fn integral_parameters(&self) -> &[ParameterRange] {
        self.subject.integral_parameters()
    }

    fn has_values(&self, setting: &[f64]) -> bool {
        self.subject.has_values(setting)
    }

    fn symmetry(&self) -> Symmetry {
        self.subject.symmetry()
    }

    fn tolerances(&self) -> Tolerances {
        let mut tolerances = self.subject.tolerances();
        for &(promise, tolerance) in &self.exceptions.tolerances {
            let place = match promise {
                "reciprocity" => &mut tolerances.reciprocity,
                "isotropy" => &mut tolerances.isotropy,
                "bilateral" => &mut tolerances.bilateral,
                "agreement" => &mut tolerances.agreement,
                _ => &mut tolerances.energy,
            };
            *place = tolerance;
        }
        tolerances
    }

    fn agreement_at(&self, setting: &[f64]) -> Option<f64> {
        let is_other = self.exceptions.tolerances.iter().any(|(promise, _)| *promise == "agreement");
        self.subject.agreement_at(setting).filter(|_| !is_other)
    }

    fn rounding(&self) -> f64 {
        self.subject.rounding()
    }

    fn faint(&self) -> f64 {
        self.subject.faint()
    }

    fn declared(&self) -> &[Declared] {
        &self.declared
    }

    /// What is allowed need not be there.
    fn shows(&self, property: &str) -> bool {
        self.exceptions.allowed.iter().all(|allowed| allowed.property != property)
            && self.subject.shows(property)
    }

    fn thetas(&self) -> [f64; 2] {
        self.exceptions.theta
    }

    fn cut_short(&self) -> Option<String> {
        self.subject.cut_short()
    }

    fn notes(&self) -> Vec<String> {
        let [low, high] = self.exceptions.theta;
        let mut notes = self.subject.notes();
        if self.exceptions.theta != [0.0, FRAC_PI_2] {
            notes.push(format!("judged from {:.4}° to {:.4}° alone", low.to_degrees(), high.to_degrees()));
        }
        notes
    }
}
