//! How much of the domain breaks a promise, and where that begins.

use crate::verify::{Angles, ParameterRange};
use serde::Serialize;
use std::fmt;

/// How much of what was scanned breaks a promise.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Extent {
    /// Inputs that break it: values, pairs of directions or incidences.
    pub broken: u64,
    /// Of how many.
    pub of: u64,
    /// The largest of min(cos θi, cos θe) among them: where it is small, all of it is near the horizon.
    pub cosine: f64,
    /// The range of each free parameter among them: its name, the least and the most.
    pub settings: Vec<(String, f64, f64)>,
}

/// Near the horizon, in cosines: what is broken there alone is a clamp or a guard as a rule.
const GRAZING: f64 = 0.01;

impl Extent {
    /// Counts an input that breaks the promise.
    pub(super) fn add(&mut self, parameters: &[ParameterRange], setting: &[f64], angles: &Angles) {
        self.broken += 1;
        let least = angles.theta_i.max(angles.theta_e).cos().max(0.0);
        self.cosine = self.cosine.max(least);
        let free = parameters.iter().zip(setting).filter(|(parameter, _)| parameter.low < parameter.high);
        for (k, (parameter, &value)) in free.enumerate() {
            match self.settings.get_mut(k) {
                Some((_, low, high)) => (*low, *high) = (low.min(value), high.max(value)),
                None => self.settings.push((parameter.name.clone(), value, value)),
            }
        }
    }
}

/// The extent of what is broken, as a clause.
impl fmt::Display for Extent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let share = 100.0 * self.broken as f64 / self.of.max(1) as f64;
        let share = if share < 0.1 { format!("{share:.0e}") } else { format!("{share:.1}") };
        write!(f, "{} of {} inputs ({share} %)", self.broken, self.of)?;
        let digits = |x: f64| format!("{x:.2e}").parse::<f64>().unwrap_or(x);
        for (name, low, high) in &self.settings {
            match low == high {
                true => write!(f, ", {name} = {}", digits(*low))?,
                false => write!(f, ", {name} from {} to {}", digits(*low), digits(*high))?,
            }
        }
        match self.cosine {
            0.0 => write!(f, ", all on the horizon to the bit"),
            cosine if cosine < GRAZING => {
                write!(f, ", all near the horizon, a cosine ≤ {cosine:.1e}: as a clamp or a guard makes it")
            }
            _ => Ok(()),
        }
    }
}
