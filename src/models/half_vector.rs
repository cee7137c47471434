//! Directions for the integrals of microfacet lobes, by the map of their normals, on the host in f64: for whatever has
//! no kernel of its own. As `shaders/lobe/slopes.wgsl`: about the fixed direction, in the azimuth φ of ωm and in
//! r(tan θm), up to the horizon; but G2 may be anything, and panels end where it has a kink.

pub(crate) mod stretched;

use super::masking::Masking;
use super::ndf::{Map, Ndf};
use super::{SlopeCounts, is_fine};
use crate::mapped::{Fixed, Sample};
use crate::pair::{Azimuth, Half, Pair};
use crate::quadrature::{Node, gauss_legendre};
use crate::setting::Setting;
use crate::slopes::turns;

/// Directions and what they weigh: cos θ dω of them.
pub(super) fn samples<N: Ndf, M: Masking>(
    fixed: &Fixed,
    s: &Setting,
    counts: [SlopeCounts; 2],
    tolerance: f64,
) -> Vec<Sample> {
    let mu = fixed.mu;
    let sin = ((1.0 - mu) * (1.0 + mu)).sqrt();
    let fine = is_fine(tolerance);
    let end = |t| if fine { N::fine_end(t, s) } else { N::coarse_end(t, s) };
    let map = |r| if fine { N::fine_map(r, s) } else { N::coarse_map(r, s) };
    let mut samples = Vec::new();
    for (sign, counts) in [1.0, -1.0].into_iter().zip(counts) {
        let more = if fixed.factored { 2 } else { 1 };
        let nodes = gauss_legendre(more * counts.nodes);
        for turn in turns(mu, sign, &gauss_legendre(more * counts.azimuths), tolerance) {
            let ray = Ray::new([mu, sin], [turn.cos, turn.sin], turn.weight);
            along::<N, M>(&ray, fixed, &nodes, &end, &map, s.alpha, s, &mut samples);
        }
    }
    samples
}

/// At most so many.
pub(super) fn most<M: Masking>(counts: [SlopeCounts; 2]) -> usize {
    counts.map(|c| c.azimuths * c.nodes).iter().sum::<usize>() * (1 + M::MOST_BREAKS)
}

/// Normals of one azimuth.
struct Ray {
    /// cos θ and sin θ of the fixed direction.
    fixed: [f64; 2],
    /// cos and sin of the azimuth from that of the fixed direction.
    turn: [f64; 2],
    /// tan θ of the fixed direction times the cosine of the azimuth.
    c: f64,
    /// tan θm of the normal that reflects the fixed direction onto the horizon.
    t_max: f64,
    /// dφ/2π
    weight: f64,
}

impl Ray {
    fn new([mu, sin]: [f64; 2], turn: [f64; 2], weight: f64) -> Self {
        let c = sin / mu * turn[0];
        let root = c.hypot(1.0);
        let t_max = if c > 0.0 { c + root } else { 1.0 / (root - c) };
        Self { fixed: [mu, sin], turn, c, t_max, weight }
    }
}

/// The directions that the normals of a ray reflect the fixed one to.
#[allow(clippy::too_many_arguments)]
fn along<N: Ndf, M: Masking>(
    ray: &Ray,
    fixed: &Fixed,
    nodes: &[Node],
    end: &impl Fn(f64) -> f64,
    map: &impl Fn(f64) -> Map,
    alpha: f64,
    s: &Setting,
    samples: &mut Vec<Sample>,
) {
    let Ray { fixed: [mu, sin], turn: [cos, sin_turn], c, t_max, weight: azimuth } = *ray;
    let mut ends = vec![0.0];
    let breaks = M::breaks(c, mu).into_iter().filter(|&t| 0.0 < t && t < t_max);
    // cos θe = μ (1 + 2ct − t²)/(1 + t²) is k where (μ + k) t² − 2μct + k − μ = 0.
    let roots = |&k: &f64| {
        let root = (mu * mu * c * c - (k - mu) * (k + mu)).max(0.0).sqrt();
        [-root, root].map(|root| (mu * c + root) / (mu + k))
    };
    let kinks = fixed.kinks.iter().flat_map(roots).filter(|&t| 0.0 < t && t < t_max);
    let mut stops: Vec<_> = breaks.chain(kinks).chain([t_max]).collect();
    stops.sort_by(f64::total_cmp);
    ends.extend(stops.into_iter().map(end));
    for panel in ends.windows(2) {
        let (start, width) = (panel[0], panel[1] - panel[0]);
        for node in nodes {
            // Nodes crowd at r = 0 where G2 turns there: xⁿ.
            let graded = node.x.powi(M::GRADE);
            let weight = node.weight * f64::from(M::GRADE) * node.x.powi(M::GRADE - 1);
            let Map { p, m, weight: density } = map(start + width * graded);
            // D cos θm dωm = w dv dφ/2π
            let y = m * m + p * p;
            let root = y.sqrt();
            let half = Half { ht2: p * p, h2: y, c: 1.0, one_minus_c: 0.0 };
            let d = N::ndf(&half, m * m, &Setting { alpha, ..*s });
            let solid_angle = weight * width * density * m * azimuth / (d * (m / root));
            // ωe = 2 (ωi·ωm) ωm − ωi
            let projected = (sin * cos * p + mu * m) / root; // ωi·ωm
            let x = 2.0 * projected * (p / root) * cos - sin;
            let y_e = 2.0 * projected * (p / root) * sin_turn;
            let t = p / m;
            let mu_e = m * m / y * mu * (t_max - t) * (t + 1.0 / t_max);
            if !(mu_e > 0.0 && solid_angle.is_finite()) {
                continue;
            }
            let pair = Pair::of_cosines_and_sines([mu, mu_e], [sin, x.hypot(y_e)]);
            let azimuth = Azimuth::at(fixed.phi, (-y_e).atan2(-x));
            samples.push(Sample { pair, azimuth, weight: 4.0 * projected * mu_e * solid_angle });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::masking::smith_correlated::SmithCorrelated;
    use crate::models::ndf::{beckmann::Beckmann, ggx::Ggx};
    use crate::models::{self, ALPHA_MIN_VALUE};
    use crate::pair::MU_MIN;

    /// By directions as by slopes: the reference has what both must be.
    #[test]
    fn directions_meet_the_tolerance_as_slopes_do() {
        let models = [
            (
                "ggx",
                samples::<Ggx, SmithCorrelated> as fn(&Fixed, &Setting, [SlopeCounts; 2], f64) -> Vec<Sample>,
            ),
            ("beckmann", samples::<Beckmann, SmithCorrelated>),
        ];
        for (name, samples) in models {
            let model = models::find(name).unwrap();
            let models::Integral::Slopes(slopes) = model.integral else { unreachable!() };
            for tolerance in [1e-2, 1e-4, 1e-6, 1e-8] {
                let mut worst = 0f64;
                for mu in [1.0, 0.9, 0.5, 0.1, 1e-2, 1e-3, 1e-5, MU_MIN] {
                    for alpha in [1.0, 0.3, 0.1, 1e-2, 1e-3, 1e-5, ALPHA_MIN_VALUE] {
                        let s = alpha.into();
                        let fixed = Fixed { mu, phi: 0.0, factored: false, kinks: Vec::new() };
                        let counts = (slopes.counts)(mu, &s, tolerance);
                        let mut sum = [0.0; 2];
                        for Sample { pair, azimuth, weight } in samples(&fixed, &s, counts, tolerance) {
                            let f = (model.lobe)(&pair, &azimuth, &s);
                            sum = [sum[0] + weight * f[0], sum[1] + weight * f[1]];
                        }
                        let truth = model.reference.unwrap().rho_dh(mu, &s);
                        let error = (sum[0] - truth[0]).abs().max((sum[1] - truth[1]).abs());
                        worst = worst.max(error);
                    }
                }
                println!("{name} to {tolerance}: {worst:.1e}");
                assert!(worst <= tolerance, "{name}: {worst} of {tolerance}");
            }
        }
    }
}
