//! 1 − E(μ) of a model at a setting, as a polynomial in asinh(μ/δ): E turns at μ ≈ α, and is analytic there.

use crate::axis::{Axis, Variable};
use crate::cpu;
use crate::error::Result;
use crate::models::{FINEST, Model};
use crate::pair::MU_MIN;
use crate::plan::TablePlan;
use crate::quadrature::gauss_legendre;
use crate::quantity::SPLIT_SUM;
use crate::setting::Setting;
use std::collections::HashMap;
use std::convert::Infallible;
use std::f64::consts::PI;
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

/// Σ c_k T_k(x), x from −1 at μ = 2⁻²⁴ to 1 at μ = 1.
pub(super) struct Curve {
    delta: f64,
    middle: f64,
    half: f64,
    coefficients: Vec<f64>,
    mean: f64,
}

/// Where the last coefficients fall below it, the rest is noise of the integrals.
const NOISE: f64 = 5e-11;
/// Points to begin with, and to give up at: a model whose E is not analytic gets what they give.
const POINTS: [usize; 2] = [64, 512];
/// Curves that are kept: 2 MiB and less.
const MOST: usize = 2048;

type Key = (&'static str, u64, [u64; 8]);
static CURVES: LazyLock<Mutex<HashMap<Key, Arc<Curve>>>> = LazyLock::new(Mutex::default);

impl Curve {
    /// Made once and shared.
    pub fn of(model: &'static Model, setting: &Setting) -> Arc<Self> {
        let key = (model.name, setting.alpha.to_bits(), setting.parameters.map(f64::to_bits));
        let curves = || CURVES.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = curves().get(&key) {
            return known.clone();
        }
        let made = Arc::new(Self::new(model, setting));
        let mut curves = curves();
        if curves.len() >= MOST {
            curves.clear();
        }
        curves.insert(key, made.clone());
        made
    }

    fn new(model: &'static Model, setting: &Setting) -> Self {
        let mut points = POINTS[0];
        loop {
            let curve = Self::with(points, setting.alpha, &|mus| missing(model, setting, mus));
            let last = curve.coefficients.iter().rev().take(4);
            // NaN is not worth another try.
            let is_rough = last.into_iter().any(|c| c.abs() > NOISE);
            if !is_rough || points >= POINTS[1] {
                return curve;
            }
            points *= 2;
        }
    }

    /// At n Chebyshev points. μ from 2⁻²⁴ to 1 spans decades whatever α is, since E is not analytic at 0.
    fn with(n: usize, alpha: f64, missing: &dyn Fn(Vec<f64>) -> Vec<f64>) -> Self {
        let delta = (1e-3 * alpha).clamp(4.0 * MU_MIN, 1e-4);
        let [a, b] = [MU_MIN, 1.0].map(|mu| (mu / delta).asinh());
        let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
        let mut curve = Self { delta, middle, half, coefficients: Vec::new(), mean: 0.0 };
        // Descending in x, so ascending from the end.
        let angle = |k: usize| PI * (k as f64 + 0.5) / n as f64;
        let mus = (0..n).rev().map(|k| curve.mu(angle(k).cos())).collect();
        let mut values = missing(mus);
        values.reverse();
        let coefficient = |j: usize| {
            let sum: f64 = values.iter().enumerate().map(|(k, m)| m * (j as f64 * angle(k)).cos()).sum();
            sum * if j == 0 { 1.0 } else { 2.0 } / n as f64
        };
        curve.coefficients = (0..n).map(coefficient).collect();
        // 2 ∫ (1 − E) μ dμ, dμ = √(μ² + δ²) half dx
        let nodes = gauss_legendre(n + 32);
        let term = |x: f64| {
            let mu = curve.mu(2.0 * x - 1.0);
            2.0 * curve.missing(mu) * mu * mu.hypot(delta) * 2.0 * half
        };
        curve.mean = nodes.iter().map(|node| node.weight * term(node.x)).sum();
        curve
    }

    fn mu(&self, x: f64) -> f64 {
        (self.delta * (self.middle + self.half * x).sinh()).clamp(MU_MIN, 1.0)
    }

    /// 1 − E(μ), by Clenshaw's recurrence; never below 0.
    pub fn missing(&self, mu: f64) -> f64 {
        let x = ((mu.clamp(MU_MIN, 1.0) / self.delta).asinh() - self.middle) / self.half;
        let step = |[b1, b2]: [f64; 2], c: &f64| [c + 2.0 * x * b1 - b2, b1];
        let [b1, b2] = self.coefficients[1..].iter().rev().fold([0.0; 2], step);
        let value = self.coefficients[0] + x * b1 - b2;
        if value < 0.0 { 0.0 } else { value }
    }

    /// 1 − E_avg: of the very polynomial, so that what is added is what is missing, whatever its error.
    pub fn mean_missing(&self) -> f64 {
        self.mean
    }

    pub fn delta(&self) -> f64 {
        self.delta
    }

    /// Where E(μ) is what it is at this μ.
    pub fn crossings(&self, mu: f64) -> Vec<f64> {
        const STEPS: usize = 256;
        let here = self.missing(mu);
        let above = |mu: f64| self.missing(mu) > here;
        let at = |k: usize| self.mu(2.0 * k as f64 / STEPS as f64 - 1.0);
        let mut found = vec![mu];
        for k in 0..STEPS {
            let [mut low, mut high] = [at(k), at(k + 1)];
            if above(low) == above(high) {
                continue;
            }
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if above(middle) == above(low) { low = middle } else { high = middle }
            }
            // The fixed one itself is there already.
            if (low - mu).abs() > 1e-6 * mu {
                found.push(low);
            }
        }
        found
    }
}

/// 1 − E at some ascending μ, by the model's own integrals.
fn missing(model: &'static Model, setting: &Setting, mus: Vec<f64>) -> Vec<f64> {
    let count = mus.len();
    let albedo = || -> Result<Vec<f64>> {
        let roughness = model.shape.map(|shape| shape.roughness(setting.alpha));
        let axes = vec![Axis::listed(Variable::Mu, mus)?];
        let plan = TablePlan::basis("E", &SPLIT_SUM, model, roughness, axes)?;
        let plan = plan.with_places(setting.parameters).with_tolerance(FINEST);
        let channels = plan.channels.len();
        let values = cpu::evaluate(&plan, &|_| Ok::<_, Infallible>(())).unwrap_or_default();
        Ok(values.chunks(channels).map(|ab| 1.0 - ab.iter().sum::<f64>()).collect())
    };
    // A plan refuses what has no albedo; were it to come here, no number would.
    albedo().unwrap_or_else(|_| vec![f64::NAN; count])
}
