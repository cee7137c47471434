//! Errors, counted: of one α, or of a decade.

use crate::base::angles::Angles;
use crate::base::error::Result;
use crate::check::VALUE_FLOOR;
use rayon::prelude::*;
use serde::Serialize;

type Evaluate<'a> = dyn FnMut(&[f64], &[Angles], &mut Vec<f32>) -> Result<()> + 'a;

/// What is measured.
pub(super) struct BandSubject<'a> {
    /// 1 or 2.
    pub channels: usize,
    /// f by α, pair of directions and channel.
    pub evaluate: &'a mut Evaluate<'a>,
    /// The same in f64.
    pub reference: &'a (dyn Fn(&Angles, f64) -> [f64; 2] + Sync),
    /// A channel at an α, in the words of `gonio eval`.
    pub name: &'a dyn Fn(usize, f64) -> String,
    /// f below which f32 has lost digits to underflow, sr⁻¹; 0: where all have.
    pub faint: f64,
}

/// The errors over a range of α.
#[derive(Debug, Clone, Serialize)]
pub struct Band {
    /// The least and the largest α; none for a model without.
    pub alpha: Option<[f64; 2]>,
    /// Values that were compared.
    pub values: u64,
    /// How many of them are NaN or infinite: their error is infinite.
    pub non_finite: u64,
    /// Median relative error, to a half per cent.
    pub median: f64,
    /// Largest relative error.
    pub max: f64,
    /// Median error, in units in the last place of f32, to a half per cent.
    pub median_ulp: f64,
    /// Largest error in units in the last place.
    pub max_ulp: f64,
    /// The largest relative change as ωi and ωe are exchanged.
    pub reciprocity: f64,
    /// Values that change at all then.
    pub unequal: u64,
    /// What `max` may be, if anything is promised.
    pub promise: Option<f64>,
    /// Where `max` is.
    pub worst: Option<WorstInput>,
}

impl Band {
    /// Whether what is promised holds.
    pub fn is_kept(&self) -> bool {
        self.promise
            .is_none_or(|promise| self.max <= promise && self.reciprocity <= crate::lab::atlas::RECIPROCITY)
    }
}

/// The input of a largest error.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WorstInput {
    /// The α; of no meaning to a model without.
    pub alpha: f64,
    /// The directions.
    #[serde(flatten)]
    pub angles: Angles,
    /// The component.
    pub channel: usize,
    /// f as the device has it.
    pub value: f32,
    /// f in f64.
    pub reference: f64,
    /// Options of `gonio eval` that give it back, bit for bit.
    pub eval: String,
}

/// Errors as they come in.
pub(super) struct BandTally {
    relative: Histogram,
    ulp: Histogram,
    non_finite: u64,
    max: f64,
    max_ulp: f64,
    reciprocity: f64,
    unequal: u64,
    worst: Option<WorstInput>,
}

impl BandTally {
    pub fn new() -> Self {
        Self {
            relative: Histogram::new(),
            ulp: Histogram::new(),
            non_finite: 0,
            max: 0.0,
            max_ulp: 0.0,
            reciprocity: 0.0,
            unequal: 0,
            worst: None,
        }
    }

    /// Whether an error is larger than all before.
    fn add(&mut self, value: f32, reference: f64, floor: f64) -> bool {
        let error = (f64::from(value) - reference).abs();
        // Also where the reference is NaN: what has no truth has no error bound.
        let error = if error.is_finite() { error } else { f64::INFINITY };
        let scale = reference.abs().max(floor);
        let [relative, ulp] = [error / scale, error / spacing(scale)];
        self.relative.add(relative);
        self.ulp.add(ulp);
        self.non_finite += u64::from(relative == f64::INFINITY);
        self.max_ulp = self.max_ulp.max(ulp);
        let larger = self.worst.is_none() || relative > self.max;
        self.max = self.max.max(relative);
        larger
    }

    fn exchange(&mut self, there: f32, back: f32) {
        self.unequal += u64::from(there.to_bits() != back.to_bits());
        let [a, b] = [there, back].map(f64::from);
        let change = (a - b).abs() / a.abs().max(b.abs()).max(VALUE_FLOOR);
        // NaN − NaN and ∞ − ∞ are counted as not finite already.
        self.reciprocity = self.reciprocity.max(if change.is_finite() { change } else { 0.0 });
    }

    /// All of them together; `None` of none.
    pub fn sum<'a>(tallies: impl Iterator<Item = &'a Self>) -> Option<Self> {
        let mut sum = Self::new();
        for tally in tallies {
            sum.relative.merge(&tally.relative);
            sum.ulp.merge(&tally.ulp);
            sum.non_finite += tally.non_finite;
            if sum.worst.is_none() || tally.max > sum.max {
                sum.worst.clone_from(&tally.worst);
            }
            sum.max = sum.max.max(tally.max);
            sum.max_ulp = sum.max_ulp.max(tally.max_ulp);
            sum.reciprocity = sum.reciprocity.max(tally.reciprocity);
            sum.unequal += tally.unequal;
        }
        sum.worst.is_some().then_some(sum)
    }

    pub fn band(&self, alpha: [f64; 2], promise: Option<f64>) -> Band {
        Band {
            alpha: Some(alpha),
            values: self.relative.count,
            non_finite: self.non_finite,
            median: self.relative.median(),
            max: self.max,
            median_ulp: self.ulp.median(),
            max_ulp: self.max_ulp,
            reciprocity: self.reciprocity,
            unequal: self.unequal,
            promise,
            worst: self.worst.clone(),
        }
    }
}

/// What errors are relative to at least: [`VALUE_FLOOR`], or 2⁻¹⁰⁰ of the sum of the components. A component so
/// much smaller than the other, as Fc = x⁵ is a hair from normal incidence, is the product of a large number
/// with one that has left f32's exponents, 2⁻¹²⁶, where it loses digits and on some devices all of them.
/// A model may lose digits earlier, below its `faint`.
pub(super) fn floor(components: [f64; 2], faint: f64) -> f64 {
    VALUE_FLOOR.max(faint).max((components[0] + components[1]) * 2f64.powi(-100))
}

/// The spacing of f32 at a positive value.
fn spacing(value: f64) -> f64 {
    value.log2().floor().exp2() * f64::from(f32::EPSILON)
}

/// Counts of non-negative numbers by their size: the upper half of an f32's bits grows as it does, in steps
/// of a 128th of its power of two.
struct Histogram {
    counts: Vec<u64>,
    count: u64,
}

impl Histogram {
    fn new() -> Self {
        Self { counts: vec![0; 1 << 15], count: 0 }
    }

    fn add(&mut self, x: f64) {
        self.counts[((x as f32).to_bits() >> 16) as usize & 0x7fff] += 1;
        self.count += 1;
    }

    fn merge(&mut self, other: &Self) {
        self.counts.iter_mut().zip(&other.counts).for_each(|(a, b)| *a += b);
        self.count += other.count;
    }

    /// The middle of the step that holds it; 0 and ∞ are steps of their own.
    fn median(&self) -> f64 {
        let mut below = 0;
        let step = self.counts.iter().position(|count| {
            below += count;
            2 * below >= self.count
        });
        match step {
            None | Some(0) => 0.0,
            Some(step) if step >= 0x7f80 => f64::INFINITY,
            Some(step) => f64::from(f32::from_bits((step as u32) << 16 | 0x8000)),
        }
    }
}

/// Pairs of directions at once.
const CHUNK: usize = 1 << 13;

/// A tally for each α, of every pair of directions and its exchange.
pub(super) fn measure(
    subject: &mut BandSubject,
    alphas: &[f64],
    angles: &[Angles],
    advance: &dyn Fn(f64) -> Result<()>,
) -> Result<Vec<BandTally>> {
    let (channels, all) = (subject.channels, angles.len());
    let mut tallies: Vec<_> = alphas.iter().map(|_| BandTally::new()).collect();
    let (mut there, mut back) = (Vec::new(), Vec::new());
    for angles in angles.chunks(CHUNK) {
        let exchanged: Vec<_> = angles.iter().map(exchanged).collect();
        (subject.evaluate)(alphas, angles, &mut there)?;
        (subject.evaluate)(alphas, &exchanged, &mut back)?;
        let per_alpha = angles.len() * channels;
        let values = there.chunks_exact(per_alpha).zip(back.chunks_exact(per_alpha));
        for ((&alpha, tally), (there, back)) in alphas.iter().zip(&mut tallies).zip(values) {
            let reference = subject.reference;
            let truths: Vec<_> = angles.par_iter().map(|angles| reference(angles, alpha)).collect();
            let pairs = there.chunks_exact(channels).zip(back.chunks_exact(channels));
            for ((angles, truth), (there, back)) in angles.iter().zip(&truths).zip(pairs) {
                for channel in 0..channels {
                    let (value, reference) = (there[channel], truth[channel]);
                    if tally.add(value, reference, floor(*truth, subject.faint)) {
                        let Angles { theta_i, phi_i, theta_e, phi_e } = angles;
                        // The shortest digits that read back as the same f64, 17 at most.
                        let eval = format!(
                            "{} --theta-i {theta_i:?} --phi-i {phi_i:?} --theta-e {theta_e:?} --phi-e {phi_e:?}",
                            (subject.name)(channel, alpha)
                        );
                        tally.worst =
                            Some(WorstInput { alpha, angles: *angles, channel, value, reference, eval });
                    }
                    tally.exchange(value, back[channel]);
                }
            }
        }
        advance(angles.len() as f64 / all as f64)?;
    }
    Ok(tallies)
}

/// ωi and ωe exchanged.
fn exchanged(angles: &Angles) -> Angles {
    let Angles { theta_i, phi_i, theta_e, phi_e } = *angles;
    Angles { theta_i: theta_e, phi_i: phi_e, theta_e: theta_i, phi_e: phi_i }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A surface of f = 1, that is wrong where `fault` says so.
    fn tally(fault: impl Fn(&Angles) -> f32) -> BandTally {
        let angles = super::super::directions::everywhere(20_000);
        let mut subject = BandSubject {
            channels: 1,
            evaluate: &mut |_, angles, values| {
                values.clear();
                values.extend(angles.iter().map(&fault));
                Ok(())
            },
            reference: &|_, _| [1.0, 0.0],
            name: &|_, _| "--model test".into(),
            faint: 0.0,
        };
        measure(&mut subject, &[0.5], &angles, &|_| Ok(())).unwrap().remove(0)
    }

    #[test]
    fn a_right_subject_has_no_error() {
        let band = tally(|_| 1.0).band([0.5; 2], Some(0.0));
        assert_eq!([band.max, band.median, band.max_ulp, band.reciprocity], [0.0; 4]);
        assert!(band.is_kept() && band.values >= 20_000 && band.unequal == 0);
    }

    /// One wrong corner does not move the median, and is named.
    #[test]
    fn a_wrong_corner_is_named() {
        let wrong =
            |angles: &Angles| if angles.theta_i > 1.5 && angles.theta_e > 1.5 { 1.0 + 1e-5 } else { 1.0 };
        let band = tally(wrong).band([0.5; 2], Some(2e-6));
        assert!((band.max - 1e-5).abs() < 1e-7 && band.median == 0.0 && !band.is_kept());
        assert!((band.max_ulp - 84.0).abs() < 1.0, "{}", band.max_ulp);
        assert!(band.worst.unwrap().angles.theta_i > 1.5);
    }

    #[test]
    fn what_is_not_finite_is_counted() {
        let band =
            tally(|angles| if angles.theta_e == 0.0 { f32::NAN } else { 1.0 }).band([0.5; 2], Some(1.0));
        assert!(band.non_finite > 0 && band.max == f64::INFINITY && !band.is_kept());
        assert_eq!(band.worst.unwrap().angles.theta_e, 0.0);
    }

    #[test]
    fn what_is_not_reciprocal_is_seen() {
        let band = tally(|angles| 1.0 + 1e-4 * angles.theta_i as f32).band([0.5; 2], Some(1.0));
        assert!(band.reciprocity > 1.5e-4 && band.unequal > 10_000 && !band.is_kept());
    }

    /// A hundred errors, 1e-8 to 1e-6: the median is known to a half per cent.
    #[test]
    fn the_median_is_the_middle() {
        let mut histogram = Histogram::new();
        (1..=101).for_each(|k| histogram.add(1e-8 * f64::from(k)));
        assert!((histogram.median() / 51e-8 - 1.0).abs() < 5e-3, "{}", histogram.median());
    }
}
