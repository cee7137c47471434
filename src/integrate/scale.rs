//! The value of a lobe's factors in each row of a table.

use super::albedo_curve::{CROSSINGS, Curve};
use crate::model::compensation::{ALBEDO_ERROR, Factor};
use crate::model::lobe::Lobe;
use crate::plan::TablePlan;
use crate::table::axis::Variable;
use rayon::prelude::*;
use std::sync::Arc;

/// The product of a lobe's factors in a row of a table.
#[derive(Clone, Default)]
pub(crate) struct Scale(Vec<Known>);

#[derive(Clone)]
struct Known {
    factor: Factor,
    curve: Option<Arc<Curve>>,
}

impl Scale {
    pub fn new(factors: &[Factor], row: Option<f64>) -> Self {
        let known = |factor: &Factor| Known {
            factor: factor.clone(),
            curve: factor.albedo().map(|of| Curve::of(of.model, &of.setting(row))),
        };
        Self(factors.iter().map(known).collect())
    }

    /// Whether it is 1.
    pub fn is_one(&self) -> bool {
        self.0.is_empty()
    }

    pub fn at(&self, mu_i: f64, mu_e: f64) -> f64 {
        self.0.iter().map(|known| known.at(mu_i, mu_e)).product()
    }

    /// The smallest μ at which it turns.
    pub(crate) fn turns_at(&self) -> f64 {
        self.0.iter().filter_map(|known| Some(known.curve.as_ref()?.delta())).fold(1.0, f64::min)
    }

    /// Where it has a kink, as a function of the one cosine while the other is fixed.
    pub fn kinks(&self, mu: f64) -> Vec<f64> {
        let kinks = self.0.iter().filter_map(|known| match known.factor {
            Factor::BelowSheen { .. } => Some(known.curve.as_ref()?.crossings(mu)),
            _ => None,
        });
        kinks.flatten().collect()
    }

    /// At most so many.
    pub fn most_kinks(&self) -> usize {
        CROSSINGS * self.0.iter().filter(|known| matches!(known.factor, Factor::BelowSheen { .. })).count()
    }

    /// The error that E leaves in it, relative: what is missing is a quotient of small differences. 1 − E(μ) is about
    /// its mean or less, down to a tenth of it at μ = 1.
    pub fn error(&self) -> f64 {
        let of = |known: &Known| match (&known.factor, &known.curve) {
            (Factor::Missing { .. }, Some(curve)) => 20.0 * ALBEDO_ERROR / curve.mean_missing(),
            _ => 10.0 * ALBEDO_ERROR,
        };
        self.0.iter().map(of).sum()
    }
}

impl Known {
    fn at(&self, mu_i: f64, mu_e: f64) -> f64 {
        let missing = |mu| self.curve.as_ref().map_or(f64::NAN, |curve| curve.missing(mu));
        match self.factor {
            Factor::Missing { f_avg, .. } => {
                let mean = self.curve.as_ref().map_or(f64::NAN, |curve| curve.mean_missing());
                let (i, e) = (missing(mu_i), missing(mu_e));
                // Nothing is missing from a mirror.
                if mean <= 0.0 {
                    0.0
                } else {
                    i / mean * e * f_avg * f_avg * (1.0 - mean) / (1.0 - f_avg * mean)
                }
            }
            Factor::Restored { f0, .. } => {
                let missing = missing(mu_e);
                1.0 + f0 * missing / (1.0 - missing)
            }
            Factor::Coat { weight } => weight * coat(mu_e),
            Factor::BelowCoat { weight } => 1.0 - weight * coat(mu_e),
            Factor::BelowSheen { most, .. } => {
                let left = |mu| 1.0 - most * (1.0 - missing(mu));
                f64::min(left(mu_i), left(mu_e))
            }
        }
    }
}

/// Schlick's F of a dielectric of 1.5.
fn coat(mu: f64) -> f64 {
    0.04 + 0.96 * (1.0 - mu).powi(5)
}

/// The factors of a lobe in each row of a table; empty where it has none.
pub(crate) fn scales(table: &TablePlan, lobe: &Lobe) -> Vec<Scale> {
    if lobe.factors().is_empty() {
        return Vec::new();
    }
    let rows: Vec<_> = match table.axis(Variable::Roughness) {
        Some(axis) => axis.values().iter().map(|&roughness| Some(roughness)).collect(),
        None => vec![lobe.roughness()],
    };
    rows.into_par_iter().map(|row| Scale::new(lobe.factors(), row)).collect()
}

/// The relative error that factors add to a table's values.
pub(crate) fn factor_error(table: &TablePlan) -> f64 {
    table.lobes().iter().flat_map(|lobe| scales(table, lobe)).map(|scale| scale.error()).fold(0.0, f64::max)
}
