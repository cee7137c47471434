//! The scale of a lobe: the product of its factors, in each row of a table.

use super::albedo_curve::{AlbedoCurve, CROSSINGS};
use crate::model::compensation::{ALBEDO_ERROR, Factor};
use crate::model::lobe::Lobe;
use crate::plan::TablePlan;
use crate::table::axis::Variable;
use rayon::prelude::*;
use std::sync::Arc;

/// The product of a lobe's factors in a row of a table, a function of both cosines.
#[derive(Clone, Default)]
pub(crate) struct LobeScale(Vec<FactorCurve>);

/// A factor with the albedo curve that it is made of, if it is.
#[derive(Clone)]
struct FactorCurve {
    factor: Factor,
    curve: Option<Arc<AlbedoCurve>>,
}

impl LobeScale {
    /// The scale of some factors, in a row of roughness `row` if the table has a roughness axis.
    pub fn new(factors: &[Factor], row: Option<f64>) -> Self {
        let with_curve = |factor: &Factor| FactorCurve {
            factor: factor.clone(),
            curve: factor.albedo().map(|albedo| AlbedoCurve::cached(albedo.model, &albedo.setting(row))),
        };
        Self(factors.iter().map(with_curve).collect())
    }

    /// Whether the lobe has no factors, so that the scale is 1.
    pub fn is_one(&self) -> bool {
        self.0.is_empty()
    }

    /// The product of the factors at (μi, μe).
    pub fn value(&self, mu_i: f64, mu_e: f64) -> f64 {
        self.0.iter().map(|factor| factor.value(mu_i, mu_e)).product()
    }

    /// The smallest μ at which a factor turns.
    pub(crate) fn least_turn(&self) -> f64 {
        self.0.iter().filter_map(|factor| Some(factor.curve.as_ref()?.delta())).fold(1.0, f64::min)
    }

    /// The kinks of the scale, as a function of one cosine while the other is fixed.
    pub fn kinks(&self, mu: f64) -> Vec<f64> {
        let kinks = self.0.iter().filter_map(|factor| match factor.factor {
            Factor::BelowSheen { .. } => Some(factor.curve.as_ref()?.crossings(mu)),
            _ => None,
        });
        kinks.flatten().collect()
    }

    /// The largest number of kinks.
    pub fn max_kinks(&self) -> usize {
        CROSSINGS * self.0.iter().filter(|factor| matches!(factor.factor, Factor::BelowSheen { .. })).count()
    }

    /// The relative error that the error of E leaves in the scale. The compensating factor is a quotient of small losses:
    /// 1 − E(μ) is about its mean or less, down to a tenth of it at μ = 1.
    pub fn error(&self) -> f64 {
        let factor_error = |factor: &FactorCurve| match (&factor.factor, &factor.curve) {
            (Factor::Missing { .. }, Some(curve)) => 20.0 * ALBEDO_ERROR / curve.mean_loss(),
            _ => 10.0 * ALBEDO_ERROR,
        };
        self.0.iter().map(factor_error).sum()
    }
}

impl FactorCurve {
    /// The factor at (μi, μe).
    fn value(&self, mu_i: f64, mu_e: f64) -> f64 {
        let loss = |mu| self.curve.as_ref().map_or(f64::NAN, |curve| curve.loss(mu));
        match self.factor {
            Factor::Missing { f_avg, .. } => {
                let mean = self.curve.as_ref().map_or(f64::NAN, |curve| curve.mean_loss());
                let (loss_i, loss_e) = (loss(mu_i), loss(mu_e));
                // A mirror loses no energy.
                if mean <= 0.0 {
                    0.0
                } else {
                    loss_i / mean * loss_e * f_avg * f_avg * (1.0 - mean) / (1.0 - f_avg * mean)
                }
            }
            Factor::Restored { f0, .. } => {
                let loss = loss(mu_e);
                1.0 + f0 * loss / (1.0 - loss)
            }
            Factor::Coat { weight } => weight * coat(mu_e),
            Factor::BelowCoat { weight } => 1.0 - weight * coat(mu_e),
            Factor::BelowSheen { most, .. } => {
                let transmitted = |mu| 1.0 - most * (1.0 - loss(mu));
                f64::min(transmitted(mu_i), transmitted(mu_e))
            }
        }
    }
}

/// Schlick's Fresnel term of a dielectric of η = 1.5, the clear coat's.
fn coat(mu: f64) -> f64 {
    0.04 + 0.96 * (1.0 - mu).powi(5)
}

/// The scale of a lobe in each row of a table; empty where the lobe has no factors.
pub(crate) fn scales(table: &TablePlan, lobe: &Lobe) -> Vec<LobeScale> {
    if lobe.factors().is_empty() {
        return Vec::new();
    }
    let rows: Vec<_> = match table.axis(Variable::Roughness) {
        Some(axis) => axis.values().iter().map(|&roughness| Some(roughness)).collect(),
        None => vec![lobe.roughness()],
    };
    rows.into_par_iter().map(|row| LobeScale::new(lobe.factors(), row)).collect()
}

/// The largest relative error that factors add to a table's values.
pub(crate) fn factor_error(table: &TablePlan) -> f64 {
    table.lobes().iter().flat_map(|lobe| scales(table, lobe)).map(|scale| scale.error()).fold(0.0, f64::max)
}
