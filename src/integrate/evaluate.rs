//! One inner integral of a rule, in f64 on the host.

use super::direction_rule::Texel;
use super::rule_set::{Inner, Work};
use crate::model::ALPHA_MIN_INTEGRAL;
use crate::model::directions::Sample;
use crate::model::lobe::Lobe;
/// The inner integral `k` of a row of α.
pub(crate) fn integrate(work: &Work, inner: &Inner, lobe: &Lobe, row: usize, k: usize) -> [f64; 2] {
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
                add(pairs[k].weight * azimuth.weight, (lobe.model.lobe)(&pairs[k], azimuth, setting));
            }
        }
        Inner::Mapped(work) => match work.texel(row * work.fixed.len() + k) {
            Texel::Limit(limit) => return limit,
            Texel::Samples(samples) => {
                for Sample { pair, azimuth, weight } in &samples {
                    add(*weight, (lobe.model.lobe)(pair, azimuth, setting));
                }
            }
        },
        Inner::Analytic { directional, mus } => return directional(mus[k], setting),
    }
    sum
}
