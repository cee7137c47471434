//! Every evaluation of a check goes through here, so that every value is looked at, by its bits.

use crate::base::error::{Error, Result};
use crate::verify::search::Worst;
use crate::verify::{Angles, Extent, ParameterRange, Subject};

/// A subject under test.
pub(super) struct Probe<'a> {
    pub subject: &'a mut dyn Subject,
    /// Pairs of directions evaluated.
    pub evaluated: u64,
    /// Values that are NaN or infinite, and the first of them.
    pub non_finite_extent: Extent,
    pub non_finite: Option<Worst>,
    /// Values below zero, and the lowest; and how far below zero rounding took others.
    pub negative: Extent,
    pub most_negative: Option<Worst>,
    pub noise: f64,
    /// f where it is not small: the largest of the medians of each call's values.
    typical: f64,
    /// The zenith angles of the pairs that are judged.
    thetas: [f64; 2],
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

/// What a difference of two terms of the size of f may be below zero, 4 roundings.
const ROUNDING: f64 = 4.8e-7;
const SAMPLES: usize = 255;

/// The median of |f|, or f of a white surface where that is less.
fn typical(values: &[f32]) -> f64 {
    let step = values.len().div_ceil(SAMPLES).max(1);
    let sizes =
        values.iter().step_by(step).filter(|&&value| !is_non_finite(value)).map(|&v| f64::from(v).abs());
    let mut sizes: Vec<_> = sizes.collect();
    sizes.sort_by(f64::total_cmp);
    sizes.get(sizes.len() / 2).map_or(0.0, |median| median.min(std::f64::consts::FRAC_1_PI))
}

impl<'a> Probe<'a> {
    pub fn new(subject: &'a mut dyn Subject) -> Self {
        let (channels, thetas) = (subject.channels(), subject.thetas());
        Self {
            subject,
            channels,
            evaluated: 0,
            non_finite_extent: Extent::default(),
            non_finite: None,
            negative: Extent::default(),
            most_negative: None,
            noise: 0.0,
            typical: 0.0,
            thetas,
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
        self.typical = self.typical.max(typical(&values));
        let noise = ROUNDING * self.typical;
        for (values, angles) in values.chunks_exact(self.channels).zip(angles) {
            for &value in values {
                self.look(value, setting, angles, noise);
            }
        }
        Ok(values)
    }

    /// Takes values for rounding that were below zero before there was any f to compare them with.
    pub fn settle_negative(&mut self) {
        if let Some(depth) = self.most_negative.as_ref().map(|worst| worst.deviation)
            && depth <= ROUNDING * self.typical
        {
            (self.noise, self.most_negative, self.negative) =
                (self.noise.max(depth), None, Extent::default());
        }
    }

    /// Whether a pair is among those by which the subject is judged.
    pub fn is_judged(&self, angles: &Angles) -> bool {
        let [low, high] = self.thetas;
        // Beyond π/2 is the horizon to the bit.
        let is_within = |theta: f64| theta >= low && theta.min(std::f64::consts::FRAC_PI_2) <= high;
        is_within(angles.theta_i) && is_within(angles.theta_e)
    }

    /// The zenith angles of the pairs that are judged.
    pub fn thetas(&self) -> [f64; 2] {
        self.thetas
    }

    fn look(&mut self, value: f32, setting: &[f64], angles: &Angles, noise: f64) {
        if !is_non_finite(value) && !is_negative(value) || !self.is_judged(angles) {
            return;
        }
        let parameters = self.subject.parameters();
        let here = |deviation| Worst { deviation, setting: setting.to_vec(), angles: *angles };
        if is_non_finite(value) {
            self.non_finite_extent.add(parameters, setting, angles);
            self.non_finite.get_or_insert_with(|| here(f64::INFINITY));
        } else {
            let depth = -f64::from(value);
            if depth <= noise {
                self.noise = self.noise.max(depth);
                return;
            }
            self.negative.add(parameters, setting, angles);
            if self.most_negative.as_ref().is_none_or(|lowest| depth > lowest.deviation) {
                self.most_negative = Some(here(depth));
            }
        }
    }
}
