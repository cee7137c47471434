//! Evaluates the integrals of a lobe in f64 on the host, on all cores.

use super::chebyshev::Matrix;
use super::fresnel_series::SeriesIntegrals;
use super::rule_set::{InnerRule, RuleSet};
use crate::model::ALPHA_MIN_INTEGRAL;
use crate::model::lobe::Lobe;
use rayon::prelude::*;

/// Integrates (A, B) of each texel: the matrices `outer` sum up the inner integrals.
///
/// It calls `tick` as it goes on, with a share of 1; an error from `tick` stops it.
pub(crate) fn texels<E: Send>(
    rules: &RuleSet,
    inner: &InnerRule,
    outer: &[Matrix],
    lobe: &Lobe,
    tick: &(impl Fn(f64) -> Result<(), E> + Sync),
) -> Result<Vec<[f64; 2]>, E> {
    let count = rules.alphas.len() * inner.count();
    let series = match inner {
        InnerRule::Listed(rule) => SeriesIntegrals::new(rule, lobe, tick)?,
        _ => None,
    };
    let raw = |index: usize| {
        let by_series = series.as_ref().and_then(|series| series.integral(index));
        by_series
            .unwrap_or_else(|| integrate(rules, inner, lobe, index / inner.count(), index % inner.count()))
    };
    // Where there are moments, these were the work.
    let tick = |share: f64| if series.is_some() { Ok(()) } else { tick(share) };
    if let [sum] = outer {
        let texels = count / sum.columns;
        let texel = |texel: usize| {
            let terms =
                sum.values.iter().enumerate().map(|(k, weight)| (weight, raw(texel * sum.columns + k)));
            let total = terms.fold([0.0; 2], |sum, (w, [a, b])| [sum[0] + w * a, sum[1] + w * b]);
            tick(1.0 / texels as f64)?;
            Ok(total)
        };
        return (0..texels).into_par_iter().map(texel).collect();
    }
    let counted = |index: usize| {
        tick(1.0 / count as f64)?;
        Ok(raw(index))
    };
    let raw = (0..count).into_par_iter().map(counted).collect::<Result<Vec<_>, E>>()?;
    let texels = outer.iter().fold(raw, |raw, matrix| matrix.apply(&raw));
    let raised = |x: f64| if x < 0.0 && x >= -rules.below_zero() { 0.0 } else { x };
    Ok(texels.into_iter().map(|sum| sum.map(raised)).collect())
}

/// The inner integral `k` of a row of α.
fn integrate(rules: &RuleSet, inner: &InnerRule, lobe: &Lobe, row: usize, k: usize) -> [f64; 2] {
    let setting = &lobe.setting(rules.alphas[row]);
    let alpha = setting.alpha;
    let mut sum = [0.0; 2];
    let mut add = |weight: f64, [a, b]: [f64; 2]| sum = [sum[0] + weight * a, sum[1] + weight * b];
    match inner {
        InnerRule::Slopes(rule) if alpha < ALPHA_MIN_INTEGRAL => {
            return (rule.slopes.mirror_limit)(rule.mus[k], setting);
        }
        InnerRule::Slopes(rule) => {
            let mu = rule.mus[k];
            let map = rule.map();
            for (azimuths, nodes) in rule.sides(row, k) {
                for &[c, t_max, t_max_inverse, weight] in azimuths {
                    let end = (map.end)(t_max, setting);
                    for node in nodes {
                        let f = (map.integrand)(end * node.x, [c, t_max, t_max_inverse], mu, setting);
                        add(weight * end * node.weight, f);
                    }
                }
            }
        }
        InnerRule::Samples(rule) if alpha < ALPHA_MIN_INTEGRAL => {
            let mu = rule.mus[k / rule.chunks];
            return (rule.mirror_limit)(mu, setting).map(|f| f * rule.chunk as f64);
        }
        InnerRule::Samples(rule) => return rule.sum(row, k, setting),
        InnerRule::Product { pairs, azimuths } => {
            for azimuth in azimuths {
                add(pairs[k].weight * azimuth.weight, (lobe.model().lobe)(&pairs[k], azimuth, setting));
            }
        }
        InnerRule::Listed(rule) => return rule.sum(row * rule.fixed.len() + k, lobe.model()),
        InnerRule::ClosedForm { directional, mus } => return directional(mus[k], setting),
    }
    sum
}
