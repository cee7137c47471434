//! The loss 1 − E(μ) of a model at a setting, as a polynomial in asinh(μ/δ): E turns at μ ≈ α, and is analytic there.
//! A model with a seam, where E is not analytic, takes two polynomials: one below the seam, and one above it in
//! asinh((1 − μ)/δ), as E is not analytic at the normal either.

use crate::base::error::Result;
use crate::base::half_angle::MU_MIN;
use crate::base::quadrature::gauss_legendre;
use crate::base::tolerance::FINEST;
use crate::integrate::evaluate;
use crate::integrate::rule_set::{RuleKind, RuleSet};
use crate::model::Model;
use crate::model::parameters::Setting;
use crate::plan::TablePlan;
use crate::table::axis::{Axis, Variable};
use crate::table::quantity::SPLIT_SUM;
use std::collections::HashMap;
use std::convert::Infallible;
use std::f64::consts::PI;
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

/// The loss 1 − E(μ) as one polynomial, or as two that meet at a seam.
pub(super) struct AlbedoCurve {
    below: Piece,
    above: Option<(f64, Piece)>,
    /// The mean loss 1 − E_avg = 2 ∫ (1 − E) μ dμ.
    mean: f64,
}

/// A Chebyshev series Σ c_k T_k(x) in a coordinate x of μ.
struct Piece {
    coordinate: CurveCoordinate,
    coefficients: Vec<f64>,
}

/// The coordinate x ∈ [−1, 1] of μ: linear in asinh(d/δ), where d is the distance of μ from grazing or from the normal.
struct CurveCoordinate {
    from_normal: bool,
    delta: f64,
    middle: f64,
    half: f64,
}

/// The size of the last coefficients at which a series is long enough: beyond it they are noise of the integrals.
const NOISE: f64 = 5e-11;
/// The smallest and the largest number of points: a model whose E is not analytic keeps the error of the largest.
const POINTS: [usize; 2] = [64, 512];
/// The δ of asinh((1 − μ)/δ) above a seam: Charlie's E goes like (1 − μ)^c with c ≥ 1/6 there, of which 1e-10 is left at that distance.
const AT_NORMAL: f64 = 1e-12;
/// The number of curves that are kept: 2 MiB and less.
const MAX_CURVES: usize = 2048;

type CurveKey = (&'static str, u64, [u64; 8]);
static CURVES: LazyLock<Mutex<HashMap<CurveKey, Arc<AlbedoCurve>>>> = LazyLock::new(Mutex::default);

impl CurveCoordinate {
    fn new(from_normal: bool, delta: f64, distances: [f64; 2]) -> Self {
        let [a, b] = distances.map(|d| (d / delta).asinh());
        Self { from_normal, delta, middle: 0.5 * (a + b), half: 0.5 * (b - a) }
    }

    fn mu(&self, x: f64) -> f64 {
        let distance = self.delta * (self.middle + self.half * x).sinh();
        (if self.from_normal { 1.0 - distance } else { distance }).clamp(MU_MIN, 1.0)
    }

    fn x(&self, mu: f64) -> f64 {
        let distance = if self.from_normal { 1.0 - mu } else { mu };
        ((distance / self.delta).asinh() - self.middle) / self.half
    }

    /// The derivative |dμ/dx|.
    fn slope(&self, x: f64) -> f64 {
        self.delta * (self.middle + self.half * x).cosh() * self.half
    }
}

impl Piece {
    /// Fits a series to `loss`, with twice the points until its last coefficients are noise.
    fn new(coordinate: CurveCoordinate, loss: &dyn Fn(Vec<f64>) -> Vec<f64>) -> Self {
        let mut points = POINTS[0];
        let mut piece = Self { coordinate, coefficients: Vec::new() };
        loop {
            piece.coefficients = coefficients(points, &piece.coordinate, loss);
            let last = piece.coefficients.iter().rev().take(4);
            // More points do not mend NaN.
            let is_rough = last.into_iter().any(|c| c.abs() > NOISE);
            if !is_rough || points >= POINTS[1] {
                return piece;
            }
            points *= 2;
        }
    }

    /// Evaluates the series by Clenshaw's recurrence.
    fn value(&self, mu: f64) -> f64 {
        let x = self.coordinate.x(mu);
        let step = |[b1, b2]: [f64; 2], c: &f64| [c + 2.0 * x * b1 - b2, b1];
        let [b1, b2] = self.coefficients[1..].iter().rev().fold([0.0; 2], step);
        self.coefficients[0] + x * b1 - b2
    }

    /// The integral 2 ∫ max(0, 1 − E) μ dμ over the piece.
    fn mean(&self) -> f64 {
        let nodes = gauss_legendre(self.coefficients.len() + 32);
        let term = |x: f64| {
            let mu = self.coordinate.mu(x);
            let loss = self.value(mu);
            2.0 * (if loss < 0.0 { 0.0 } else { loss }) * mu * self.coordinate.slope(x) * 2.0
        };
        nodes.iter().map(|node| node.weight * term(2.0 * node.x - 1.0)).sum()
    }
}

/// The coefficients of the series through the values of `loss` at n Chebyshev points.
fn coefficients(n: usize, coordinate: &CurveCoordinate, loss: &dyn Fn(Vec<f64>) -> Vec<f64>) -> Vec<f64> {
    let angle = |k: usize| PI * (k as f64 + 0.5) / n as f64;
    // Descending in x, and so in μ but where that is 1 less a distance.
    let mut mus: Vec<_> = (0..n).map(|k| coordinate.mu(angle(k).cos())).collect();
    if !coordinate.from_normal {
        mus.reverse();
    }
    let mut values = loss(mus);
    if !coordinate.from_normal {
        values.reverse();
    }
    let coefficient = |j: usize| {
        let sum: f64 = values.iter().enumerate().map(|(k, m)| m * (j as f64 * angle(k)).cos()).sum();
        sum * if j == 0 { 1.0 } else { 2.0 } / n as f64
    };
    (0..n).map(coefficient).collect()
}

impl AlbedoCurve {
    /// The curve of a model at a setting, computed once and shared.
    pub fn cached(model: &'static Model, setting: &Setting) -> Arc<Self> {
        let key = (model.name, setting.alpha.to_bits(), setting.parameters.map(f64::to_bits));
        let curves = || CURVES.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = curves().get(&key) {
            return known.clone();
        }
        let curve = Arc::new(Self::new(model, setting));
        let mut curves = curves();
        if curves.len() >= MAX_CURVES {
            curves.clear();
        }
        curves.insert(key, curve.clone());
        curve
    }

    fn new(model: &'static Model, setting: &Setting) -> Self {
        let loss = |mus| integrate_loss(model, setting, mus);
        let (below, above) = match model.microfacet.and_then(|parts| parts.seam) {
            // μ from 2⁻²⁴ to 1 spans decades whatever α is, since E is not analytic at 0.
            None => {
                let delta = (1e-3 * setting.alpha).clamp(4.0 * MU_MIN, 1e-4);
                (Piece::new(CurveCoordinate::new(false, delta, [MU_MIN, 1.0]), &loss), None)
            }
            Some(seam) => {
                let below = CurveCoordinate::new(false, 4.0 * MU_MIN, [MU_MIN, seam]);
                let above = CurveCoordinate::new(true, AT_NORMAL, [0.0, 1.0 - seam]);
                (Piece::new(below, &loss), Some((seam, Piece::new(above, &loss))))
            }
        };
        let mean = below.mean() + above.as_ref().map_or(0.0, |(_, piece)| piece.mean());
        Self { below, above, mean }
    }

    /// The loss 1 − E(μ), or 0 where it is negative: E may be a little more than 1 by rounding, and much more where a lobe
    /// gains energy.
    pub fn loss(&self, mu: f64) -> f64 {
        let value = self.signed(mu);
        if value < 0.0 { 0.0 } else { value } // NaN stays
    }

    /// The value of the series, negative where E is above 1.
    fn signed(&self, mu: f64) -> f64 {
        let mu = mu.clamp(MU_MIN, 1.0);
        match &self.above {
            Some((seam, above)) if mu > *seam => above.value(mu),
            _ => self.below.value(mu),
        }
    }

    /// The mean loss 1 − E_avg, integrated from the same polynomial, so that compensation adds exactly the energy that the
    /// curve says is lost, whatever the curve's error.
    pub fn mean_loss(&self) -> f64 {
        self.mean
    }

    /// The smallest μ at which E turns, the δ of the coordinate.
    pub fn delta(&self) -> f64 {
        self.below.coordinate.delta
    }

    /// The kinks in μe of min(1, max(E(μ), E(μe))).
    pub fn crossings(&self, mu: f64) -> Vec<f64> {
        let loss = self.signed(mu);
        if loss <= 0.0 {
            return Vec::new(); // the maximum is 1 at every μe
        }
        let seam = self.above.iter().map(|(seam, _)| *seam);
        let mut kinks: Vec<_> = seam.chain([mu]).collect();
        // The fixed one itself is there already.
        let others = self.at_level(loss).into_iter().filter(|other| (other - mu).abs() > 1e-6 * mu);
        kinks.extend(others.take(LEVELS));
        kinks.extend(self.at_level(0.0).into_iter().take(LEVELS));
        kinks
    }

    /// The μ at which 1 − E(μ) crosses a level, by bisection.
    fn at_level(&self, level: f64) -> Vec<f64> {
        const STEPS: usize = 256;
        let coordinate = CurveCoordinate::new(false, self.delta(), [MU_MIN, 1.0]);
        let above = |mu: f64| self.signed(mu) > level;
        let mu = |k: usize| coordinate.mu(2.0 * k as f64 / STEPS as f64 - 1.0);
        let mut found = Vec::new();
        for k in 0..STEPS {
            let [mut low, mut high] = [mu(k), mu(k + 1)];
            if above(low) == above(high) {
                continue;
            }
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if above(middle) == above(low) { low = middle } else { high = middle }
            }
            found.push(low);
        }
        found
    }
}

/// The largest number of other μ at which E takes the same value; more crossings are noise.
const LEVELS: usize = 2;

/// The largest number of kinks: at the fixed μ, at a seam, and at two levels.
pub(super) const CROSSINGS: usize = 2 + 2 * LEVELS;

/// Integrates 1 − E at ascending μ by the model's own rule.
fn integrate_loss(model: &'static Model, setting: &Setting, mus: Vec<f64>) -> Vec<f64> {
    let count = mus.len();
    let albedo = || -> Result<Vec<f64>> {
        let roughness = model.shape.map(|shape| shape.roughness(setting.alpha));
        let axes = vec![Axis::listed(Variable::Mu, mus)?];
        let plan = TablePlan::basis("E", &SPLIT_SUM, model, roughness, axes)?;
        let plan = plan.with_all_parameters(setting.parameters)?.with_tolerance(FINEST)?;
        let lobe = &plan.lobes()[0];
        let rules = RuleSet::new(&plan, lobe);
        let RuleKind::Integrals { inner, outer } = &rules.kind else { return Ok(vec![f64::NAN; count]) };
        let Ok(texels) = evaluate::texels(&rules, inner, outer, lobe, &|_| Ok::<_, Infallible>(()));
        Ok(texels.into_iter().map(|[a, b]| 1.0 - (a + b)).collect())
    };
    // A plan refuses a lobe without an albedo; if one came here, it would be NaN.
    albedo().unwrap_or_else(|_| vec![f64::NAN; count])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model;
    use crate::model::truth;

    /// A curve keeps its promised error between its points, with a seam and without one, against the reference's E.
    #[test]
    fn curves_hold_what_they_promise() {
        for name in ["ggx-smith-correlated-none", "charlie-smith-correlated-none"] {
            let model = model::find(name).unwrap();
            for alpha in [5e-3, 0.04, 0.3, 1.0] {
                let setting = Setting { alpha, parameters: model.defaults() };
                let curve = AlbedoCurve::cached(model, &setting);
                for mu in [1e-6, 3e-3, 0.0123, 0.26, 0.4999, 0.5001, 0.71, 0.9999] {
                    let exact: f64 = truth::rho_dh(model, mu, &setting).into_iter().sum();
                    let error = (curve.signed(mu) + exact - 1.0).abs();
                    println!("{name}, α = {alpha}, μ = {mu}: {error:.1e}");
                    assert!(
                        error <= crate::model::compensation::ALBEDO_ERROR * exact.max(1.0),
                        "{name}, {alpha}, {mu}: {error:e}"
                    );
                }
            }
        }
    }
}
