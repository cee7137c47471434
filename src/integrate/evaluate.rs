//! Evaluates the integrals of a lobe in f64 on the host, on all cores.

use super::chebyshev::Matrix;
use super::direction_rule::Texel;
use super::rule_set::{Inner, Work};
use crate::model::ALPHA_MIN_INTEGRAL;
use crate::model::directions::Sample;
use crate::model::lobe::Lobe;
use rayon::prelude::*;
/// (A, B) of each texel: `outer` makes them of the inner integrals.
///
/// `tick` is called as work is done, with a share of 1, and stops it by returning an error.
pub(crate) fn texels<E: Send>(
    work: &Work,
    inner: &Inner,
    outer: &[Matrix],
    lobe: &Lobe,
    tick: &(impl Fn(f64) -> Result<(), E> + Sync),
) -> Result<Vec<[f64; 2]>, E> {
    let count = work.alphas.len() * inner.count();
    let raw = |at: usize| integrate(work, inner, lobe, at / inner.count(), at % inner.count());
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
    let one = |at: usize| {
        tick(1.0 / count as f64)?;
        Ok(raw(at))
    };
    let raw = (0..count).into_par_iter().map(one).collect::<Result<Vec<_>, E>>()?;
    let texels = outer.iter().fold(raw, |raw, matrix| matrix.apply(&raw));
    let raised = |x: f64| if x < 0.0 && x >= -work.below_zero() { 0.0 } else { x };
    Ok(texels.into_iter().map(|sum| sum.map(raised)).collect())
}

/// The inner integral `k` of a row of α.
fn integrate(work: &Work, inner: &Inner, lobe: &Lobe, row: usize, k: usize) -> [f64; 2] {
    let setting = &lobe.setting(work.alphas[row]);
    let alpha = setting.alpha;
    let mut sum = [0.0; 2];
    let mut add = |weight: f64, [a, b]: [f64; 2]| sum = [sum[0] + weight * a, sum[1] + weight * b];
    match inner {
        Inner::Slopes(work) if alpha < ALPHA_MIN_INTEGRAL => {
            return (work.slopes.mirror_limit)(work.mus[k], setting);
        }
        Inner::Slopes(work) => {
            let mu = work.mus[k];
            let map = work.slopes.map(work.tolerance);
            for (azimuths, nodes) in work.sides(row, k) {
                for &[c, t_max, t_max_inverse, weight] in azimuths {
                    let end = (map.end)(t_max, setting);
                    for node in nodes {
                        let f = (map.integrand)(end * node.x, [c, t_max, t_max_inverse], mu, setting);
                        add(weight * end * node.weight, f);
                    }
                }
            }
        }
        Inner::Samples(work) if alpha < ALPHA_MIN_INTEGRAL => {
            let mu = work.mus[k / work.chunks];
            return (work.mirror_limit)(mu, setting).map(|f| f * work.chunk as f64);
        }
        Inner::Samples(work) => return work.sum(row, k, setting),
        Inner::Product { pairs, azimuths } => {
            for azimuth in azimuths {
                add(pairs[k].weight * azimuth.weight, (lobe.model().lobe)(&pairs[k], azimuth, setting));
            }
        }
        Inner::Mapped(work) => match work.texel(row * work.fixed.len() + k) {
            Texel::Limit(limit) => return limit,
            Texel::Samples(samples) => {
                for Sample { pair, azimuth, weight } in &samples {
                    add(*weight, (lobe.model().lobe)(pair, azimuth, setting));
                }
            }
        },
        Inner::Analytic { directional, mus } => return directional(mus[k], setting),
    }
    sum
}
