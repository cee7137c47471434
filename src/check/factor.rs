//! The factors of a lobe by the reference: they are made of albedos that the reference integrates, and use none of the
//! evaluators' curves.

use super::reference::reference_of_albedo;
use crate::model::compensation::{Albedo, Factor};
use crate::model::lobe::Lobe;
use crate::table::quantity::FixedDirection;
use gonio_reference::{MIN_MU, Reference, Setting, mean_of_rho_dh};
use std::collections::HashMap;
use std::f64::consts::PI;
use std::sync::{Arc, LazyLock, Mutex, OnceLock, PoisonError};

/// The scale s(μi, μe) of a lobe: the product of its factors, with the reference's albedos.
pub(super) struct ReferenceScale {
    factors: Vec<(Factor, Option<Arc<ReferenceCurve>>)>,
}

impl ReferenceScale {
    /// The scale of a lobe, in a row of roughness `swept` if the table has a roughness axis; `None` where an albedo has no
    /// reference. Its integrals have an absolute error of `error` at most.
    pub fn new(lobe: &Lobe, swept: Option<f64>, error: f64) -> Option<Self> {
        let row = swept.or(lobe.roughness());
        let with_curve = |factor: &Factor| {
            let curve = match factor.albedo() {
                Some(albedo) => Some(ReferenceCurve::new(albedo, row, CURVE_SHARE * error)?),
                None => None,
            };
            Some((factor.clone(), curve))
        };
        Some(Self { factors: lobe.factors().iter().map(with_curve).collect::<Option<_>>()? })
    }

    /// The scale at (μi, μe).
    pub fn value(&self, mu_i: f64, mu_e: f64) -> f64 {
        let factor = |(factor, curve): &(Factor, Option<Arc<ReferenceCurve>>)| {
            let e = |mu: f64| curve.as_ref().map_or(f64::NAN, |curve| curve.albedo(mu));
            let e_avg = || curve.as_ref().map_or(f64::NAN, |curve| curve.mean());
            let fresnel = 0.04 + 0.96 * (1.0 - mu_e.clamp(MIN_MU, 1.0)).powi(5);
            match factor {
                // Kulla & Conty 2017: f_ms = (1 − E(μo)) (1 − E(μi)) / (π (1 − E_avg)), times
                // F_ms = F_avg² E_avg / (1 − F_avg (1 − E_avg)).
                Factor::Missing { f_avg, .. } => {
                    let e_avg = e_avg();
                    let mean_loss = 1.0 - e_avg;
                    if mean_loss <= 0.0 {
                        return 0.0;
                    }
                    let f_ms = f_avg.powi(2) * e_avg / (1.0 - f_avg * mean_loss);
                    (1.0 - e(mu_i)) * (1.0 - e(mu_e)) / mean_loss * f_ms
                }
                // Turquin 2019: 1 + F0 (1 − E)/E.
                Factor::Restored { f0, .. } => 1.0 + f0 * (1.0 / e(mu_e) - 1.0),
                Factor::Coat { weight } => weight * fresnel,
                Factor::BelowCoat { weight } => 1.0 - weight * fresnel,
                // E above 1 counts as 1.
                Factor::BelowSheen { most, .. } => 1.0 - most * f64::max(e(mu_i), e(mu_e)).min(1.0),
            }
        };
        self.factors.iter().map(factor).product()
    }

    /// Integrates ρ_dh of a lobe times s, with ωi or ωe fixed.
    pub fn rho_dh(
        &self,
        lobe: &dyn Reference,
        mu: f64,
        setting: &Setting,
        fixed: FixedDirection,
    ) -> [f64; 2] {
        let mu = mu.clamp(MIN_MU, 1.0);
        match fixed {
            FixedDirection::Exitant => lobe.rho_dh_times(mu, setting, &|other| self.value(other, mu)),
            FixedDirection::Incident => lobe.rho_dh_times(mu, setting, &|other| self.value(mu, other)),
        }
    }

    /// Integrates ρ_hh of a lobe times s.
    pub fn rho_hh(&self, lobe: &dyn Reference, setting: &Setting) -> [f64; 2] {
        let alphas = self.factors.iter().filter_map(|(_, curve)| Some(curve.as_ref()?.setting.alpha()));
        let alpha = alphas.fold(setting.alpha(), f64::max);
        mean_of_rho_dh(setting, alpha, |mu, error| {
            self.rho_dh(lobe, mu, &setting.within(error), FixedDirection::Incident)
        })
    }
}

/// The share of a scaled lobe's error that its albedos may have: 1 − E divides by 1 − E_avg, and a polynomial amplifies the
/// errors of its values.
const CURVE_SHARE: f64 = 0.02;

/// The albedo E(μ) by octaves of μ. Each octave is a polynomial through as many values as its error takes, computed when it
/// is first asked for.
struct ReferenceCurve {
    reference: &'static dyn Reference,
    setting: Setting,
    /// The number of values of an octave.
    points: usize,
    octaves: [OnceLock<Vec<f64>>; OCTAVES],
    mean: OnceLock<f64>,
}

/// The number of octaves, from 2⁻²⁴ to 1.
const OCTAVES: usize = 24;
/// The decay of an octave's Chebyshev coefficients: E has branch points near ±iα and at 0, which are on the ellipse of this
/// parameter or beyond.
const ELLIPSE: f64 = 5.8;
/// The most values of an octave: 5.8⁻¹⁵ = 3e-12.
const MOST_POINTS: usize = 16;
/// The number of curves that are kept.
const CURVES_KEPT: usize = 512;

/// The key of a curve: a model, and the bits of its measure of a roughness, of its error and of its parameters.
type ReferenceKey = (&'static str, u64, u64, [u64; 8]);
static CURVES: LazyLock<Mutex<HashMap<ReferenceKey, Arc<ReferenceCurve>>>> = LazyLock::new(Mutex::default);

impl ReferenceCurve {
    fn new(albedo: &Albedo, row: Option<f64>, error: f64) -> Option<Arc<Self>> {
        let (reference, setting) = reference_of_albedo(albedo, row)?;
        let setting = setting.within(error);
        let measure = setting.alpha().to_bits();
        let key = (albedo.model.name, measure, error.to_bits(), albedo.parameters.map(f64::to_bits));
        // One more than the decay asks for: the coefficients begin at 1 and more.
        let points =
            ((-error.max(f64::MIN_POSITIVE).ln() / ELLIPSE.ln()).ceil() as usize + 2).min(MOST_POINTS);
        let mut curves = CURVES.lock().unwrap_or_else(PoisonError::into_inner);
        if curves.len() >= CURVES_KEPT {
            curves.clear();
        }
        let new = || {
            let octaves = std::array::from_fn(|_| OnceLock::new());
            Arc::new(Self { reference, setting, points, octaves, mean: OnceLock::new() })
        };
        Some(curves.entry(key).or_insert_with(new).clone())
    }

    /// E(μ) by the reference's integral.
    fn exact(&self, mu: f64) -> f64 {
        self.reference.rho_dh(mu, &self.setting).into_iter().sum()
    }

    /// E(μ) by the polynomial of its octave.
    fn albedo(&self, mu: f64) -> f64 {
        let mu = mu.clamp(MIN_MU, 1.0);
        let octave = ((-mu.log2()).floor() as usize).min(OCTAVES - 1);
        let high = 0.5f64.powi(octave as i32);
        let angle = |k: usize| PI * (k as f64 + 0.5) / self.points as f64;
        let point = |k: usize| angle(k).cos();
        let values = self.octaves[octave]
            .get_or_init(|| (0..self.points).map(|k| self.exact(high * (0.75 + 0.25 * point(k)))).collect());
        // Lagrange's polynomial, by the barycentric formula for Chebyshev points of the first kind.
        let x = (mu / high - 0.75) / 0.25;
        let (mut above, mut below) = (0.0, 0.0);
        for (k, value) in values.iter().enumerate() {
            let distance = x - point(k);
            if distance == 0.0 {
                return *value;
            }
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            let weight = sign * angle(k).sin() / distance;
            above += weight * value;
            below += weight;
        }
        above / below
    }

    /// The mean albedo E_avg.
    fn mean(&self) -> f64 {
        *self.mean.get_or_init(|| {
            mean_of_rho_dh(&self.setting, self.setting.alpha(), |mu, _| [self.albedo(mu), 0.0])[0]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model;

    /// An octave is as good between its points as the reference's integrals.
    #[test]
    fn octaves_hold_to_1e_10() {
        let model = model::find("ggx-smith-correlated-none").unwrap();
        for alpha in [1e-4, 0.01, 0.3, 1.0] {
            let albedo = Albedo { model, roughness: Some(f64::sqrt(alpha)), parameters: model.defaults() };
            let curve = ReferenceCurve::new(&albedo, None, 0.0).unwrap();
            for mu in [1e-7, 3e-5, 2.1e-3, 0.0123, 0.26, 0.71, 0.987] {
                let error = (curve.albedo(mu) - curve.exact(mu)).abs();
                assert!(error <= 1e-10, "α = {alpha}, μ = {mu}: {error:e}");
            }
        }
    }
}
