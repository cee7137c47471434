//! The same for normals that are stretched: along a ray of azimuth φ the slopes are those of an isotropic distribution
//! of α(φ), 1/α(φ)² = cos²φ/αx² + sin²φ/αy², and the rays are as dense as a turn dχ of the unstretched plane,
//! tan φ = (αy/αx) tan χ.

use crate::base::quadrature::{Node, gauss_legendre};
use crate::model::SlopeCounts;
use crate::model::directions::{Fixed, Sample};
use crate::model::half_vector::{Kinks, Normals, Reflected, along, normal, reflect, strips};
use crate::model::masking::{Masking, Toward};
use crate::model::ndf::{Coordinate, MappedSlope, Ndf};
use crate::model::parameters::Setting;
use crate::model::slope_azimuths::Turn;
use std::f64::consts::{FRAC_PI_2, PI};

/// Panels of χ for each side of `SlopeCounts`: eight in all.
pub(crate) const PANELS: usize = 4;

/// Directions and what they weigh.
pub(crate) fn samples<N: Ndf, M: Masking>(
    fixed: &Fixed,
    s: &Setting,
    counts: [SlopeCounts; 2],
    tolerance: f64,
) -> Vec<Sample> {
    let (Some(maps), Some(axes)) = (N::MAPS, N::AXES) else { return Vec::new() };
    let Coordinate { end, map } = maps.fine;
    let axes = axes(s);
    let counts = fixed.counts(counts[0]);
    let (rule, nodes) = (gauss_legendre(counts.azimuths), gauss_legendre(counts.nodes));
    let mut samples = Vec::new();
    for panel in panels(fixed, axes) {
        for node in &rule {
            let (turn, alpha) = panel.turn(node, fixed, axes);
            let s = Setting { alpha, ..*s };
            let (end, at) = (|t| end(t, &s), |r| normal::<N>(map(r, &s), &s));
            let kinks = M::OF_NORMAL.unwrap_or(Kinks::NONE);
            let normals = Normals { end: &end, at: &at, kinks, turn: None };
            along(&turn, fixed, &nodes, tolerance, &normals, &mut samples);
        }
    }
    samples
}

/// A microfacet that reflects ωi above the horizon: c = ωi·ωm, cos θe, and D G2 / (4 μi μe) cos θe dωe.
pub(crate) struct Facet {
    pub c: f64,
    pub mu_e: f64,
    pub weight: f64,
}

/// Visits the facets that `samples` lists the directions of. D dωm is what the map makes it, so that it is not evaluated.
///
/// It is for maskings that do not depend on the normal.
pub(crate) fn facets<N: Ndf, M: Masking>(
    fixed: &Fixed,
    s: &Setting,
    counts: [SlopeCounts; 2],
    tolerance: f64,
    visit: &mut dyn FnMut(Facet),
) {
    let (Some(maps), Some(axes)) = (N::MAPS, N::AXES) else { return };
    let Coordinate { end, map } = maps.fine;
    let axes @ [x, y] = axes(s);
    let counts = fixed.counts(counts[0]);
    let (rule, nodes) = (gauss_legendre(counts.azimuths), gauss_legendre(counts.nodes));
    let (sin, mu) = (fixed.sin(), fixed.mu);
    let (sin_phi, cos_phi) = fixed.phi.sin_cos();
    let toward = |mu: f64, alpha: f64| Toward { mu, setting: Setting { alpha, ..*s } };
    let toward_i = toward(mu, (x * cos_phi).hypot(y * sin_phi));
    for panel in panels(fixed, axes) {
        for node in &rule {
            let (turn, alpha) = panel.turn(node, fixed, axes);
            let s = Setting { alpha, ..*s };
            let end = |t| end(t, &s);
            // dχ/2π: D of α(φ) is D times αx αy/α(φ)², which dφ has of dχ.
            let dchi = turn.weight * alpha * alpha / (x * y);
            for strip in strips(&turn, fixed, tolerance, &end, &Kinks::NONE, None) {
                for node in &nodes {
                    let (r, dr) = strip.node(node);
                    let MappedSlope { p, m, weight } = map(r, &s);
                    let Reflected { c, mu_e, x_e: x_i, y_e: y_i, root } = reflect(&turn, [mu, sin], [p, m]);
                    // From the frame of ωi into that of the tangent.
                    let [x_e, y_e] = [x_i * cos_phi - y_i * sin_phi, x_i * sin_phi + y_i * cos_phi];
                    let sin2 = x_e * x_e + y_e * y_e;
                    let seen = ((x * x_e).powi(2) + (y * y_e).powi(2)) / sin2;
                    let toward_e = toward(mu_e, if sin2 > 0.0 { seen.sqrt() } else { x });
                    // D cos θm dωm = m weight dr dχ/2π and cos θm = m/root; dωe = 4 c dωm.
                    let weight = 4.0 * c * mu_e * weight * root * dr * dchi;
                    if mu_e > 0.0 && weight.is_finite() {
                        visit(Facet { c, mu_e, weight: weight * M::visibility::<N>(&toward_i, &toward_e) });
                    }
                }
            }
        }
    }
}

/// χ = start ± width sinh u, u from 0 to `reach`.
pub(super) struct Panel {
    start: f64,
    sign: f64,
    width: f64,
    pub reach: f64,
}

/// Panels of χ that go around, and end where ωi's horizon turns, at φ = φi ± π/2, and at the axis of the smaller α, where
/// φ(χ) turns; nodes crowd there as a sinh has them.
pub(super) fn panels(fixed: &Fixed, [x, y]: [f64; 2]) -> Vec<Panel> {
    let mu = fixed.mu;
    // χ of φ, in the same quadrant.
    let turned = |phi: f64| {
        let (sin, cos) = phi.sin_cos();
        (x * sin).atan2(y * cos)
    };
    let horizon = fixed.phi + FRAC_PI_2;
    let chi_horizon = turned(horizon).rem_euclid(PI);
    // dχ/dφ = α(φ)²/(αx αy) there; nothing turns faster than μ of φ, nor than the ratio of the α.
    let density = {
        let (sin, cos) = horizon.sin_cos();
        x * y / ((y * cos).powi(2) + (x * sin).powi(2))
    };
    let axis = if x < y { 0.0 } else { FRAC_PI_2 };
    let ratio = (x / y).min(y / x);
    let mut ends = [(chi_horizon, (mu * density).max(LEAST)), (axis, ratio.max(LEAST))];
    ends.sort_by(|a, b| a.0.total_cmp(&b.0));
    let [(first, width), (second, other)] = ends;
    // What is near is felt.
    let apart = (second - first).min(first + PI - second);
    let [width, other] = [width.min(other + apart), other.min(width + apart)];
    let mut panels = Vec::new();
    for (start, end, widths) in [
        (first, second, [width, other]),
        (second, first + PI, [other, width]),
        (first + PI, second + PI, [width, other]),
        (second + PI, first + 2.0 * PI, [other, width]),
    ] {
        let half = 0.5 * (end - start);
        for (start, sign, width) in [(start, 1.0, widths[0]), (end, -1.0, widths[1])] {
            panels.push(Panel { start, sign, width, reach: (half / width).asinh() });
        }
    }
    panels
}

impl Panel {
    /// The azimuth at a node of u/`reach`, and α along it.
    pub fn turn(&self, node: &Node, fixed: &Fixed, [x, y]: [f64; 2]) -> (Turn, f64) {
        let Self { start, sign, width, reach } = *self;
        let tan = fixed.sin() / fixed.mu;
        let u = reach * node.x;
        let (sin_chi, cos_chi) = (start + sign * width * u.sinh()).sin_cos();
        let dchi = node.weight * reach * width * u.cosh();
        // (αx cos χ, αy sin χ) = α(φ) (cos φ, sin φ)
        let alpha = (x * cos_chi).hypot(y * sin_chi);
        let weight = dchi * x * y / (alpha * alpha * 2.0 * PI);
        let (cos_phi, sin_phi) = (x * cos_chi / alpha, y * sin_chi / alpha);
        let (sin_i, cos_i) = fixed.phi.sin_cos();
        let (cos, sin_turn) = (cos_phi * cos_i + sin_phi * sin_i, sin_phi * cos_i - cos_phi * sin_i);
        (Turn::new(tan, [cos, sin_turn], weight), alpha)
    }
}

/// What turns faster contributes little: measured, as the best of 1e-5 … 0.1 at every count.
const LEAST: f64 = 0.03;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::half_angle::MU_MIN;
    use crate::model;
    use crate::model::masking::smith_correlated::SmithCorrelated;
    use crate::model::masking::smith_separable::SmithSeparable;
    use crate::model::ndf::beckmann::Beckmann;
    use crate::model::ndf::ggx::Ggx;
    use crate::model::ndf::stretched::{Stretch, Stretched};
    use rayon::prelude::*;

    /// The facets make the sum over the listed directions, to rounding.
    #[test]
    fn facets_and_directions_agree() {
        facets_make_samples::<Ggx, SmithCorrelated>("ggx-anisotropic");
        facets_make_samples::<Beckmann, SmithSeparable>("beckmann-anisotropic-smith-separable-schlick");
    }

    fn facets_make_samples<N: Stretch, M: Masking>(name: &str) {
        let model = model::find(name).unwrap();
        let counts = [SlopeCounts { azimuths: 20, nodes: 20 }; 2];
        for (mu, phi) in [(1.0, 0.0), (0.6, 0.4), (0.05, 1.3), (1e-4, 0.9)] {
            for (alpha, aspect) in [(0.5, 1.0), (0.1, 9.0), (1e-3, 0.04)] {
                let mut parameters = model.defaults();
                parameters[0] = aspect;
                let s = Setting { alpha, parameters };
                let fixed = Fixed { mu, phi, factored: false, kinks: Vec::new() };
                let [mut by_facets, mut by_directions] = [[0.0; 2]; 2];
                facets::<Stretched<N>, M>(&fixed, &s, counts, 1e-5, &mut |Facet { c, weight, .. }| {
                    let x = (1.0 - c).powi(5);
                    by_facets = [by_facets[0] + weight * (1.0 - x), by_facets[1] + weight * x];
                });
                for Sample { pair, azimuth, weight } in samples::<Stretched<N>, M>(&fixed, &s, counts, 1e-5) {
                    let [a, b] = (model.lobe)(&pair, &azimuth, &s);
                    by_directions = [by_directions[0] + weight * a, by_directions[1] + weight * b];
                }
                for (a, b) in by_facets.into_iter().zip(by_directions) {
                    assert!((a - b).abs() <= 1e-12, "{name} at {mu}, {phi}, {alpha}, {aspect}: {a} and {b}");
                }
            }
        }
    }

    /// Errors of counts: what the tables of `ndf/stretched.rs` are read from.
    #[test]
    #[ignore = "prints"]
    fn print_the_errors_of_counts() {
        type Samples = fn(&Fixed, &Setting, [SlopeCounts; 2], f64) -> Vec<Sample>;
        for (name, samples) in [
            ("ggx-anisotropic", samples::<Stretched<Ggx>, SmithCorrelated> as Samples),
            ("beckmann-anisotropic", samples::<Stretched<Beckmann>, SmithCorrelated>),
        ] {
            let model = model::find(name).unwrap();
            let mut cases = Vec::new();
            for mu in [1.0, 0.9, 0.5, 0.2, 0.05, 1e-2, 1e-3, 1e-5, MU_MIN] {
                for phi in [0.0, 0.3, 0.8, 1.3, FRAC_PI_2] {
                    for alpha in [1.0, 0.1, 1e-2, 1e-3] {
                        for aspect in [1.0, 3.0, 0.1, 100.0, 1e-2] {
                            let mut parameters = model.defaults();
                            parameters[0] = aspect;
                            cases.push((
                                Fixed { mu, phi, factored: false, kinks: Vec::new() },
                                Setting { alpha, parameters },
                            ));
                        }
                    }
                }
            }
            let rho = |fixed: &Fixed, s: &Setting, azimuths: usize, nodes: usize| {
                let all = samples(fixed, s, [SlopeCounts { azimuths, nodes }; 2], 1e-6);
                all.iter().fold([0.0; 2], |sum, Sample { pair, azimuth, weight }| {
                    let f = (model.lobe)(pair, azimuth, s);
                    [sum[0] + weight * f[0], sum[1] + weight * f[1]]
                })
            };
            let truth: Vec<_> = cases.par_iter().map(|(f, s)| rho(f, s, 60, 110)).collect();
            let worst = |azimuths: usize, nodes: usize| {
                let error = |((f, s), t): (&(Fixed, Setting), &[f64; 2])| {
                    let r = rho(f, s, azimuths, nodes);
                    (r[0] - t[0]).abs().max((r[1] - t[1]).abs())
                };
                cases.par_iter().zip(&truth).map(error).reduce(|| 0.0, f64::max)
            };
            for azimuths in [3, 4, 6, 8, 10, 12, 16, 20, 26, 32, 40] {
                println!("{name} azimuths {azimuths}: {:.1e}", worst(azimuths, 110));
            }
            for nodes in [5, 8, 12, 16, 20, 24, 32, 40, 50, 60, 80] {
                println!("{name} nodes {nodes}: {:.1e}", worst(60, nodes));
            }
        }
    }
}
