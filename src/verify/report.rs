//! What a check found.

use crate::base::error::{Error, Result};
use crate::verify::probe::Probe;
use crate::verify::search::Worst;
use crate::verify::{Angles, Declared, Extent, Property, Subject};
use serde::Serialize;
use std::fmt;

/// What was found of each promise.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    /// What was checked.
    pub subject: String,
    /// Pairs of directions evaluated.
    pub evaluated: u64,
    /// The promises, in the order of the table in the module's documentation.
    pub findings: Vec<Finding>,
    /// What was not looked at, and why.
    pub notes: Vec<String>,
}

/// A promise, and the input that is worst for it.
#[derive(Debug, Clone, Serialize)]
pub struct Finding {
    /// The promise.
    pub property: &'static str,
    /// Whether it is kept.
    pub verdict: Verdict,
    /// The worst deviation, as measured for this promise; none where it is infinite or nothing was seen.
    pub deviation: Option<f64>,
    /// What it may be.
    pub limit: f64,
    /// The same in words.
    pub said: String,
    /// How much of the domain is broken, if it is.
    pub extent: Option<Extent>,
    /// Where.
    pub input: Option<Input>,
    /// f there, sr⁻¹, each channel; none where there are no values.
    pub values: Vec<f32>,
    /// For a declared violation: who says so, or what is wrong with it.
    pub note: Option<String>,
}

/// Whether a promise is kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// No input was found that breaks it.
    Kept,
    /// Broken as declared, within the declared bound.
    Declared,
    /// Broken; or declared broken, and found beyond the bound or kept.
    Broken,
    /// Not judged, as the device does not run the subject to its end.
    Unchecked,
}

/// An input, in the words of `gonio eval`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Input {
    /// Parameters by name.
    pub setting: Vec<(String, f64)>,
    /// The directions.
    #[serde(flatten)]
    pub angles: Angles,
}

impl Finding {
    pub(super) fn new(property: &dyn Property, worst: Option<Worst>, probe: &Probe) -> Self {
        match worst {
            Some(worst) => {
                let said = property.say(worst.deviation, probe);
                Self::of(property.name(), property.limit(), said, Some(worst), probe)
            }
            None => Self::unseen(property.name(), probe),
        }
    }

    pub(super) fn of(
        property: &'static str,
        limit: f64,
        said: String,
        worst: Option<Worst>,
        probe: &Probe,
    ) -> Self {
        let deviation = worst.as_ref().map_or(f64::NEG_INFINITY, |worst| worst.deviation);
        let input = worst.map(|worst| Input {
            setting: probe.parameters().iter().map(|p| p.name.clone()).zip(worst.setting).collect(),
            angles: worst.angles,
        });
        Self {
            property,
            verdict: if deviation <= limit { Verdict::Kept } else { Verdict::Broken },
            deviation: Some(deviation).filter(|d| d.is_finite()),
            limit,
            said,
            extent: None,
            input,
            values: Vec::new(),
            note: None,
        }
    }

    /// Notes how much is broken, of a broken promise.
    pub(super) fn with_extent(mut self, extent: Extent) -> Self {
        if self.verdict == Verdict::Broken && extent.broken > 0 {
            self.said += &format!("; {extent}");
            self.extent = Some(extent);
        }
        self
    }

    /// A promise that is not judged.
    pub(super) fn unchecked(property: &'static str, why: &str) -> Self {
        let (verdict, said) = (Verdict::Unchecked, format!("not checked: {why}"));
        Self {
            property,
            verdict,
            deviation: None,
            limit: 0.0,
            said,
            extent: None,
            input: None,
            values: Vec::new(),
            note: None,
        }
    }

    /// Notes f at the worst input.
    pub(super) fn evaluate(&mut self, subject: &mut dyn Subject) -> Result<()> {
        let Some(input) = &self.input else { return Ok(()) };
        let setting: Vec<_> = input.setting.iter().map(|&(_, value)| value).collect();
        if subject.has_values(&setting) {
            subject.evaluate(&setting, &[input.angles], &mut self.values)?;
        }
        Ok(())
    }

    /// Every value that it needs is NaN or infinite: nothing is kept.
    pub(super) fn unseen(property: &'static str, probe: &Probe) -> Self {
        let said = "no input has finite values".into();
        Self { verdict: Verdict::Broken, ..Self::of(property, f64::NEG_INFINITY, said, None, probe) }
    }
}

/// Holds a declared violation to its bound; and to being there, where the parameters can show it.
pub(super) fn hold(findings: &mut [Finding], declared: &Declared, shows: bool) -> Result<()> {
    let finding = findings.iter_mut().find(|f| f.property == declared.property).ok_or_else(|| {
        Error::Internal(format!(
            "{} is declared broken, and is no promise of this subject",
            declared.property
        ))
    })?;
    let (verdict, note) = match (finding.verdict, finding.deviation) {
        (Verdict::Kept, _) if !shows => {
            (Verdict::Kept, "declared broken, which these parameters do not show")
        }
        (Verdict::Kept, _) => (Verdict::Broken, "declared broken, and kept: take the declaration back"),
        (_, Some(deviation)) if deviation <= declared.bound => (Verdict::Declared, "as declared"),
        _ => (Verdict::Broken, "beyond the declared bound"),
    };
    finding.verdict = verdict;
    finding.note = Some(format!("{note} (bound {}; {})", declared.bound, declared.citation));
    Ok(())
}

impl Report {
    /// Whether every promise is kept, or broken as declared. One that is not checked is not kept.
    pub fn is_kept(&self) -> bool {
        self.findings.iter().all(|finding| matches!(finding.verdict, Verdict::Kept | Verdict::Declared))
    }

    /// A promise's finding.
    pub fn find(&self, property: &str) -> Option<&Finding> {
        self.findings.iter().find(|finding| finding.property == property)
    }
}

/// Options that give this input back, bit for bit: `--set alpha=0.1 --theta-i 1.5 …`.
impl fmt::Display for Input {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let stem = |name: &str| {
            name.rsplit_once('.').filter(|(_, axis)| "xyzw".contains(axis)).map(|(stem, _)| stem.to_owned())
        };
        // The components of a vector go by its name, equal ones as one.
        for vector in self.setting.chunk_by(|(a, _), (b, _)| stem(a).is_some() && stem(a) == stem(b)) {
            let name = match vector {
                [(name, _)] => name.clone(),
                _ => stem(&vector[0].0).unwrap_or_default(),
            };
            let mut values: Vec<_> = vector.iter().map(|(_, value)| format!("{value:?}")).collect();
            if values.iter().all(|value| *value == values[0]) {
                values.truncate(1);
            }
            // A shell takes brackets for a pattern.
            let quote = if name.contains('[') { "'" } else { "" };
            write!(f, "--set {quote}{name}={}{quote} ", values.join(","))?;
        }
        // The shortest digits that read back as the same f64, 17 at most.
        let Angles { theta_i, phi_i, theta_e, phi_e } = self.angles;
        write!(f, "--theta-i {theta_i:?} --phi-i {phi_i:?} --theta-e {theta_e:?} --phi-e {phi_e:?}")
    }
}
