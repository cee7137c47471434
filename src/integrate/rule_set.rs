//! What one lobe of one table asks of an evaluator: axes turned into factors, nodes and weights, all
//! in f64. The device gets them rounded to f32, the CPU path as they are.

use crate::base::angles::delta_phi;
use crate::base::half_angle::{Azimuth, MU_MIN, Pair, off_horizon};
use crate::base::quadrature::{Node, gauss_legendre, midpoint};
use crate::base::tolerance::{FACTOR_SHARE, decade};
use crate::integrate::chebyshev::{LARGEST, Matrix, Spread};
use crate::integrate::direction_rule::{MappedWork, Source};
use crate::integrate::product_rule::Nodes;
use crate::integrate::sample_rule::{SampleWork, Sampler};
use crate::integrate::scale::{Scale, scales};
use crate::integrate::slope_rule::SlopeWork;
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

/// The work of one lobe.
pub(crate) struct Work {
    /// α of each row of values, or of inner integrals: along the table's slowest axis, or at its sources.
    pub alphas: Vec<f64>,
    /// What the lobe is multiplied with in each row of values; none: by nothing.
    pub scales: Vec<Scale>,
    pub kind: WorkKind,
}

pub(crate) enum WorkKind {
    /// A row of values for each (α, θi, φi, θe): one value an azimuth of ωe.
    Values(ValueWork),
    /// For each (α, k) a raw integral. They become texels by matrices one after the other, each of which
    /// transposes: by one row of weights, where each texel has integrals of its own, or else by two matrices,
    /// which spread those at the sources of a table over it.
    Integrals { inner: Inner, outer: Vec<Matrix> },
}

/// Values at all combinations of angles.
#[derive(Clone)]
pub(crate) struct ValueWork {
    /// Of each θi with each θe, which turns fastest.
    pub pairs: Vec<Pair>,
    pub thetas_e: usize,
    /// For each φi the azimuths of ωe; where a table has δφ, it is the only one.
    pub frames: Vec<Vec<Azimuth>>,
}

impl ValueWork {
    /// Values of a row.
    pub fn columns(&self) -> usize {
        self.frames[0].len()
    }

    /// Rows of an α.
    pub fn rows(&self) -> usize {
        self.pairs.len() * self.frames.len()
    }

    /// The pair of a row of an α, and which of the frames it has.
    pub fn place(&self, row: usize) -> (&Pair, usize) {
        let (outer, theta_e) = (row / self.thetas_e, row % self.thetas_e);
        let (theta_i, frame) = (outer / self.frames.len(), outer % self.frames.len());
        (&self.pairs[theta_i * self.thetas_e + theta_e], frame)
    }
}

/// The inner integrals: one result for each (α, k), k counting directions and outer nodes.
pub(crate) enum Inner {
    /// In slopes of ωm.
    Slopes(SlopeWork),
    /// By sampling, for each μ and chunk of the samples.
    Samples(SampleWork),
    /// Over δφ, for each pair of θ.
    Product { pairs: Vec<Pair>, azimuths: Vec<Azimuth> },
    /// Over directions that the host finds.
    Mapped(MappedWork),
    /// In closed form, for each μ.
    Analytic { directional: fn(f64, &Setting) -> [f64; 2], mus: Vec<f64> },
}

/// Nodes in √μ of ρ_hh for tolerances 1e-1 … 1e-10, measured for GGX: their error alone, worst over
/// α ∈ [1e-6, 1], is below a quarter of the tolerance.
const MEAN_NODES: [usize; 10] = [3, 4, 6, 8, 10, 16, 20, 32, 40, 48];

impl Work {
    /// The work of `lobe` in `table`.
    pub fn new(table: &TablePlan, lobe: &Lobe) -> Self {
        let alphas = table.alphas(lobe);
        match table.quantity().evaluation {
            Evaluation::Value => Self { alphas, scales: scales(table, lobe), kind: values(table) },
            Evaluation::Directional(_) => integrals(table, lobe, alphas, &directions(table), &[1.0]),
            Evaluation::Hemispherical => {
                let tolerance = table.rule_tolerance();
                let settings = lobe.settings(&alphas);
                let more =
                    |s: &Setting| lobe.model().microfacet.map_or(0, |made| (made.mean_nodes)(s, tolerance));
                let more = settings.iter().map(more).max().unwrap_or(0);
                // A factor turns ρ where the lobe alone does not: of a restored lobe 16 nodes leave 9e-6.
                let share = if lobe.factors().is_empty() { 1.0 } else { FACTOR_SHARE };
                let nodes = gauss_legendre(MEAN_NODES[decade(share * tolerance)] + more);
                let [thetas, weights]: [Vec<_>; 2] = match lobe.model().integral {
                    // ρ_hh = ∫ ρ sin 2θ dθ: a kink at θe = θi leaves odd powers of sin θ in ρ.
                    Integral::Kinked(_) => {
                        let thetas: Vec<_> = nodes.iter().map(|node| FRAC_PI_2 * node.x).collect();
                        let weight = |n: &Node| FRAC_PI_2 * n.weight * (PI * n.x).sin();
                        [thetas, nodes.iter().map(weight).collect()]
                    }
                    Integral::Mapped(Map { mean: Some(mean), .. }) => {
                        let nodes = mean(table.rule_tolerance());
                        [nodes.iter().map(|n| n.x.acos()).collect(), nodes.iter().map(|n| n.weight).collect()]
                    }
                    // ρ_hh = ∫ ρ 2μ dμ with μ = u²: ρ turns at μ ≈ α, where u has nodes to spare.
                    _ => [
                        nodes.iter().map(|node| (node.x * node.x).acos()).collect(),
                        nodes.iter().map(|n| 4.0 * n.x.powi(3) * n.weight).collect(),
                    ],
                };
                // The mean over a quarter of a turn, which the others mirror.
                let azimuths = match lobe.model().is_anisotropic() {
                    true => gauss_legendre(MEAN_NODES[decade(table.rule_tolerance())]),
                    false => vec![Node { x: 0.0, weight: 1.0 }],
                };
                let of = |k: usize| azimuths.iter().map(move |azimuth| (k, azimuth));
                let all = || (0..thetas.len()).flat_map(of);
                let fixed: Vec<_> = all().map(|(k, azimuth)| [thetas[k], FRAC_PI_2 * azimuth.x]).collect();
                let weights: Vec<_> = all().map(|(k, azimuth)| weights[k] * azimuth.weight).collect();
                integrals(table, lobe, alphas, &fixed, &weights)
            }
            // A plan refuses light's quantities, so that there is nothing to integrate.
            Evaluation::Light => integrals(table, lobe, alphas, &[], &[]),
        }
    }

    /// Whether a texel is interpolated between integrals, rather than a sum of its own.
    pub fn is_spread(&self) -> bool {
        matches!(&self.kind, WorkKind::Integrals { outer, .. } if outer.len() > 1)
    }

    /// By how much interpolation may leave an integral below 0, where there is none: that is 0 then.
    pub fn below_zero(&self) -> f64 {
        match &self.kind {
            WorkKind::Integrals { inner: Inner::Slopes(work), .. } if self.is_spread() => work.tolerance,
            _ => 0.0,
        }
    }

    /// Evaluations of the integrand, or of values, for the whole table. What a texel takes beside them, some
    /// dozens of products of the outer matrices, does not count.
    #[cfg(feature = "lab")]
    pub fn evaluations(&self) -> u64 {
        let rows = self.alphas.len();
        let count = match &self.kind {
            WorkKind::Values(work) => rows * work.rows() * work.columns(),
            WorkKind::Integrals { inner: Inner::Slopes(work), .. } => work.evaluations(rows),
            WorkKind::Integrals { inner, .. } => rows * inner.count() * inner.cost(),
        };
        count as u64
    }
}

impl Inner {
    /// Results for each α.
    pub fn count(&self) -> usize {
        match self {
            Self::Slopes(work) => work.mus.len(),
            Self::Samples(work) => work.mus.len() * work.chunks,
            Self::Analytic { mus, .. } => mus.len(),
            Self::Mapped(work) => work.fixed.len(),
            Self::Product { pairs, .. } => pairs.len(),
        }
    }

    /// Evaluations for each result.
    pub fn cost(&self) -> usize {
        match self {
            Self::Slopes(work) => work.largest_cost(),
            Self::Samples(work) => work.chunk,
            Self::Product { azimuths, .. } => azimuths.len(),
            Self::Analytic { .. } => 1,
            Self::Mapped(work) => work.most(),
        }
    }
}

/// (θ, φ) of the fixed direction along the table's last axes.
fn directions(table: &TablePlan) -> Vec<[f64; 2]> {
    let zenith = table.quantity().variables.first().and_then(|&variable| table.axis(variable));
    let zenith = zenith.into_iter().flat_map(|axis| axis.values().iter().map(|&x| axis.variable().zenith(x)));
    let phis = table.axis(Variable::PhiI).map_or(&[0.0][..], |axis| axis.values());
    zenith.flat_map(|theta| phis.iter().map(move |&phi| [theta, phi])).collect()
}

fn values(table: &TablePlan) -> WorkKind {
    let of = |variable| table.axis(variable).map_or(&[][..], |axis| axis.values());
    let (theta_i, theta_e) = (of(Variable::ThetaI), of(Variable::ThetaE));
    let pairs = theta_i.iter().flat_map(|&i| theta_e.iter().map(move |&e| Pair::new(i, e))).collect();
    let frames = match table.axis(Variable::PhiI) {
        None => vec![of(Variable::DeltaPhi).iter().map(|&delta| Azimuth::new(delta)).collect()],
        Some(phi_i) => {
            let azimuth = |phi_i, phi_e| Azimuth::at(phi_i, delta_phi(phi_i, phi_e));
            let frame = |&i: &f64| of(Variable::PhiE).iter().map(|&e| azimuth(i, e)).collect();
            phi_i.values().iter().map(frame).collect()
        }
    };
    WorkKind::Values(ValueWork { pairs, thetas_e: theta_e.len(), frames })
}

/// Integrals over one direction for each fixed (θ, φ), times `weights`, which run over the fixed ones
/// where a texel sums several (ρ_hh), and are just 1 where each is a texel.
fn integrals(table: &TablePlan, lobe: &Lobe, alphas: Vec<f64>, fixed: &[[f64; 2]], weights: &[f64]) -> Work {
    let thetas: &Vec<_> = &fixed.iter().map(|[theta, _]| *theta).collect();
    let of = |inner: Inner, outer: Vec<f64>| WorkKind::Integrals { inner, outer: vec![Matrix::row(outer)] };
    let smooth = |grid: Vec<Cell>, azimuths: Vec<Azimuth>| {
        let pairs = thetas.iter().flat_map(|&theta| grid.iter().map(move |cell| cell.pair(theta))).collect();
        let outer = weights.iter().flat_map(|w| grid.iter().map(move |cell| w * cell.weight)).collect();
        of(Inner::Product { pairs, azimuths }, outer)
    };
    // Each direction has cells of its own, and each cell its weight with it.
    let kinked = |[theta, phi]: [usize; 2]| {
        let rule = gauss_legendre(theta);
        let pairs = thetas.iter().flat_map(|&theta_i| {
            let cells = panels(&rule, [0.0, off_horizon(theta_i), FRAC_PI_2]);
            cells.into_iter().map(move |cell| Pair { weight: cell.weight, ..cell.pair(theta_i) })
        });
        let pairs = pairs.collect();
        let outer = weights.iter().flat_map(|&weight| iter::repeat_n(weight, 2 * theta)).collect();
        of(Inner::Product { pairs, azimuths: kinked_azimuths(phi) }, outer)
    };
    let mus = || -> Vec<f64> { thetas.iter().map(|theta| theta.cos().max(MU_MIN)).collect() };
    let sampled = |sampler: Sampler, slopes: &'static Slopes, by: &'static Sampling, samples: usize| {
        let work = SampleWork::new(sampler, slopes, by, mus(), samples);
        let chunks = iter::repeat_n(1.0 / samples as f64, work.chunks);
        let outer = weights.iter().flat_map(|w| chunks.clone().map(move |c| w * c)).collect();
        of(Inner::Samples(work), outer)
    };
    let sampler = match table.rule() {
        Rule::Hammersley { samples } => Some((Sampler::Ndf, samples)),
        Rule::Vndf { samples } => Some((Sampler::Vndf, samples)),
        Rule::Random { samples } => Some((Sampler::Random, samples)),
        _ => None,
    };
    let new = |alphas, kind| Work { alphas, scales: Vec::new(), kind };
    let mapped = |source: Source| {
        let factored = !lobe.factors().is_empty();
        let fixed = mus()
            .into_iter()
            .zip(fixed)
            .map(|(mu, &[_, phi])| Fixed { mu, phi, factored, kinks: Vec::new() })
            .collect();
        MappedWork::new(source, fixed, lobe.settings(&alphas), table.rule_tolerance())
    };
    // The plan refuses other rules for lobes with factors.
    if !lobe.factors().is_empty() {
        let source = match lobe.model().integral {
            Integral::Slopes(slopes) => Source::Map(slopes.map),
            Integral::Mapped(map) => Source::Map(map),
            Integral::Smooth(counts) => Source::Product(Nodes { counts, kinked: false }),
            Integral::Kinked(counts) => Source::Product(Nodes { counts, kinked: true }),
            Integral::Delta(directional) => Source::Delta(directional),
            Integral::Unbounded(_) => Source::Delta(|_, _| [f64::NAN; 2]),
        };
        let fixed_is_exitant = table.quantity().fixed_direction() == Some(FixedDirection::Exitant);
        let work = mapped(source).times(scales(table, lobe), fixed_is_exitant);
        return new(alphas, of(Inner::Mapped(work), weights.to_vec()));
    }
    if let (Some((sampler, samples)), Integral::Slopes(slopes)) = (sampler, lobe.model().integral)
        && let Some(by) = &slopes.sampling
    {
        return new(alphas, sampled(sampler, slopes, by, samples));
    }
    let kind = match (table.rule(), lobe.model().integral) {
        (Rule::Gauss { theta, phi }, _) => smooth(gauss_cells(theta), gauss_azimuths(phi)),
        (Rule::Grid { theta, phi }, _) => smooth(grid_cells(theta), grid_azimuths(phi)),
        // The plan refuses the sampling rules for lobes without samplers.
        (_, Integral::Smooth(nodes)) => {
            let [theta, phi] = nodes(table.rule_tolerance());
            smooth(gauss_cells(theta), gauss_azimuths(2 * phi))
        }
        (_, Integral::Kinked(nodes)) => kinked(nodes(table.rule_tolerance())),
        (_, Integral::Slopes(slopes)) => {
            return slopes_work(table, lobe, slopes, [alphas, mus()], weights);
        }
        (_, Integral::Mapped(map)) => of(Inner::Mapped(mapped(Source::Map(map))), weights.to_vec()),
        (_, Integral::Delta(directional)) => {
            let mus = thetas.iter().map(|theta| theta.cos()).collect();
            of(Inner::Analytic { directional, mus }, weights.to_vec())
        }
        // The plan refuses it; were it to come here, no number would.
        (_, Integral::Unbounded(_)) => {
            of(Inner::Analytic { directional: |_, _| [f64::NAN; 2], mus: mus() }, weights.to_vec())
        }
    };
    new(alphas, kind)
}

/// Fewer integrals than these are done one by one: they take some milliseconds at most, and to spread others over them
/// would take two more pipelines, which a first bake has to compile, for tens of them.
const FEWEST: usize = 8192;

/// Integrals in slopes: at each texel, or at the sources of the table where that takes fewer.
fn slopes_work(
    table: &TablePlan,
    lobe: &Lobe,
    slopes: &'static Slopes,
    [alphas, mus]: [Vec<f64>; 2],
    weights: &[f64],
) -> Work {
    let tolerance = table.rule_tolerance();
    let work = |alphas: Vec<f64>, mus: Vec<f64>, outer: Vec<Matrix>| {
        // Interpolation adds errors of neighbouring sources up, by about 3 along an axis (1 + 2/π ln n): with one
        // azimuth and node more, an integral has a third of its error.
        let spare = usize::from(outer.len() > 1);
        let inner = Inner::Slopes(SlopeWork::new(slopes, mus, &lobe.settings(&alphas), tolerance, spare));
        Work { alphas, scales: Vec::new(), kind: WorkKind::Integrals { inner, outer } }
    };
    let direct = |alphas, mus| work(alphas, mus, vec![Matrix::row(weights.to_vec())]);
    // Azimuths repeat the μ of lobes that do not tell them.
    let enough = table.axis(Variable::PhiI).is_none() && alphas.len().saturating_mul(mus.len()) >= FEWEST;
    let Some(branches) = slopes.branches.filter(|_| enough) else { return direct(alphas, mus) };
    let rows = Spread::along_roughness(&alphas, &mus, branches, tolerance);
    if weights.len() > 1 {
        // The mean over directions has nodes of its own for columns.
        let Some(rows) = rows else { return direct(alphas, mus) };
        return work(rows.sources, mus, vec![Matrix::row(weights.to_vec()), rows.matrix]);
    }
    let columns = Spread::along_mu(&mus, &alphas, branches, tolerance);
    if rows.is_none() && columns.is_none() {
        return direct(alphas, mus);
    }
    let both = (rows.or_else(|| Spread::identity(&alphas)), columns.or_else(|| Spread::identity(&mus)));
    let (Some(rows), Some(columns)) = both else { return direct(alphas, mus) };
    // Between them, every column at the sources of its rows.
    if rows.sources.len().saturating_mul(mus.len()) > LARGEST {
        return direct(alphas, mus);
    }
    work(rows.sources, columns.sources, vec![columns.matrix, rows.matrix])
}

/// A node in θe, and where its cell lies if it has one.
struct Cell {
    theta: f64,
    weight: f64,
    edges: Option<[f64; 2]>,
}

impl Cell {
    fn pair(&self, theta_i: f64) -> Pair {
        // The last cell holds its upper edge, the horizon.
        let holds = |[low, high]: [f64; 2]| low <= theta_i && (theta_i < high || high == FRAC_PI_2);
        let bin = if self.edges.is_some_and(holds) { 1.0 / self.weight } else { 0.0 };
        Pair { bin, ..Pair::new(theta_i, self.theta) }
    }
}

/// Midpoints in θ, each times ∫ cos θ sin θ dθ = (sin²θ₁ − sin²θ₀)/2 over its cell: with Δφ that is
/// the cell's projected solid angle, exactly.
fn grid_cells(n: usize) -> Vec<Cell> {
    let edge = |k: usize| if k == n { FRAC_PI_2 } else { FRAC_PI_2 * k as f64 / n as f64 };
    midpoint(n)
        .iter()
        .enumerate()
        .map(|(k, node)| {
            let edges = [edge(k), edge(k + 1)];
            // sin²b − sin²a = sin(b + a) sin(b − a)
            let weight = 0.5 * (edges[1] + edges[0]).sin() * (edges[1] - edges[0]).sin();
            Cell { theta: FRAC_PI_2 * node.x, weight, edges: Some(edges) }
        })
        .collect()
}

/// Gauss–Legendre in θ, with cos θ sin θ.
fn gauss_cells(n: usize) -> Vec<Cell> {
    panels(&gauss_legendre(n), [0.0, FRAC_PI_2])
}

/// The same in each panel between two of `breaks`.
fn panels<const N: usize>(rule: &[Node], breaks: [f64; N]) -> Vec<Cell> {
    let panel = |ends: &[f64]| {
        let (start, width) = (ends[0], ends[1] - ends[0]);
        rule.iter().map(move |node| {
            let theta = start + width * node.x;
            Cell { theta, weight: width * node.weight * theta.sin() * theta.cos(), edges: None }
        })
    };
    breaks.windows(2).flat_map(panel).collect()
}

/// `n` midpoints in φ ∈ [0, 2π), of which the half in δφ ∈ [0, π] is kept with twice the weight: the
/// models so far do not tell left from right. The first cell holds δφ = 0, with its mirror image.
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

/// Gauss–Legendre in δφ ∈ [0, π], `n`/2 nodes, each with its mirror image. Not the trapezoid, which has no
/// rival for smooth periodic functions: at grazing, ωi·ωm has a cone's tip in the mirror direction.
fn gauss_azimuths(n: usize) -> Vec<Azimuth> {
    let azimuth = |node: &Node| Azimuth { weight: 2.0 * PI * node.weight, ..Azimuth::new(PI * node.x) };
    gauss_legendre(n / 2).iter().map(azimuth).collect()
}

/// Gauss–Legendre, `n` nodes in each of [0, π/2] and [π/2, π], with their mirror images.
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
