//! Integrals of lobes that differ in their Fresnel term alone share all but the term's coefficients.
//!
//! F is a polynomial of c = ωi·ωm within a tolerance, F = Σ aₖ Tₖ(2c − 1), so that ρ = Σ aₖ Mₖ with the moments
//! Mₖ = ∫ D G2 / (4 μi μe) Tₖ(2c − 1) cos θe dωe. The moments of the last tables are kept: the three channels of a film, and
//! films on different bases, are one integration and some products.

use crate::integrate::listed_rule::{At, ListedRule};
use crate::model::directions::Fixed;
use crate::model::lobe::Lobe;
use crate::model::parameters::Setting;
use crate::model::{Facet, FacetSum, Model};
use rayon::prelude::*;
use std::f64::consts::PI;
use std::sync::{Arc, Mutex, PoisonError};

/// The share of a tolerance that the polynomial may be off by.
const SERIES_SHARE: f64 = 0.1;

/// Degrees are in steps of this, so that few moments differ.
const STEP: usize = 12;

/// The largest degree that pays.
const MOST: usize = 8 * STEP;

/// Numbers that are kept at most: 128 MiB.
const KEPT: usize = 1 << 24;

/// The inner integrals of a rule, as products of moments and coefficients.
pub(crate) struct SeriesIntegrals {
    moments: Arc<Moments>,
    /// Those of (A, B) for each row.
    coefficients: Vec<Vec<[f64; 2]>>,
}

/// Moments of each inner integral.
struct Moments {
    key: Key,
    /// How many each has.
    terms: usize,
    /// In the order of the integrals; NaN where the lobe is a delta.
    values: Vec<f64>,
}

/// What moments depend on.
#[derive(PartialEq)]
struct Key {
    parts: [&'static str; 2],
    fixed: Vec<Fixed>,
    /// Without what the Fresnel term reads.
    settings: Vec<Setting>,
    tolerance: f64,
    degree: usize,
}

impl SeriesIntegrals {
    /// The integrals of a lobe over listed directions, where they are worth it.
    pub fn new<E: Send>(
        rule: &ListedRule,
        lobe: &Lobe,
        tick: &(impl Fn(f64) -> Result<(), E> + Sync),
    ) -> Result<Option<Self>, E> {
        let Some(terms) = lobe.model().microfacet.filter(|_| !rule.has_factors()) else { return Ok(None) };
        let (Some(facets), Some(masking)) = (&terms.facets, &terms.masking) else { return Ok(None) };
        let Some(degree_of) = facets.degree else { return Ok(None) };
        let degree = |share: f64| {
            let degrees = rule.settings.iter().map(|s| degree_of(s, share * rule.tolerance));
            let most = degrees.max().unwrap_or(0).max(1);
            most.next_multiple_of(STEP)
        };
        // A step more than the degree of the rule serves most films, which then share moments.
        let (degree, series_degree) = (degree(1.0), degree(SERIES_SHARE).max(degree(1.0) + STEP));
        if series_degree > MOST {
            return Ok(None);
        }
        let settings = rule.settings.iter().map(|s| Setting { parameters: without_fresnel(s), ..*s });
        let key = Key {
            parts: [terms.ndf.name, masking.name],
            fixed: rule.fixed.clone(),
            settings: settings.collect(),
            tolerance: rule.tolerance,
            degree,
        };
        let moments = match kept(&key, series_degree + 1) {
            Some(moments) => moments,
            None => keep(Moments::new(key, rule, lobe.model(), series_degree + 1, tick)?),
        };
        let coefficients = rule.settings.iter().map(|s| coefficients(facets, s, series_degree)).collect();
        Ok(Some(Self { moments, coefficients }))
    }

    /// The inner integral of an index; `None` where the lobe is a delta.
    pub fn integral(&self, index: usize) -> Option<[f64; 2]> {
        let Moments { terms, values, key } = &*self.moments;
        let moments = &values[index * terms..][..*terms];
        let mut sum = [0.0; 2];
        for (moment, [a, b]) in moments.iter().zip(&self.coefficients[index / key.fixed.len()]) {
            sum = [sum[0] + moment * a, sum[1] + moment * b];
        }
        // F is not negative; what rounds may be.
        (!moments[0].is_nan()).then(|| sum.map(|x| x.max(0.0)))
    }
}

impl Moments {
    fn new<E: Send>(
        key: Key,
        rule: &ListedRule,
        model: &Model,
        terms: usize,
        tick: &(impl Fn(f64) -> Result<(), E> + Sync),
    ) -> Result<Self, E> {
        let count = rule.settings.len() * rule.fixed.len();
        let moments = |index: usize| {
            tick(1.0 / count as f64)?;
            let Some(facets) = rule.facets(index, model) else { return Ok(vec![f64::NAN; terms]) };
            let At { setting, fixed, .. } = rule.at(index);
            let mut sum = MomentSum::new(terms);
            (facets.visit)(&fixed, &setting, rule.tolerance, Some(key.degree), &mut |facet| sum.add(&facet));
            Ok(sum.finish())
        };
        let values = (0..count).into_par_iter().map(moments).collect::<Result<Vec<_>, E>>()?.concat();
        Ok(Self { key, terms, values })
    }
}

/// Facets that stay in the nearest cache.
const BLOCK: usize = 64;

/// Σ w Tₖ(2c − 1) over facets of weight w.
struct MomentSum {
    sums: Vec<f64>,
    /// 2c − 1 and w of facets that are not summed yet.
    block: [[f64; BLOCK]; 2],
    count: usize,
}

impl MomentSum {
    fn new(terms: usize) -> Self {
        Self { sums: vec![0.0; terms], block: [[0.0; BLOCK]; 2], count: 0 }
    }

    fn add(&mut self, &Facet { c, weight, .. }: &Facet) {
        self.block[0][self.count] = 2.0 * c - 1.0;
        self.block[1][self.count] = weight;
        self.count += 1;
        if self.count == BLOCK {
            self.sum_block();
        }
    }

    fn finish(mut self) -> Vec<f64> {
        self.block[1][self.count..].fill(0.0);
        self.sum_block();
        self.sums
    }

    fn sum_block(&mut self) {
        // w Tₖ and w Tₖ₋₁, which T₋₁ = T₁ begins.
        let [t, mut now] = self.block;
        let mut before: [f64; BLOCK] = std::array::from_fn(|k| now[k] * t[k]);
        for sum in &mut self.sums {
            *sum += now.iter().sum::<f64>();
            for k in 0..BLOCK {
                let next = 2.0 * t[k] * now[k] - before[k];
                before[k] = now[k];
                now[k] = next;
            }
        }
        self.count = 0;
    }
}

/// The coefficients of F in Tₖ(2c − 1), from its values at the zeros of a polynomial of twice the degree: c = cos²(ψ/2).
fn coefficients(facets: &FacetSum, s: &Setting, degree: usize) -> Vec<[f64; 2]> {
    let count = 2 * (degree + 1);
    let psi = |j: usize| PI * (j as f64 + 0.5) / count as f64;
    let values: Vec<_> = (0..count)
        .map(|j| {
            let (sin, cos) = (0.5 * psi(j)).sin_cos();
            (facets.fresnel)(cos * cos, sin * sin, s)
        })
        .collect();
    let coefficient = |k: usize| {
        let share = if k == 0 { 1.0 } else { 2.0 } / count as f64;
        let terms = values.iter().enumerate().map(|(j, f)| f.map(|f| share * f * (k as f64 * psi(j)).cos()));
        terms.fold([0.0; 2], |[a, b], [more_a, more_b]| [a + more_a, b + more_b])
    };
    (0..=degree).map(coefficient).collect()
}

fn without_fresnel(s: &Setting) -> [f64; 8] {
    let mut parameters = s.parameters;
    parameters[4..].fill(0.0);
    parameters
}

/// The moments of the last tables, the latest last.
static LAST: Mutex<Vec<Arc<Moments>>> = Mutex::new(Vec::new());

fn kept(key: &Key, terms: usize) -> Option<Arc<Moments>> {
    let last = LAST.lock().unwrap_or_else(PoisonError::into_inner);
    last.iter().find(|moments| moments.terms >= terms && moments.key == *key).cloned()
}

fn keep(moments: Moments) -> Arc<Moments> {
    let moments = Arc::new(moments);
    let mut last = LAST.lock().unwrap_or_else(PoisonError::into_inner);
    last.push(moments.clone());
    let size = |last: &[Arc<Moments>]| last.iter().map(|moments| moments.values.len()).sum::<usize>();
    while size(&last) > KEPT {
        last.remove(0);
    }
    moments
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrate::listed_rule::{ListedSource, ListedSum};
    use crate::model::{self, Integral};
    use std::convert::Infallible;
    use std::f64::consts::FRAC_PI_2;

    /// Moments make the sum over the lobe's own directions, within the tolerance: of films that share them, and at a delta.
    #[test]
    fn moments_make_the_lobe_s_own_integral() {
        let model = model::find("ggx-anisotropic-smith-correlated-thin-film").unwrap();
        let Integral::Listed(map) = model.integral else { panic!("{} has a kernel", model.name) };
        let fixed = [[1.0, 0.0], [0.7, 0.3], [0.1, 1.2], [1e-3, 0.8]];
        let fixed = fixed.map(|[mu, phi]| Fixed { mu, phi, factored: false, kinks: Vec::new() }).to_vec();
        for tolerance in [1e-3, 1e-5] {
            for [f0, channel] in [[0.04, 0.0], [0.04, 2.0], [0.8, 1.0]] {
                let mut lobe = Lobe::new(model, Some(0.5), vec![[1.0, 0.0]]).unwrap();
                for (name, value) in [("aspect", 4.0), ("f0", f0), ("channel", channel)] {
                    lobe.set(name, value).unwrap();
                }
                let settings = lobe.settings(&[0.0, 0.1, 0.6]);
                let rule = ListedRule::new(ListedSource::Map(map), fixed.clone(), settings, tolerance);
                let series =
                    SeriesIntegrals::new(&rule, &lobe, &|_| Ok::<_, Infallible>(())).unwrap().unwrap();
                for index in 0..12 {
                    let own = match rule.integral(index) {
                        ListedSum::Limit(_) => None,
                        ListedSum::Samples(samples) => Some(samples.iter().fold(0.0, |sum, sample| {
                            let s = &rule.settings[index / 4];
                            sum + sample.weight * (model.lobe)(&sample.pair, &sample.azimuth, s)[0]
                        })),
                    };
                    let shared = series.integral(index).map(|[a, _]| a);
                    assert_eq!(shared.is_some(), index >= 4);
                    let off = own.zip(shared).map_or(0.0, |(own, shared)| (own - shared).abs());
                    assert!(off <= tolerance, "{off:e} at {index} of {f0}, {channel} for {tolerance:e}");
                }
            }
        }
    }

    /// A tolerance is kept by few nodes: against a rule that has converged, over films, bases and shapes.
    #[test]
    fn tolerances_are_kept() {
        let model = model::find("ggx-anisotropic-smith-correlated-thin-film").unwrap();
        let Integral::Listed(map) = model.integral else { panic!("{} has a kernel", model.name) };
        let golden = |k: usize, share: f64| (0.5 + k as f64 * share).fract();
        let cases = if crate::base::is_thorough() { 400 } else { 40 };
        let worst = (0..cases).into_par_iter().map(|k| {
            let mut lobe = Lobe::new(model, Some(0.5), vec![[1.0, 0.0]]).unwrap();
            let of = |share| golden(k, share);
            for (name, value) in [
                ("aspect", 100f64.powf(2.0 * of(0.7549) - 1.0)),
                ("thickness", 800.0 * of(0.5698)),
                ("film_eta", 1.1 + of(0.8192)),
                ("f0", of(0.6710)),
                ("channel", (3.0 * of(0.5497)).floor()),
            ] {
                lobe.set(name, value).unwrap();
            }
            let (mu, phi) = (2f64.powf(-12.0 * of(0.4503).powi(2)), FRAC_PI_2 * of(0.3717));
            let fixed = vec![Fixed { mu, phi, factored: false, kinks: Vec::new() }];
            let settings = lobe.settings(&[2f64.powf(-10.0 * of(0.3069).powi(2))]);
            let rule = |tolerance: f64| {
                ListedRule::new(ListedSource::Map(map), fixed.clone(), settings.clone(), tolerance)
            };
            let own = |tolerance: f64| match rule(tolerance).integral(0) {
                ListedSum::Limit(limit) => limit[0],
                ListedSum::Samples(samples) => samples
                    .iter()
                    .map(|s| s.weight * (model.lobe)(&s.pair, &s.azimuth, &settings[0])[0])
                    .sum(),
            };
            let exact = own(1e-8);
            [1e-2, 1e-3, 1e-4, 1e-5, 1e-6].map(|tolerance| {
                let rule = rule(tolerance);
                let series = SeriesIntegrals::new(&rule, &lobe, &|_| Ok::<_, Infallible>(())).unwrap();
                series.map_or(0.0, |series| (series.integral(0).unwrap()[0] - exact).abs() / tolerance)
            })
        });
        let worst = worst.reduce(|| [0.0; 5], |a, b| std::array::from_fn(|d| f64::max(a[d], b[d])));
        println!("{worst:.3?}");
        assert!(worst.iter().all(|&share| share <= 1.0), "{worst:?} of 1e-2 … 1e-6");
    }
}
