//! The rule set of one lobe of one table: its axes turned into half-angle terms, nodes and weights, all in f64. The device
//! gets them rounded to f32, the CPU path as they are.

use crate::base::angles::delta_phi;
use crate::base::half_angle::{Azimuth, MU_MIN, Pair, off_horizon};
use crate::base::quadrature::{Node, gauss_legendre, midpoint};
use crate::base::tolerance::{FACTOR_SHARE, decade};
use crate::integrate::chebyshev::{InterpolatedAxis, MAX_ENTRIES, Matrix};
use crate::integrate::listed_rule::{ListedRule, ListedSource};
use crate::integrate::product_rule::DiffuseRule;
use crate::integrate::sample_rule::{SampleRule, Sampler};
use crate::integrate::scale::{LobeScale, scales};
use crate::integrate::slope_rule::SlopeRule;
use crate::model::directions::{Fixed, Map};
use crate::model::lobe::Lobe;
use crate::model::parameters::Setting;
use crate::model::{Integral, Sampling, Slopes};
use crate::plan::TablePlan;
use crate::table::axis::Variable;
use crate::table::quantity::{Evaluation, FixedDirection};
use crate::table::rule::Rule;
use std::f64::consts::{FRAC_PI_2, PI};
use std::iter;

/// The points at which one lobe is evaluated, and the weights that make texels of its values.
pub(crate) struct RuleSet {
    /// The α of each row of values, or of inner integrals: those of the table's slowest axis, or of the sources that it is
    /// interpolated from.
    pub alphas: Vec<f64>,
    /// The factors that multiply the lobe in each row of values; empty where it has none.
    pub scales: Vec<LobeScale>,
    pub kind: RuleKind,
}

/// The evaluation of a lobe: at points, or as integrals.
pub(crate) enum RuleKind {
    /// A row of values for each (α, θi, φi, θe), with one value for each azimuth of ωe.
    Values(ValueGrid),
    /// An inner integral for each (α, k). Matrices, each of which transposes, turn them into texels: one row of weights
    /// where each texel has its own integrals, or else two matrices, which interpolate from those at the sources.
    Integrals { inner: InnerRule, outer: Vec<Matrix> },
}

/// The grid of a table of values: all combinations of its angles.
#[derive(Clone)]
pub(crate) struct ValueGrid {
    /// The terms of each θi with each θe, which turns fastest.
    pub pairs: Vec<Pair>,
    pub thetas_e: usize,
    /// For each φi, the azimuths of ωe; one list where a table has δφ.
    pub azimuths: Vec<Vec<Azimuth>>,
}

impl ValueGrid {
    /// The number of values of a row.
    pub fn columns(&self) -> usize {
        self.azimuths[0].len()
    }

    /// The number of rows of an α.
    pub fn rows(&self) -> usize {
        self.pairs.len() * self.azimuths.len()
    }

    /// The pair of a row of an α, and the index of its φi.
    pub fn pair_and_phi(&self, row: usize) -> (&Pair, usize) {
        let (outer, theta_e) = (row / self.thetas_e, row % self.thetas_e);
        let (theta_i, phi_i) = (outer / self.azimuths.len(), outer % self.azimuths.len());
        (&self.pairs[theta_i * self.thetas_e + theta_e], phi_i)
    }
}

/// The rule of the inner integrals, one for each (α, k), where k counts fixed directions and outer nodes.
pub(crate) enum InnerRule {
    /// Gauss–Legendre in slopes of ωm.
    Slopes(SlopeRule),
    /// Sampling, with an integral for each μ and chunk of the samples.
    Samples(SampleRule),
    /// A sum over δφ for each pair (θi, θe).
    Product { pairs: Vec<Pair>, azimuths: Vec<Azimuth> },
    /// A sum over directions that the host finds.
    Listed(ListedRule),
    /// A closed form for each μ.
    ClosedForm { directional: fn(f64, &Setting) -> [f64; 2], mus: Vec<f64> },
}

/// The number of nodes in √μ of ρ_hh, for tolerances 1e-1 … 1e-10: their error alone, worst over α ∈ [1e-4, 1] and the
/// maskings, is below a quarter of the tolerance. Measured for Beckmann, whose ρ turns more sharply at μ ≈ α than GGX's:
/// GGX's own 8, 10 and 20 leave it 0.5 of 1e-4, 0.5 of 1e-5 and twice 1e-7.
const MEAN_NODES: [usize; 10] = [3, 4, 6, 9, 14, 20, 26, 36, 52, 72];

impl RuleSet {
    /// The rule set of `lobe` in `table`.
    pub fn new(table: &TablePlan, lobe: &Lobe) -> Self {
        let alphas = table.alphas(lobe);
        match table.quantity().evaluation {
            Evaluation::Value => Self { alphas, scales: scales(table, lobe), kind: values(table) },
            Evaluation::Directional(_) => integrals(table, lobe, alphas, &directions(table), &[1.0]),
            Evaluation::Hemispherical => {
                let tolerance = table.rule_tolerance();
                let settings = lobe.settings(&alphas);
                let extra_nodes =
                    |s: &Setting| lobe.model().microfacet.map_or(0, |parts| (parts.mean_nodes)(s, tolerance));
                let extra_nodes = settings.iter().map(extra_nodes).max().unwrap_or(0);
                // A factor bends ρ where the lobe alone does not: 16 nodes leave 9e-6 of a lobe times Turquin's factor.
                let share = if lobe.factors().is_empty() { 1.0 } else { FACTOR_SHARE };
                let nodes = gauss_legendre(MEAN_NODES[decade(share * tolerance)] + extra_nodes);
                let [thetas, weights]: [Vec<_>; 2] = match lobe.model().integral {
                    // ρ_hh = ∫ ρ sin 2θ dθ: a kink at θe = θi leaves odd powers of sin θ in ρ.
                    Integral::Kinked(_) => {
                        let thetas: Vec<_> = nodes.iter().map(|node| FRAC_PI_2 * node.x).collect();
                        let weight = |n: &Node| FRAC_PI_2 * n.weight * (PI * n.x).sin();
                        [thetas, nodes.iter().map(weight).collect()]
                    }
                    Integral::Listed(Map { mean: Some(mean), .. }) => {
                        let nodes = mean(table.rule_tolerance());
                        [nodes.iter().map(|n| n.x.acos()).collect(), nodes.iter().map(|n| n.weight).collect()]
                    }
                    // ρ_hh = ∫ ρ 2μ dμ with μ = u²: ρ turns at μ ≈ α, where u has nodes to spare.
                    _ => [
                        nodes.iter().map(|node| (node.x * node.x).acos()).collect(),
                        nodes.iter().map(|n| 4.0 * n.x.powi(3) * n.weight).collect(),
                    ],
                };
                // The mean over a quarter of a turn, of which the other quarters are mirror images.
                let azimuths = match lobe.model().is_anisotropic() {
                    true => gauss_legendre(MEAN_NODES[decade(table.rule_tolerance())]),
                    false => vec![Node { x: 0.0, weight: 1.0 }],
                };
                let with_azimuths = |k: usize| azimuths.iter().map(move |azimuth| (k, azimuth));
                let directions = || (0..thetas.len()).flat_map(with_azimuths);
                let fixed: Vec<_> =
                    directions().map(|(k, azimuth)| [thetas[k], FRAC_PI_2 * azimuth.x]).collect();
                let weights: Vec<_> = directions().map(|(k, azimuth)| weights[k] * azimuth.weight).collect();
                integrals(table, lobe, alphas, &fixed, &weights)
            }
            // A plan refuses light's quantities, so that there is nothing to integrate.
            Evaluation::Light => integrals(table, lobe, alphas, &[], &[]),
        }
    }

    /// Whether texels are interpolated between integrals, rather than integrated one by one.
    pub fn is_interpolated(&self) -> bool {
        matches!(&self.kind, RuleKind::Integrals { outer, .. } if outer.len() > 1)
    }

    /// The largest undershoot below 0 that interpolation may leave in an integral, which is then raised to 0.
    pub fn below_zero(&self) -> f64 {
        match &self.kind {
            RuleKind::Integrals { inner: InnerRule::Slopes(rule), .. } if self.is_interpolated() => {
                rule.tolerance
            }
            _ => 0.0,
        }
    }

    /// The number of evaluations of the integrand, or of values, for the whole table. The products with the outer
    /// matrices, some dozens for each texel, do not count.
    #[cfg(feature = "lab")]
    pub fn evaluations(&self) -> u64 {
        let rows = self.alphas.len();
        let count = match &self.kind {
            RuleKind::Values(grid) => rows * grid.rows() * grid.columns(),
            RuleKind::Integrals { inner: InnerRule::Slopes(rule), .. } => rule.evaluations(rows),
            RuleKind::Integrals { inner, .. } => rows * inner.count() * inner.cost(),
        };
        count as u64
    }
}

/// Whether some lobe's integrals of a plan are sums over directions that the host lists, rather than over nodes that a
/// kernel maps.
pub(crate) fn has_listed_directions(plan: &TablePlan) -> bool {
    let is_listed = |lobe: &Lobe| {
        !lobe.factors().is_empty()
            || plan.rule() == Rule::Warped && matches!(lobe.model().integral, Integral::Listed(_))
    };
    plan.quantity().is_integral() && plan.lobes().iter().any(is_listed)
}

impl InnerRule {
    /// The number of inner integrals of each α.
    pub fn count(&self) -> usize {
        match self {
            Self::Slopes(rule) => rule.mus.len(),
            Self::Samples(rule) => rule.mus.len() * rule.chunks,
            Self::ClosedForm { mus, .. } => mus.len(),
            Self::Listed(rule) => rule.fixed.len(),
            Self::Product { pairs, .. } => pairs.len(),
        }
    }

    /// The number of evaluations of each inner integral.
    pub fn cost(&self) -> usize {
        match self {
            Self::Slopes(rule) => rule.largest_cost(),
            Self::Samples(rule) => rule.chunk,
            Self::Product { azimuths, .. } => azimuths.len(),
            Self::ClosedForm { .. } => 1,
            Self::Listed(rule) => rule.max_cost(),
        }
    }
}

/// The fixed directions (θ, φ) along the table's last axes.
fn directions(table: &TablePlan) -> Vec<[f64; 2]> {
    let zenith = table.quantity().variables.first().and_then(|&variable| table.axis(variable));
    let zenith = zenith.into_iter().flat_map(|axis| axis.values().iter().map(|&x| axis.variable().zenith(x)));
    let phis = table.axis(Variable::PhiI).map_or(&[0.0][..], |axis| axis.values());
    zenith.flat_map(|theta| phis.iter().map(move |&phi| [theta, phi])).collect()
}

/// The grid of a table of values.
fn values(table: &TablePlan) -> RuleKind {
    let samples = |variable| table.axis(variable).map_or(&[][..], |axis| axis.values());
    let (theta_i, theta_e) = (samples(Variable::ThetaI), samples(Variable::ThetaE));
    let pairs = theta_i.iter().flat_map(|&i| theta_e.iter().map(move |&e| Pair::new(i, e))).collect();
    let azimuths = match table.axis(Variable::PhiI) {
        None => vec![samples(Variable::DeltaPhi).iter().map(|&delta| Azimuth::new(delta)).collect()],
        Some(phi_i) => {
            let azimuth = |phi_i, phi_e| Azimuth::at(phi_i, delta_phi(phi_i, phi_e));
            let azimuths = |&i: &f64| samples(Variable::PhiE).iter().map(|&e| azimuth(i, e)).collect();
            phi_i.values().iter().map(azimuths).collect()
        }
    };
    RuleKind::Values(ValueGrid { pairs, thetas_e: theta_e.len(), azimuths })
}

/// The rule set of integrals over one direction for each fixed (θ, φ). `weights` are those of the fixed directions that a
/// texel sums (ρ_hh), or just 1 where each fixed direction is a texel.
fn integrals(
    table: &TablePlan,
    lobe: &Lobe,
    alphas: Vec<f64>,
    fixed: &[[f64; 2]],
    weights: &[f64],
) -> RuleSet {
    let thetas: &Vec<_> = &fixed.iter().map(|[theta, _]| *theta).collect();
    let summed =
        |inner: InnerRule, outer: Vec<f64>| RuleKind::Integrals { inner, outer: vec![Matrix::row(outer)] };
    let smooth = |grid: Vec<ThetaNode>, azimuths: Vec<Azimuth>| {
        let pairs = thetas.iter().flat_map(|&theta| grid.iter().map(move |node| node.pair(theta))).collect();
        let outer = weights.iter().flat_map(|w| grid.iter().map(move |node| w * node.weight)).collect();
        summed(InnerRule::Product { pairs, azimuths }, outer)
    };
    // Each fixed direction has its own panels in θe, so that each pair carries its weight.
    let kinked = |[theta, phi]: [usize; 2]| {
        let rule = gauss_legendre(theta);
        let pairs = thetas.iter().flat_map(|&theta_i| {
            let nodes = panels(&rule, [0.0, off_horizon(theta_i), FRAC_PI_2]);
            nodes.into_iter().map(move |node| Pair { weight: node.weight, ..node.pair(theta_i) })
        });
        let pairs = pairs.collect();
        let outer = weights.iter().flat_map(|&weight| iter::repeat_n(weight, 2 * theta)).collect();
        summed(InnerRule::Product { pairs, azimuths: kinked_azimuths(phi) }, outer)
    };
    let mus = || -> Vec<f64> { thetas.iter().map(|theta| theta.cos().max(MU_MIN)).collect() };
    let sampled = |sampler: Sampler, slopes: &'static Slopes, sampling: &'static Sampling, samples: usize| {
        let rule = SampleRule::new(sampler, slopes, sampling, mus(), samples);
        let chunks = iter::repeat_n(1.0 / samples as f64, rule.chunks);
        let outer = weights.iter().flat_map(|w| chunks.clone().map(move |c| w * c)).collect();
        summed(InnerRule::Samples(rule), outer)
    };
    let sampler = match table.rule() {
        Rule::Hammersley { samples } => Some((Sampler::Ndf, samples)),
        Rule::Vndf { samples } => Some((Sampler::Vndf, samples)),
        Rule::Random { samples } => Some((Sampler::Random, samples)),
        _ => None,
    };
    let new = |alphas, kind| RuleSet { alphas, scales: Vec::new(), kind };
    let listed_rule = |source: ListedSource| {
        let factored = !lobe.factors().is_empty();
        let fixed = mus()
            .into_iter()
            .zip(fixed)
            .map(|(mu, &[_, phi])| Fixed { mu, phi, factored, kinks: Vec::new() })
            .collect();
        ListedRule::new(source, fixed, lobe.settings(&alphas), table.rule_tolerance())
    };
    // The plan refuses other rules for lobes with factors.
    if !lobe.factors().is_empty() {
        let source = match lobe.model().integral {
            Integral::Slopes(slopes) => ListedSource::Map(slopes.map),
            Integral::Listed(map) => ListedSource::Map(map),
            Integral::Smooth(counts) => ListedSource::Product(DiffuseRule { counts, kinked: false }),
            Integral::Kinked(counts) => ListedSource::Product(DiffuseRule { counts, kinked: true }),
            Integral::Delta(directional) => ListedSource::Delta(directional),
            Integral::Unbounded(_) => ListedSource::Delta(|_, _| [f64::NAN; 2]),
        };
        let fixed_is_exitant = table.quantity().fixed_direction() == Some(FixedDirection::Exitant);
        let rule = listed_rule(source).times(scales(table, lobe), fixed_is_exitant);
        return new(alphas, summed(InnerRule::Listed(rule), weights.to_vec()));
    }
    if let (Some((sampler, samples)), Integral::Slopes(slopes)) = (sampler, lobe.model().integral)
        && let Some(sampling) = &slopes.sampling
    {
        return new(alphas, sampled(sampler, slopes, sampling, samples));
    }
    let kind = match (table.rule(), lobe.model().integral) {
        (Rule::Gauss { theta, phi }, _) => smooth(gauss_nodes(theta), gauss_azimuths(phi)),
        (Rule::Grid { theta, phi }, _) => smooth(grid_nodes(theta), grid_azimuths(phi)),
        // The plan refuses the sampling rules for lobes without samplers.
        (_, Integral::Smooth(nodes)) => {
            let [theta, phi] = nodes(table.rule_tolerance());
            smooth(gauss_nodes(theta), gauss_azimuths(2 * phi))
        }
        (_, Integral::Kinked(nodes)) => kinked(nodes(table.rule_tolerance())),
        (_, Integral::Slopes(slopes)) => {
            return slope_rule_set(table, lobe, slopes, [alphas, mus()], weights);
        }
        (_, Integral::Listed(map)) => {
            let rule = listed_rule(ListedSource::Map(map));
            summed(InnerRule::Listed(rule), weights.to_vec())
        }
        (_, Integral::Delta(directional)) => {
            let mus = thetas.iter().map(|theta| theta.cos()).collect();
            summed(InnerRule::ClosedForm { directional, mus }, weights.to_vec())
        }
        // The plan refuses such a lobe; if one came here, it would be NaN.
        (_, Integral::Unbounded(_)) => {
            summed(InnerRule::ClosedForm { directional: |_, _| [f64::NAN; 2], mus: mus() }, weights.to_vec())
        }
    };
    new(alphas, kind)
}

/// The least number of integrals that are interpolated. Fewer take some milliseconds at most, one by one, and
/// interpolation would take two more pipelines, which a first bake has to compile, for tens of them.
const MIN_INTERPOLATED: usize = 8192;

/// The rule set of integrals in slopes: at each texel, or at the sources of the axes where that takes fewer.
fn slope_rule_set(
    table: &TablePlan,
    lobe: &Lobe,
    slopes: &'static Slopes,
    [alphas, mus]: [Vec<f64>; 2],
    weights: &[f64],
) -> RuleSet {
    let tolerance = table.rule_tolerance();
    let rule_set = |alphas: Vec<f64>, mus: Vec<f64>, outer: Vec<Matrix>| {
        // Interpolation adds errors of neighbouring sources up, by about 3 along an axis (1 + 2/π ln n): with one
        // azimuth and node more, an integral has a third of its error.
        let spare = usize::from(outer.len() > 1);
        let inner = InnerRule::Slopes(SlopeRule::new(slopes, mus, &lobe.settings(&alphas), tolerance, spare));
        RuleSet { alphas, scales: Vec::new(), kind: RuleKind::Integrals { inner, outer } }
    };
    let direct = |alphas, mus| rule_set(alphas, mus, vec![Matrix::row(weights.to_vec())]);
    // An axis of φi repeats each μ, where the lobe is isotropic.
    let enough =
        table.axis(Variable::PhiI).is_none() && alphas.len().saturating_mul(mus.len()) >= MIN_INTERPOLATED;
    let Some(branches) = slopes.branches.filter(|_| enough) else { return direct(alphas, mus) };
    let rows = InterpolatedAxis::along_roughness(&alphas, &mus, branches, tolerance);
    if weights.len() > 1 {
        // The mean over directions has its own nodes for columns.
        let Some(rows) = rows else { return direct(alphas, mus) };
        return rule_set(rows.sources, mus, vec![Matrix::row(weights.to_vec()), rows.matrix]);
    }
    let columns = InterpolatedAxis::along_mu(&mus, &alphas, branches, tolerance);
    if rows.is_none() && columns.is_none() {
        return direct(alphas, mus);
    }
    let both = (
        rows.or_else(|| InterpolatedAxis::identity(&alphas)),
        columns.or_else(|| InterpolatedAxis::identity(&mus)),
    );
    let (Some(rows), Some(columns)) = both else { return direct(alphas, mus) };
    // Between them, every column at the sources of its rows.
    if rows.sources.len().saturating_mul(mus.len()) > MAX_ENTRIES {
        return direct(alphas, mus);
    }
    rule_set(rows.sources, columns.sources, vec![columns.matrix, rows.matrix])
}

/// A node in θe, with the edges of its cell if it has one.
struct ThetaNode {
    theta: f64,
    weight: f64,
    edges: Option<[f64; 2]>,
}

impl ThetaNode {
    /// The terms of (θi, θe), with `bin` set where the cell holds the mirror direction.
    fn pair(&self, theta_i: f64) -> Pair {
        // The last cell holds its upper edge, the horizon.
        let holds = |[low, high]: [f64; 2]| low <= theta_i && (theta_i < high || high == FRAC_PI_2);
        let bin = if self.edges.is_some_and(holds) { 1.0 / self.weight } else { 0.0 };
        Pair { bin, ..Pair::new(theta_i, self.theta) }
    }
}

/// The midpoints in θ, each times ∫ cos θ sin θ dθ = (sin²θ₁ − sin²θ₀)/2 over its cell: with Δφ that is
/// the cell's projected solid angle, exactly.
fn grid_nodes(n: usize) -> Vec<ThetaNode> {
    let edge = |k: usize| if k == n { FRAC_PI_2 } else { FRAC_PI_2 * k as f64 / n as f64 };
    midpoint(n)
        .iter()
        .enumerate()
        .map(|(k, node)| {
            let edges = [edge(k), edge(k + 1)];
            // sin²b − sin²a = sin(b + a) sin(b − a)
            let weight = 0.5 * (edges[1] + edges[0]).sin() * (edges[1] - edges[0]).sin();
            ThetaNode { theta: FRAC_PI_2 * node.x, weight, edges: Some(edges) }
        })
        .collect()
}

/// The Gauss–Legendre nodes in θ, with weights cos θ sin θ dθ.
fn gauss_nodes(n: usize) -> Vec<ThetaNode> {
    panels(&gauss_legendre(n), [0.0, FRAC_PI_2])
}

/// The Gauss–Legendre nodes in θ of each panel between two of `breaks`, with weights cos θ sin θ dθ.
fn panels<const N: usize>(rule: &[Node], breaks: [f64; N]) -> Vec<ThetaNode> {
    let panel = |ends: &[f64]| {
        let (start, width) = (ends[0], ends[1] - ends[0]);
        rule.iter().map(move |node| {
            let theta = start + width * node.x;
            ThetaNode { theta, weight: width * node.weight * theta.sin() * theta.cos(), edges: None }
        })
    };
    breaks.windows(2).flat_map(panel).collect()
}

/// The `n` midpoints in φ ∈ [0, 2π), of which the half in δφ ∈ [0, π] is kept with twice the weight, as the models that
/// take this rule are symmetric in δφ. The first cell holds δφ = 0, with its mirror image.
fn grid_azimuths(n: usize) -> Vec<Azimuth> {
    midpoint(n / 2)
        .iter()
        .enumerate()
        .map(|(k, node)| {
            let weight = 2.0 * PI * node.weight;
            Azimuth { weight, bin: if k == 0 { 1.0 / weight } else { 0.0 }, ..Azimuth::new(PI * node.x) }
        })
        .collect()
}

/// The `n`/2 Gauss–Legendre nodes in δφ ∈ [0, π], each with its mirror image. The trapezoid rule, which has no rival for
/// smooth periodic functions, is not taken: at grazing, ωi·ωm has a cone's tip in the mirror direction.
fn gauss_azimuths(n: usize) -> Vec<Azimuth> {
    let azimuth = |node: &Node| Azimuth { weight: 2.0 * PI * node.weight, ..Azimuth::new(PI * node.x) };
    gauss_legendre(n / 2).iter().map(azimuth).collect()
}

/// The `n` Gauss–Legendre nodes in δφ in each of [0, π/2] and [π/2, π], with their mirror images.
fn kinked_azimuths(n: usize) -> Vec<Azimuth> {
    let rule = gauss_legendre(n);
    let half = |start: f64| {
        let azimuth = move |node: &Node| Azimuth {
            weight: PI * node.weight,
            ..Azimuth::new(start + FRAC_PI_2 * node.x)
        };
        rule.iter().map(azimuth)
    };
    half(0.0).chain(half(FRAC_PI_2)).collect()
}
