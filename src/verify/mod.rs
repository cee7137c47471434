//! The promises of a BRDF, and the worst input that breaks them.
//!
//! [`check`] takes a [`Subject`], anything that evaluates f(ωi, ωe) at lists of angles, and hunts for the
//! worst input of each promise, in the arithmetic that the subject has (a device's f32, as a rule):
//!
//! | promise | what is measured |
//! |---|---|
//! | `finite` | NaN and infinity, by bits, among all values that were looked at |
//! | `non-negative` | −f |
//! | `reciprocity` | f(ωi, ωe) against f(ωe, ωi) (Helmholtz) |
//! | `isotropy` | f against f of the same pair turned about the normal |
//! | `bilateral` | f against f of the pair's mirror image, φ → −φ |
//! | `agreement` | f against the subject's f64 reference, where it has one |
//! | `energy` | ρ_dh(ωi) = ∫ f cos θe dωe ≤ 1 (the white furnace) |
//!
//! Inputs are a dense grid that holds the extremes, low-discrepancy points that crowd where BRDFs break
//! (grazing, the mirror direction), at the ends of each parameter and between, and then a search around
//! the worst of them over angles and parameters. All of it is deterministic.
//!
//! A check of finitely many inputs proves that a promise is broken, never that it is kept: a fault smaller
//! than the spacing of the inputs, with nothing around it to follow, is found only by luck.

mod agreement;
mod albedo;
mod bits;
mod energy;
mod extent;
mod hemisphere;
mod inputs;
mod limited;
mod limits;
mod probe;
mod reciprocity;
mod report;
mod search;
mod sequence;
mod sum;
mod symmetry;
pub mod user_shader;

pub use agreement::FAINT;
pub use extent::Extent;
pub use limited::{Exceptions, Limited};
pub use report::{Finding, Input, Report, Verdict};
pub use sum::Sum;

use crate::bake::{Observer, Unobserved};
use crate::base::angles::Angles;
use crate::base::error::{Error, Result};
use inputs::Inputs;
use probe::Probe;

/// A parameter of a subject, and where it is checked.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterRange {
    /// Its name.
    pub name: String,
    /// The range, both ends included; equal where it is fixed.
    pub low: f64,
    /// The upper end.
    pub high: f64,
    /// Whether its values are spread by their logarithms; `low` is positive then.
    pub logarithmic: bool,
    /// Whether it has whole numbers only.
    pub integer: bool,
}

impl ParameterRange {
    /// A parameter over a range, logarithmic where it spans two decades or more.
    ///
    /// # Errors
    /// When an end is not finite, or the range is empty.
    pub fn new(name: impl Into<String>, low: f64, high: f64) -> Result<Self> {
        let name = name.into();
        if !low.is_finite() || !high.is_finite() || low > high {
            return Err(Error::input(format!(
                "parameter {name}: {low}..{high} is no range of finite numbers, the lower first"
            )));
        }
        Ok(Self { name, low, high, logarithmic: low > 0.0 && high >= 100.0 * low, integer: false })
    }

    /// The same range of whole numbers.
    ///
    /// # Errors
    /// When an end is no whole number.
    pub fn whole(self) -> Result<Self> {
        match [self.low, self.high].into_iter().find(|end| end.fract() != 0.0) {
            Some(end) => Err(Error::input(format!("parameter {}: {end} is no whole number", self.name))),
            None => Ok(Self { integer: true, ..self }),
        }
    }

    /// The value at u in [0, 1].
    fn at(&self, u: f64) -> f64 {
        let value = match self.logarithmic {
            true => self.low * (self.high / self.low).powf(u),
            false => self.low + u * (self.high - self.low),
        };
        let value = if self.integer { value.round() } else { value };
        value.clamp(self.low, self.high)
    }

    /// The u in [0, 1] of a value.
    fn place(&self, value: f64) -> f64 {
        let u = match self.logarithmic {
            _ if self.low == self.high => 0.0,
            true => (value / self.low).ln() / (self.high / self.low).ln(),
            false => (value - self.low) / (self.high - self.low),
        };
        u.clamp(0.0, 1.0)
    }
}

/// What is checked.
pub trait Subject {
    /// What it is, for people.
    fn name(&self) -> String;

    /// Its parameters, in the order of a setting.
    fn parameters(&self) -> &[ParameterRange];

    /// Values for each pair of directions, 1 to 3.
    fn channels(&self) -> usize;

    /// Appends f in sr⁻¹, without the cosine, at each pair, channels last: the very bits that the device
    /// returned. `setting` has one value for each parameter.
    fn evaluate(&mut self, setting: &[f64], angles: &[Angles], out: &mut Vec<f32>) -> Result<()>;

    /// f by an independent reference, where there is one.
    fn reference(&self, _setting: &[f64], _angles: &Angles) -> Option<Vec<f64>> {
        None
    }

    /// ρ_dh by integrals of its own that are better than the generic one, where there are some: at each setting
    /// and each θi, channels last.
    fn rho_dh(&mut self, _settings: &[Vec<f64>], _thetas: &[f64]) -> Result<Option<Vec<f64>>> {
        Ok(None)
    }

    /// The ranges over which it integrates, in the order of [`Subject::parameters`]: wider where a limit is a
    /// delta, which has integrals but no values.
    fn integral_parameters(&self) -> &[ParameterRange] {
        self.parameters()
    }

    /// Whether it has values at a setting: a delta has none, and is checked through its integrals.
    fn has_values(&self, _setting: &[f64]) -> bool {
        true
    }

    /// The symmetries that it promises.
    fn symmetry(&self) -> Symmetry {
        Symmetry { isotropic: true, bilateral: true }
    }

    /// How far from its promises it may be for rounding's sake.
    fn tolerances(&self) -> Tolerances {
        Tolerances::default()
    }

    /// What rounding may cost of its agreement at one setting, where that is less than at the worst.
    fn agreement_at(&self, _setting: &[f64]) -> Option<f64> {
        None
    }

    /// How far the directions that it computes with may be from unit length: 0 where it works from angles,
    /// 2⁻²⁴ where they are vectors in f32.
    fn rounding(&self) -> f64 {
        0.0
    }

    /// f below which it is compared with its reference absolutely, sr⁻¹.
    fn faint(&self) -> f64 {
        FAINT
    }

    /// The promises that it is known to break.
    fn declared(&self) -> &[Declared] {
        &[]
    }

    /// Whether the parameters' ranges can show a declared violation; if they can, its absence is a fault: the
    /// declaration is wrong, or the check is blind.
    fn shows(&self, _property: &str) -> bool {
        true
    }

    /// The zenith angles of the pairs by which it is judged, rad.
    fn thetas(&self) -> [f64; 2] {
        [0.0, std::f64::consts::FRAC_PI_2]
    }

    /// Why its last values are not its own: a driver stopped it before it was through. Nothing is judged by them.
    fn cut_short(&self) -> Option<String> {
        None
    }

    /// What cannot be looked at, and why.
    fn notes(&self) -> Vec<String> {
        Vec::new()
    }
}

/// Symmetries of a BRDF.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Symmetry {
    /// It depends on φe − φi alone.
    pub isotropic: bool,
    /// The mirror image of a pair, φ → −φ, has the same value.
    pub bilateral: bool,
}

/// What rounding may cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerances {
    /// Relative; of [`FLOOR`] where f is smaller.
    pub reciprocity: f64,
    /// Relative, on top of how far values scatter over directions that round differently.
    pub isotropy: f64,
    /// Relative.
    pub bilateral: f64,
    /// Relative to the reference.
    pub agreement: f64,
    /// Absolute, on top of the integral's own estimate of its error.
    pub energy: f64,
}

impl Default for Tolerances {
    /// For f32 arithmetic in an order that nobody vouches for. An exchange of ωi and ωe, or a mirror image,
    /// is exact in f32 vectors, so what differs is rounding inside the BRDF: dot(ωi, h) against dot(ωe, h) is
    /// worth 1e-7, and 5e-7/(1 − ωi·h) of Schlick's power, 4e-5 measured where f0 = 0. What
    /// [`Subject::rounding`] costs a half vector comes on top. A turn rounds the directions themselves: 1e-7
    /// in cos θm, which a lobe of width α amplifies by α⁻², 1e-3 at α = 1e-2, where an average over the lobe
    /// keeps a tenth of it.
    fn default() -> Self {
        Self { reciprocity: 5e-5, isotropy: 1e-3, bilateral: 1e-5, agreement: 1e-5, energy: 1e-4 }
    }
}

/// f below which differences count absolutely, sr⁻¹: a BRDF of 1e-3 everywhere reflects 3e-3 of the light.
pub const FLOOR: f64 = 1e-3;

/// A promise that a subject is known to break: reported, held to its bound, and missed where it is kept.
#[derive(Debug, Clone, PartialEq)]
pub struct Declared {
    /// The promise's name, as in a [`Finding`].
    pub property: &'static str,
    /// What the worst value may be.
    pub bound: f64,
    /// Who says so.
    pub citation: String,
}

/// How hard to look.
#[derive(Debug, Clone, Copy)]
pub struct VerifyOptions {
    /// About how many values to look at before the search. A count and not a time, so that no result depends
    /// on the clock.
    pub budget: u64,
    /// Whether to search around the worst inputs found.
    pub search: bool,
}

impl Default for VerifyOptions {
    fn default() -> Self {
        Self { budget: DEFAULT_BUDGET, search: true }
    }
}

/// 5 to 10 s on two cores with software Vulkan.
pub const DEFAULT_BUDGET: u64 = 20_000_000;

/// Settings with pairs that are both on the horizon to the bit.
const HORIZON_SETTINGS: usize = 64;

/// The steps that an observer is told of, at most.
pub const STEPS: usize = 7;

/// A promise about single inputs: what to evaluate beside an input, and how far the values are from it.
trait Property {
    fn name(&self) -> &'static str;

    /// What is kept up to here.
    fn limit(&self) -> f64;

    /// Pairs that an input needs, itself first.
    fn orbit(&self, input: Angles, orbit: &mut Vec<Angles>);

    /// How far the values of an orbit (channels last) are from the promise; the search climbs on it. Never
    /// NaN: values that are not finite are for `finite` to report, and −∞ here.
    fn judge(&mut self, subject: &dyn Subject, setting: &[f64], orbit: &[Angles], values: &[f32]) -> f64;

    /// The worst deviation, in words.
    fn say(&self, deviation: f64, probe: &Probe) -> String;
}

/// Checks every promise of a subject.
///
/// # Errors
/// When the subject cannot be evaluated, or the observer stops it; a broken promise is no error but a
/// [`Finding`] of the report.
pub fn check(subject: &mut dyn Subject, options: &VerifyOptions, observer: &dyn Observer) -> Result<Report> {
    match judge(subject, options, observer) {
        Err(error) => match subject.cut_short() {
            Some(why) => Ok(unchecked(subject, &why)),
            None => Err(error),
        },
        report => report,
    }
}

/// The report of a subject whose values are not its own.
fn unchecked(subject: &mut dyn Subject, why: &str) -> Report {
    let names = properties(&Probe::new(subject)).iter().map(|property| property.name()).collect::<Vec<_>>();
    let findings = names.into_iter().chain(["energy"]).map(|property| Finding::unchecked(property, why));
    Report { subject: subject.name(), evaluated: 0, findings: findings.collect(), notes: Vec::new() }
}

/// The promises about single inputs that a subject makes.
fn properties(probe: &Probe) -> Vec<Box<dyn Property>> {
    let (symmetry, tolerances) = (probe.subject.symmetry(), probe.subject.tolerances());
    let mut properties: Vec<Box<dyn Property>> = vec![
        Box::new(bits::Finite),
        Box::new(bits::NonNegative),
        Box::new(reciprocity::Reciprocity { tolerance: tolerances.reciprocity }),
    ];
    if symmetry.isotropic {
        properties.push(Box::new(symmetry::Isotropy { tolerance: tolerances.isotropy, mirrored: false }));
    }
    if symmetry.bilateral {
        properties.push(Box::new(symmetry::Bilateral { tolerance: tolerances.bilateral }));
    }
    if probe.has_reference() {
        properties.push(Box::new(agreement::Agreement::new(tolerances.agreement)));
    }
    if !probe.has_values() {
        properties.clear();
    }
    properties
}

/// Looks at pairs of directions that are both on the horizon to the bit. Many a right f has a pole there, or 0/0, in all
/// azimuths; it is what is not finite in some of them alone, as where the half vector is 0, that is a fault.
fn horizon(probe: &mut Probe, inputs: &Inputs) -> Result<()> {
    if probe.subject.rounding() == 0.0 || !probe.has_values() {
        return Ok(());
    }
    let (opposite, others) = inputs::horizon();
    let settings = inputs.settings.iter().take(HORIZON_SETTINGS);
    for setting in settings.clone() {
        let mut values = Vec::new();
        probe.subject.evaluate(setting, &others, &mut values)?;
        if values.iter().any(|&value| probe::is_non_finite(value)) {
            return Ok(());
        }
    }
    for setting in settings {
        probe.evaluate(setting, &opposite)?;
    }
    Ok(())
}

fn judge(subject: &mut dyn Subject, options: &VerifyOptions, observer: &dyn Observer) -> Result<Report> {
    let tolerances = subject.tolerances();
    let declared = subject.declared().to_vec();
    let mut probe = Probe::new(subject);
    let mut properties = properties(&probe);

    // Half of the values go to the integrals unless the subject does them, the rest to each promise alike.
    let values = if probe.has_integrals()? { options.budget } else { options.budget / 2 };
    let inputs = Inputs::new(probe.parameters(), values / properties.len().max(1) as u64);
    let (mut worst, mut peaks, mut extents) = (Vec::new(), Vec::new(), Vec::new());
    for property in &mut properties {
        observer.begin(property.name());
        let mut extent = Extent::default();
        let found =
            search::hunt(property.as_mut(), &mut probe, &inputs, options.search, &mut extent, observer)?;
        extents.push(extent);
        worst.push(found.first().cloned());
        // The hunt for what overflows climbs on f.
        peaks.extend(found.into_iter().filter(|_| property.name() == bits::FINITE));
    }
    horizon(&mut probe, &inputs)?;
    let place =
        |properties: &[Box<dyn Property>], name: &str| properties.iter().position(|p| p.name() == name);
    let is_broken = |k: usize, properties: &[Box<dyn Property>], worst: &[Option<search::Worst>]| {
        worst[k].as_ref().is_some_and(|worst| worst.deviation > properties[k].limit())
    };
    // The mirror image in a fixed plane is exact; in others it rounds anew, and differs where isotropy is broken alone.
    if let (Some(turn), Some(mirror)) = (place(&properties, "isotropy"), place(&properties, "bilateral"))
        && is_broken(turn, &properties, &worst)
        && !is_broken(mirror, &properties, &worst)
    {
        let mut planes = symmetry::Isotropy { tolerance: tolerances.isotropy, mirrored: true };
        let mut extent = Extent::default();
        let found = search::hunt(&mut planes, &mut probe, &inputs, false, &mut extent, &Unobserved)?;
        if let Some(found) = found.into_iter().next().filter(|found| found.deviation > tolerances.isotropy) {
            properties[mirror] = Box::new(planes);
            worst[mirror] = Some(found);
            extents[mirror] = extent;
        }
    }
    let is_kept = |name: &str| {
        let mut found = properties.iter().zip(&worst).filter(|(property, _)| property.name() == name);
        found.any(|(p, worst)| worst.as_ref().is_some_and(|w: &search::Worst| w.deviation <= p.limit()))
    };
    let symmetry = Symmetry { isotropic: is_kept("isotropy"), bilateral: is_kept("bilateral") };
    // What is declared to gain without bound is not judged by how much it gains.
    let (boundless, declared): (Vec<_>, Vec<_>) = declared
        .into_iter()
        .partition(|declared| declared.property == "energy" && declared.bound.is_infinite());
    let energy = if !boundless.is_empty() {
        None
    } else if let Some(energy) = albedo::check(&mut probe, options.search, tolerances.energy, observer)? {
        Some(energy)
    } else {
        Some(energy::check(&mut probe, options, symmetry, &peaks, tolerances.energy, observer)?)
    };

    probe.settle_negative();
    // Every value was looked at, whatever it was evaluated for: orbits and integrals too.
    for (worst, seen) in worst.iter_mut().zip([probe.non_finite.take(), probe.most_negative.take()]) {
        *worst = seen.or(worst.take());
    }
    // What is below zero by rounding alone is none of it.
    if let (0, Some(Some(worst))) = (probe.negative.broken, worst.get_mut(1)) {
        worst.deviation = worst.deviation.min(0.0);
    }
    for (extent, seen) in extents.iter_mut().zip([&probe.non_finite_extent, &probe.negative]) {
        *extent = Extent { of: probe.evaluated, ..seen.clone() };
    }
    let mut findings: Vec<_> = properties
        .iter()
        .zip(worst)
        .zip(extents)
        .map(|((property, worst), extent)| Finding::new(property.as_ref(), worst, &probe).with_extent(extent))
        .chain(energy)
        .collect();
    for declared in &declared {
        report::hold(&mut findings, declared, probe.subject.shows(declared.property))?;
    }
    for finding in &mut findings {
        finding.evaluate(probe.subject)?;
    }
    let (subject, mut notes) = (probe.subject.name(), probe.subject.notes());
    let boundless = boundless.iter().map(|declared| &declared.citation);
    notes.extend(boundless.map(|citation| format!("energy is not judged: ρ_dh has no bound ({citation})")));
    Ok(Report { subject, evaluated: probe.evaluated, findings, notes })
}
