//! 1 − E(μ) of a model at a setting, as a polynomial in asinh(μ/δ): E turns at μ ≈ α, and is analytic there. Where the
//! model has a seam, so that it is analytic neither there nor at the normal, as two: below it, and above in asinh((1 − μ)/δ).

use crate::base::error::Result;
use crate::base::half_angle::MU_MIN;
use crate::base::quadrature::gauss_legendre;
use crate::base::tolerance::FINEST;
use crate::integrate::evaluate;
use crate::integrate::rule_set::{Work, WorkKind};
use crate::model::Model;
use crate::model::parameters::Setting;
use crate::plan::TablePlan;
use crate::table::axis::{Axis, Variable};
use crate::table::quantity::SPLIT_SUM;
use std::collections::HashMap;
use std::convert::Infallible;
use std::f64::consts::PI;
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

/// 1 − E(μ), piece by piece.
pub(super) struct Curve {
    below: Piece,
    above: Option<(f64, Piece)>,
    /// 2 ∫ (1 − E) μ dμ
    mean: f64,
}

/// Σ c_k T_k(x) of a coordinate of μ.
struct Piece {
    along: Coordinate,
    coefficients: Vec<f64>,
}

/// x from −1 to 1 over a range of asinh(d/δ), where d is how far μ is from grazing or from the normal.
struct Coordinate {
    from_normal: bool,
    delta: f64,
    middle: f64,
    half: f64,
}

/// Where the last coefficients fall below it, the rest is noise of the integrals.
const NOISE: f64 = 5e-11;
/// Points to begin with, and to give up at: a model whose E is not analytic gets what they give.
const POINTS: [usize; 2] = [64, 512];
/// δ of 1 − μ above a seam: Charlie's E goes like (1 − μ)^c with c ≥ 1/6 there, of which 1e-10 is left at that distance.
const AT_NORMAL: f64 = 1e-12;
/// Curves that are kept: 2 MiB and less.
const MOST: usize = 2048;

type Key = (&'static str, u64, [u64; 8]);
static CURVES: LazyLock<Mutex<HashMap<Key, Arc<Curve>>>> = LazyLock::new(Mutex::default);

impl Coordinate {
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

    /// |dμ/dx|
    fn slope(&self, x: f64) -> f64 {
        self.delta * (self.middle + self.half * x).cosh() * self.half
    }
}

impl Piece {
    /// As many points as it takes.
    fn new(along: Coordinate, missing: &dyn Fn(Vec<f64>) -> Vec<f64>) -> Self {
        let mut points = POINTS[0];
        let mut piece = Self { along, coefficients: Vec::new() };
        loop {
            piece.coefficients = coefficients(points, &piece.along, missing);
            let last = piece.coefficients.iter().rev().take(4);
            // NaN is not worth another try.
            let is_rough = last.into_iter().any(|c| c.abs() > NOISE);
            if !is_rough || points >= POINTS[1] {
                return piece;
            }
            points *= 2;
        }
    }

    /// By Clenshaw's recurrence.
    fn at(&self, mu: f64) -> f64 {
        let x = self.along.x(mu);
        let step = |[b1, b2]: [f64; 2], c: &f64| [c + 2.0 * x * b1 - b2, b1];
        let [b1, b2] = self.coefficients[1..].iter().rev().fold([0.0; 2], step);
        self.coefficients[0] + x * b1 - b2
    }

    /// 2 ∫ max(0, 1 − E) μ dμ
    fn mean(&self) -> f64 {
        let nodes = gauss_legendre(self.coefficients.len() + 32);
        let term = |x: f64| {
            let mu = self.along.mu(x);
            let missing = self.at(mu);
            2.0 * (if missing < 0.0 { 0.0 } else { missing }) * mu * self.along.slope(x) * 2.0
        };
        nodes.iter().map(|node| node.weight * term(2.0 * node.x - 1.0)).sum()
    }
}

/// At n Chebyshev points.
fn coefficients(n: usize, along: &Coordinate, missing: &dyn Fn(Vec<f64>) -> Vec<f64>) -> Vec<f64> {
    let angle = |k: usize| PI * (k as f64 + 0.5) / n as f64;
    // Descending in x, and so in μ but where that is 1 less a distance.
    let mut mus: Vec<_> = (0..n).map(|k| along.mu(angle(k).cos())).collect();
    if !along.from_normal {
        mus.reverse();
    }
    let mut values = missing(mus);
    if !along.from_normal {
        values.reverse();
    }
    let coefficient = |j: usize| {
        let sum: f64 = values.iter().enumerate().map(|(k, m)| m * (j as f64 * angle(k)).cos()).sum();
        sum * if j == 0 { 1.0 } else { 2.0 } / n as f64
    };
    (0..n).map(coefficient).collect()
}

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
        let missing = |mus| missing(model, setting, mus);
        let (below, above) = match model.microfacet.and_then(|made| made.seam) {
            // μ from 2⁻²⁴ to 1 spans decades whatever α is, since E is not analytic at 0.
            None => {
                let delta = (1e-3 * setting.alpha).clamp(4.0 * MU_MIN, 1e-4);
                (Piece::new(Coordinate::new(false, delta, [MU_MIN, 1.0]), &missing), None)
            }
            Some(seam) => {
                let below = Coordinate::new(false, 4.0 * MU_MIN, [MU_MIN, seam]);
                let above = Coordinate::new(true, AT_NORMAL, [0.0, 1.0 - seam]);
                (Piece::new(below, &missing), Some((seam, Piece::new(above, &missing))))
            }
        };
        let mean = below.mean() + above.as_ref().map_or(0.0, |(_, piece)| piece.mean());
        Self { below, above, mean }
    }

    /// 1 − E(μ); never below 0: E may be a little more than 1 by rounding, and much more where a lobe gains energy.
    pub fn missing(&self, mu: f64) -> f64 {
        let value = self.signed(mu);
        if value < 0.0 { 0.0 } else { value } // NaN stays
    }

    fn signed(&self, mu: f64) -> f64 {
        let mu = mu.clamp(MU_MIN, 1.0);
        match &self.above {
            Some((seam, above)) if mu > *seam => above.at(mu),
            _ => self.below.at(mu),
        }
    }

    /// 1 − E_avg: of the very polynomial, so that what is added is what is missing, whatever its error.
    pub fn mean_missing(&self) -> f64 {
        self.mean
    }

    /// The smallest μ at which E turns.
    pub fn delta(&self) -> f64 {
        self.below.along.delta
    }

    /// Where max(E(μ), E(μe)), at most 1, has kinks in μe.
    pub fn crossings(&self, mu: f64) -> Vec<f64> {
        let here = self.signed(mu);
        if here <= 0.0 {
            return Vec::new(); // it is 1
        }
        let seam = self.above.iter().map(|(seam, _)| *seam);
        let mut kinks: Vec<_> = seam.chain([mu]).collect();
        // The fixed one itself is there already.
        let others = self.at_level(here).into_iter().filter(|other| (other - mu).abs() > 1e-6 * mu);
        kinks.extend(others.take(LEVELS));
        kinks.extend(self.at_level(0.0).into_iter().take(LEVELS));
        kinks
    }

    /// Where 1 − E(μ) is so much.
    fn at_level(&self, level: f64) -> Vec<f64> {
        const STEPS: usize = 256;
        let along = Coordinate::new(false, self.delta(), [MU_MIN, 1.0]);
        let above = |mu: f64| self.signed(mu) > level;
        let at = |k: usize| along.mu(2.0 * k as f64 / STEPS as f64 - 1.0);
        let mut found = Vec::new();
        for k in 0..STEPS {
            let [mut low, mut high] = [at(k), at(k + 1)];
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

/// E rises or falls at most so often that it takes a value at so many others; more is noise.
const LEVELS: usize = 2;

/// At most so many kinks: the fixed μ, a seam, and two values.
pub(super) const CROSSINGS: usize = 2 + 2 * LEVELS;

/// 1 − E at some ascending μ, by the model's own integrals.
fn missing(model: &'static Model, setting: &Setting, mus: Vec<f64>) -> Vec<f64> {
    let count = mus.len();
    let albedo = || -> Result<Vec<f64>> {
        let roughness = model.shape.map(|shape| shape.roughness(setting.alpha));
        let axes = vec![Axis::listed(Variable::Mu, mus)?];
        let plan = TablePlan::basis("E", &SPLIT_SUM, model, roughness, axes)?;
        let plan = plan.with_all_parameters(setting.parameters)?.with_tolerance(FINEST)?;
        let lobe = &plan.lobes()[0];
        let work = Work::new(&plan, lobe);
        let WorkKind::Integrals { inner, outer } = &work.kind else { return Ok(vec![f64::NAN; count]) };
        let Ok(texels) = evaluate::texels(&work, inner, outer, lobe, &|_| Ok::<_, Infallible>(()));
        Ok(texels.into_iter().map(|[a, b]| 1.0 - (a + b)).collect())
    };
    // A plan refuses what has no albedo; were it to come here, no number would.
    albedo().unwrap_or_else(|_| vec![f64::NAN; count])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model;
    use crate::model::truth;

    /// A curve is as good as it says between its points, with a seam and without one; the reference has what E is.
    #[test]
    fn curves_hold_what_they_promise() {
        for name in ["ggx-smith-correlated-none", "charlie-smith-correlated-none"] {
            let model = model::find(name).unwrap();
            for alpha in [5e-3, 0.04, 0.3, 1.0] {
                let setting = Setting { alpha, parameters: model.defaults() };
                let curve = Curve::of(model, &setting);
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
