//! Every evaluation of a check goes through here, so that every value is looked at, by its bits.

use crate::base::error::{Error, Result};
use crate::verify::search::Worst;
use crate::verify::{Angles, ParameterRange, Subject};

/// A subject under test.
pub(super) struct Probe<'a> {
    pub subject: &'a mut dyn Subject,
    /// Pairs of directions evaluated.
    pub evaluated: u64,
    /// Values that are NaN or infinite, and the first of them.
    pub non_finite_count: u64,
    pub non_finite: Option<Worst>,
    /// Values below zero, and the lowest.
    pub negative_count: u64,
    pub most_negative: Option<Worst>,
    channels: usize,
}

/// Pairs of directions in one call.
const CHUNK: usize = 1 << 17;

/// Whether a float is NaN or infinite: all bits of the exponent are set. No comparison of floats is asked,
/// which a compiler may assume to be finite.
pub(super) fn is_non_finite(value: f32) -> bool {
    value.to_bits() & 0x7f80_0000 == 0x7f80_0000
}

/// Whether a finite float is below zero; −0 is not.
fn is_negative(value: f32) -> bool {
    let bits = value.to_bits();
    bits > 0x8000_0000 && bits < 0xff80_0000
}

impl<'a> Probe<'a> {
    pub fn new(subject: &'a mut dyn Subject) -> Self {
        let channels = subject.channels();
        Self {
            subject,
            channels,
            evaluated: 0,
            non_finite_count: 0,
            non_finite: None,
            negative_count: 0,
            most_negative: None,
        }
    }

    pub fn parameters(&self) -> &[ParameterRange] {
        self.subject.parameters()
    }

    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Whether there is a reference, by asking for a value.
    pub fn has_reference(&self) -> bool {
        let setting: Vec<_> = self.parameters().iter().map(|p| p.at(0.5)).collect();
        let angles = Angles { theta_i: 0.5, phi_i: 0.1, theta_e: 0.6, phi_e: 2.0 };
        self.subject.reference(&setting, &angles).is_some()
    }

    /// Whether the subject has values where it is checked.
    pub fn has_values(&self) -> bool {
        let setting: Vec<_> = self.parameters().iter().map(|p| p.high).collect();
        self.subject.has_values(&setting)
    }

    /// Whether the subject has integrals of its own, by asking for none of them.
    pub fn has_integrals(&mut self) -> Result<bool> {
        Ok(self.subject.rho_dh(&[], &[])?.is_some())
    }

    /// The values at each pair, channels last.
    pub fn evaluate(&mut self, setting: &[f64], angles: &[Angles]) -> Result<Vec<f32>> {
        let mut values = Vec::with_capacity(angles.len() * self.channels);
        for chunk in angles.chunks(CHUNK) {
            self.subject.evaluate(setting, chunk, &mut values)?;
        }
        if values.len() != angles.len() * self.channels {
            let what = format!("{} values for {} pairs of directions", values.len(), angles.len());
            return Err(Error::Internal(what));
        }
        self.evaluated += angles.len() as u64;
        for (values, angles) in values.chunks_exact(self.channels).zip(angles) {
            for &value in values {
                self.look(value, setting, angles);
            }
        }
        Ok(values)
    }

    fn look(&mut self, value: f32, setting: &[f64], angles: &Angles) {
        let here = |deviation| Worst { deviation, setting: setting.to_vec(), angles: *angles };
        if is_non_finite(value) {
            self.non_finite_count += 1;
            self.non_finite.get_or_insert_with(|| here(f64::INFINITY));
        } else if is_negative(value) {
            self.negative_count += 1;
            let depth = -f64::from(value);
            if self.most_negative.as_ref().is_none_or(|lowest| depth > lowest.deviation) {
                self.most_negative = Some(here(depth));
            }
        }
    }
}
