//! Uploads the rule set of one lobe: f64 terms, nodes and weights, rounded to the kernels' precision, in the layout that
//! their WGSL declares.

use crate::backend::gpu::baker::{Baker, count};
use crate::base::error::{Error, Result};
use crate::base::half_angle::{Azimuth, Pair};
use crate::base::precision::{INTEGRAL_F32, Precision};
use crate::base::sequence::stride;
use crate::integrate::chebyshev::Matrix;
use crate::integrate::listed_rule::{ListedRule, ListedSum};
use crate::integrate::rule_set::{InnerRule, RuleKind, RuleSet, ValueGrid};
use crate::integrate::sample_rule::Sampler;
use crate::integrate::scale::LobeScale;
use crate::integrate::slope_rule::{SlopeSide, TILE_ALPHAS, TILE_COLUMNS};
use crate::model::directions::POINT;
use crate::model::lobe::Lobe;
use crate::model::{ALPHA_MIN_INTEGRAL, Model, SlopeCounts};
use crate::shader::{COARSE_NODES, Kernel, QUAD_FACTORS, VALUE_WINDOW};
use bytemuck::{Pod, Zeroable};
use std::ops::Range;

/// The kernels of one lobe: one that makes the channels, or one that makes inner integrals and then their outer sums.
pub(crate) struct Dispatches {
    pub inner: Stage,
    pub outer: Vec<Stage>,
    /// The number of α of the inner stage where a table is interpolated from sources: each tile takes all of them.
    pub sources: Option<usize>,
}

/// A kernel with its inputs.
pub(crate) struct Stage {
    pub kernel: Kernel,
    pub model: Option<&'static Model>,
    /// The number of channels that it makes; 0 where its results are inner integrals.
    pub channels: usize,
    pub precision: Precision,
    pub job: KernelJob,
    pub inputs: Vec<wgpu::Buffer>,
    /// The rows of a table of values, which are uploaded for each tile.
    pub rows: Option<ValueRows>,
    /// The directions that the host finds, which are uploaded for each dispatch.
    pub directions: Option<ListedRule>,
    /// The number of results for each unit of the table (see `ResultLayout`) or source of its α; 0 of outer sums.
    pub per_unit: usize,
    /// The number of units whose results one invocation makes.
    pub units: usize,
    /// The number of evaluations of an invocation.
    pub cost: usize,
}

/// The rows of a table of values: every α with every θi, φi and θe.
pub(crate) struct ValueRows {
    alphas: Vec<f64>,
    values: ValueGrid,
    /// The factors that multiply the lobe at each α; empty where it has none.
    scales: Vec<LobeScale>,
}

/// A row of values: `Given` of `shaders/kernel/values.wgsl`, in f32, the only precision of values on a device.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct ValueRow {
    hz2: f32,
    dt2: f32,
    ss: f32,
    sd: f32,
    mu_i: f32,
    mu_e: f32,
    bin: f32,
    /// α of the row. In a `Pair` of integrals, this slot holds the weight of θe.
    alpha: f32,
    st: f32,
    dt: f32,
    /// The index of the row in its tile: a tile has fewer rows than f32 counts.
    row: f32,
    /// The product of the lobe's factors.
    scale: f32,
}

impl ValueRows {
    /// The rows of some units in the kernel's layout, in a group for each φi.
    pub fn groups(&self, units: &Range<usize>) -> Vec<Vec<ValueRow>> {
        let mut groups = vec![Vec::new(); self.values.azimuths.len()];
        for unit in units.clone() {
            let (alpha, row) = (unit / self.values.rows(), unit % self.values.rows());
            let (pair, phi_i) = self.values.pair_and_phi(row);
            let scale = self.scales.get(alpha).map_or(1.0, |scale| scale.value(pair.mu_i, pair.mu_e));
            groups[phi_i].push(ValueRow {
                hz2: pair.hz2 as f32,
                dt2: pair.dt2 as f32,
                ss: pair.ss as f32,
                sd: pair.sd as f32,
                mu_i: pair.mu_i as f32,
                mu_e: pair.mu_e as f32,
                bin: pair.bin as f32,
                alpha: self.alphas[alpha] as f32,
                st: pair.st as f32,
                dt: pair.dt as f32,
                row: (unit - units.start) as f32,
                scale: scale as f32,
            });
        }
        groups
    }
}

/// The uniforms of a dispatch: `Job` of `shaders/kernel/job.wgsl`.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct KernelJob {
    pub weights: [[f32; 4]; 3],
    pub first: u32,
    pub end: u32,
    pub base: u32,
    pub columns: u32,
    pub azimuths: u32,
    pub nodes: u32,
    pub tiles: u32,
    /// α of kernels of points; of sums, the largest undershoot below 0 that is raised to 0; 0 of all others.
    pub alpha_or_bound: f32,
    pub parameters: [[f32; 4]; 4],
}

impl Dispatches {
    pub fn new(
        baker: &Baker,
        lobe: &Lobe,
        rules: &RuleSet,
        accumulate: bool,
        precision: Precision,
    ) -> Result<Self> {
        let upload = Upload { baker, precision };
        let channels = lobe.weights().len();
        let alphas: Vec<_> = rules.alphas.iter().map(|&alpha| lobe.model().on_device(alpha)).collect();
        let has_words = baker.device.features().contains(wgpu::Features::SHADER_INT64);
        match &rules.kind {
            RuleKind::Values(values) => Ok(Self {
                inner: Stage {
                    kernel: match accumulate {
                        true => Kernel::AddValues,
                        false if has_words && rules.scales.is_empty() => Kernel::WideValues,
                        false => Kernel::Values,
                    },
                    model: Some(lobe.model()),
                    channels,
                    precision: Precision::F32,
                    job: KernelJob::new(lobe, 1.0),
                    inputs: vec![upload.quads(values)],
                    rows: Some(ValueRows { alphas, values: values.clone(), scales: rules.scales.clone() }),
                    directions: None,
                    per_unit: values.columns().div_ceil(4),
                    units: 1,
                    cost: 4,
                },
                outer: Vec::new(),
                sources: None,
            }),
            RuleKind::Integrals { inner, outer } => {
                let stage = Stage::inner(&upload, inner, &alphas)?;
                let parameters = KernelJob::new(lobe, 1.0).parameters;
                let job = KernelJob { parameters, ..stage.job };
                let inner = Stage { model: Some(lobe.model()), per_unit: inner.count(), job, ..stage };
                // A texel that is one inner integral needs no sum.
                if let ([Matrix { rows: 1, values, .. }], false) = (&outer[..], accumulate)
                    && let &[weight] = &values[..]
                {
                    let job = KernelJob { weights: KernelJob::new(lobe, weight).weights, ..inner.job };
                    return Ok(Self {
                        inner: Stage { channels, job, ..inner },
                        outer: Vec::new(),
                        sources: None,
                    });
                }
                // The last matrix makes channels.
                let last = outer.len() - 1;
                // The rounding of f32 may be more than a fine rule's tolerance.
                let rounding = if precision == Precision::F32 { INTEGRAL_F32 } else { 0.0 };
                let below_zero = |k| if k == last { rules.below_zero().max(rounding) as f32 } else { 0.0 };
                let kernel = |k| if k == last && accumulate { Kernel::AddSum } else { Kernel::Sum };
                let stage = |(k, matrix)| {
                    Ok(Stage {
                        kernel: kernel(k),
                        channels: if k == last { channels } else { 0 },
                        ..Stage::outer(
                            &upload,
                            matrix,
                            KernelJob { alpha_or_bound: below_zero(k), ..KernelJob::new(lobe, 1.0) },
                        )?
                    })
                };
                let outer = outer.iter().enumerate().map(stage).collect::<Result<_>>()?;
                Ok(Self { inner, outer, sources: rules.is_interpolated().then_some(rules.alphas.len()) })
            }
        }
    }

    /// The units of the inner stage that some units of the table need.
    pub fn inner_units(&self, units: &Range<usize>) -> Range<usize> {
        self.sources.map_or(units.clone(), |sources| 0..sources)
    }

    /// The order in which the inner stage takes its rows of four α, if it has one. Rows before those of `units` are listed
    /// too, as the kernel indexes by row, but not taken.
    pub fn order(&self, units: &Range<usize>) -> Option<Vec<u32>> {
        matches!(self.inner.kernel, Kernel::Slopes | Kernel::FineSlopes).then(|| {
            let (first, end) = (units.start / TILE_ALPHAS, units.end.div_ceil(TILE_ALPHAS));
            let rows = end - first;
            (0..first).chain(mixed(rows).map(|row| first + row)).map(|row| row as u32).collect()
        })
    }

    /// The bytes of inner integrals for each unit; 0 where few sources serve all units.
    pub fn raw_bytes_per_unit(&self) -> usize {
        let direct = !self.outer.is_empty() && self.sources.is_none();
        if direct { self.inner.per_unit * 2 * self.inner.precision.bytes() } else { 0 }
    }

    /// The bytes of points that are uploaded for each unit.
    pub fn uploaded_bytes_per_unit(&self) -> usize {
        let points =
            if self.inner.kernel == Kernel::Listed { self.inner.per_unit * self.inner.cost } else { 0 };
        points * POINT * self.inner.precision.bytes()
    }
}

impl Stage {
    /// The kernel, counts and inputs of inner integrals.
    fn inner(upload: &Upload, inner: &InnerRule, alphas: &[f64]) -> Result<Self> {
        let (kernel, azimuths, nodes, inputs) = match inner {
            InnerRule::Slopes(rule) => {
                let (alphas, rows) = fours(alphas);
                let side = |side: SlopeSide| {
                    let SlopeCounts { azimuths, nodes } = side.counts;
                    [side.first_azimuth, azimuths, side.first_node, nodes].map(|n| n as u32)
                };
                let tiles: Vec<_> = rule.tiles.iter().map(|tile| tile.map(side)).collect();
                let nodes: Vec<_> = rule.nodes.iter().map(|node| [node.x, node.weight, 0.0, 0.0]).collect();
                if !rule.is_fine && nodes.len() > COARSE_NODES {
                    return Err(Error::Internal(format!("{} nodes of coarse rules", nodes.len())));
                }
                let (kernel, nodes) = match rule.is_fine {
                    false => (Kernel::Slopes, upload.uniforms(&nodes, COARSE_NODES)),
                    true => (Kernel::FineSlopes, upload.reals(nodes.as_flattened())),
                };
                let inputs = vec![
                    upload.reals(&alphas),
                    upload.reals(&rule.mus),
                    upload.input(&tiles),
                    upload.reals(rule.azimuths.as_flattened()),
                    nodes,
                ];
                (kernel, 0, rows, inputs)
            }
            InnerRule::Product { pairs, azimuths } => {
                let inputs = vec![upload.reals(alphas), upload.pairs(pairs), upload.azimuths(azimuths)];
                (Kernel::Product, azimuths.len(), 0, inputs)
            }
            InnerRule::Samples(rule) => {
                let (alphas, rows) = fours(alphas);
                let mut inputs = vec![upload.reals(&alphas), upload.reals(&rule.mus)];
                let kernel = match rule.sampler {
                    Sampler::Ndf => Kernel::Ndf,
                    Sampler::Vndf => Kernel::Vndf,
                    Sampler::Random => Kernel::Random,
                };
                if !rule.draws.is_empty() {
                    inputs.push(upload.reals(rule.draws.as_flattened()));
                }
                (kernel, rule.chunk, rows, inputs)
            }
            // The points are uploaded for each dispatch.
            InnerRule::Listed(_) => (Kernel::Listed, 0, 0, vec![upload.reals(alphas)]),
            InnerRule::ClosedForm { mus, .. } => {
                (Kernel::Analytic, 0, 0, vec![upload.reals(alphas), upload.reals(mus)])
            }
        };
        let job = KernelJob {
            columns: count(inner.count())?,
            azimuths: count(azimuths)?,
            nodes: count(nodes)?,
            tiles: count(inner.count().div_ceil(TILE_COLUMNS))?,
            ..KernelJob::zeroed()
        };
        let units =
            if matches!(inner, InnerRule::Slopes(_) | InnerRule::Samples(_)) { TILE_ALPHAS } else { 1 };
        Ok(Self {
            kernel,
            model: None,
            channels: 0,
            precision: upload.precision,
            job,
            inputs,
            rows: None,
            directions: if let InnerRule::Listed(rule) = inner { Some(rule.clone()) } else { None },
            per_unit: 1,
            units,
            cost: units * inner.cost(),
        })
    }
}

impl Stage {
    /// The kernel of an outer sum, its counts and inputs.
    fn outer(upload: &Upload, matrix: &Matrix, job: KernelJob) -> Result<Self> {
        Ok(Self {
            kernel: Kernel::Sum,
            model: None,
            channels: 0,
            precision: upload.precision,
            job: KernelJob { azimuths: count(matrix.rows)?, nodes: count(matrix.columns)?, ..job },
            inputs: vec![upload.fours_of_rows(matrix)],
            rows: None,
            directions: None,
            per_unit: 0,
            units: TILE_SUMS,
            // Of 4 × 4 sums: some 64 operations a column, as an evaluation.
            cost: matrix.columns,
        })
    }
}

/// The number of rows, and of columns, that one invocation of an outer sum takes.
pub(crate) const TILE_SUMS: usize = 4;

/// Pads α to whole fours, and returns the number before padding. An α so near the mirror that its integral is the
/// mirror's in f64 becomes 0.
fn fours(alphas: &[f64]) -> (Vec<f64>, usize) {
    let mut padded: Vec<_> =
        alphas.iter().map(|&alpha| if alpha < ALPHA_MIN_INTEGRAL { 0.0 } else { alpha }).collect();
    padded.resize(alphas.len().next_multiple_of(TILE_ALPHAS), 1.0);
    (padded, alphas.len())
}

/// The indices 0 to n − 1 in an order in which each run spreads over all of them: software drivers give each core a contiguous
/// share of a dispatch, and the cost of a row depends on α.
fn mixed(n: usize) -> impl Iterator<Item = usize> {
    let stride = stride(n);
    (0..n).map(move |k| k * stride % n)
}

impl KernelJob {
    /// The job with the channels' weights, times `scale`, and the lobe's parameters.
    pub fn new(lobe: &Lobe, scale: f64) -> Self {
        // Kernels in f64 get the digits that f32 drops.
        let rest: fn(f64) -> f32 = |x| (x - f64::from(x as f32)) as f32;
        let mut weights = [[0.0; 4]; 3];
        for (row, &weight) in weights.iter_mut().zip(lobe.weights()) {
            let [a, b] = weight.map(|x| scale * x);
            *row = [a as f32, b as f32, rest(a), rest(b)];
        }
        let mut parameters = lobe.parameters();
        (lobe.model().derive)(&mut parameters);
        let vector = |k: usize| [0, 1, 2, 3].map(|j| parameters[4 * k + j]);
        let (first, second) = (vector(0), vector(1));
        let [value, rest] = [|x: f64| x as f32, rest];
        let parameters = [first.map(value), second.map(value), first.map(rest), second.map(rest)];
        Self { weights, parameters, ..Self::zeroed() }
    }
}

/// Uploads numbers in the kernels' precision.
pub(crate) struct Upload<'a> {
    pub baker: &'a Baker,
    pub precision: Precision,
}

impl Upload<'_> {
    /// Uploads the points of some inner integrals, one after the other: the range of points of each, the closed forms of
    /// those without points, and all points.
    pub fn direction_sums(&self, sums: &[ListedSum]) -> [wgpu::Buffer; 3] {
        let (mut ranges, mut limits, mut points) = (Vec::new(), Vec::new(), Vec::new());
        for sum in sums {
            let first = points.len() as u32;
            limits.push(match sum {
                ListedSum::Limit(limit) => *limit,
                ListedSum::Samples(samples) => {
                    points.extend(samples.iter().map(|sample| sample.to_array()));
                    [0.0; 2]
                }
            });
            ranges.push([first, points.len() as u32]);
        }
        // A binding is never empty.
        if points.is_empty() {
            points.push([0.0; POINT]);
        }
        [self.input(&ranges), self.reals(limits.as_flattened()), self.reals(points.as_flattened())]
    }

    fn reals(&self, values: &[f64]) -> wgpu::Buffer {
        match self.precision {
            Precision::F32 => self.input(&values.iter().map(|&x| x as f32).collect::<Vec<_>>()),
            Precision::F64 => self.input(values),
        }
    }

    /// Uploads a uniform array of `length` vectors, padded with 0.
    fn uniforms(&self, vectors: &[[f64; 4]], length: usize) -> wgpu::Buffer {
        let mut vectors = vectors.to_vec();
        vectors.resize(length, [0.0; 4]);
        let usage = wgpu::BufferUsages::UNIFORM;
        match self.precision {
            Precision::F32 => {
                let vectors: Vec<_> = vectors.iter().map(|v| v.map(|x| x as f32)).collect();
                self.baker.init(bytemuck::cast_slice(&vectors), usage)
            }
            Precision::F64 => self.baker.init(bytemuck::cast_slice(&vectors), usage),
        }
    }

    /// Uploads a matrix four rows at a time, column after column.
    fn fours_of_rows(&self, matrix: &Matrix) -> wgpu::Buffer {
        let entry = |row: usize, column: usize| match row < matrix.rows {
            true => matrix.values[row * matrix.columns + column],
            false => 0.0,
        };
        let fours = (0..matrix.rows).step_by(TILE_SUMS);
        let columns =
            |row| (0..matrix.columns).flat_map(move |k| (row..row + TILE_SUMS).map(move |r| entry(r, k)));
        self.reals(&fours.flat_map(columns).collect::<Vec<_>>())
    }

    fn pairs(&self, pairs: &[Pair]) -> wgpu::Buffer {
        self.reals(pairs.iter().map(|pair| pair.to_plain()).collect::<Vec<_>>().as_flattened())
    }

    fn azimuths(&self, azimuths: &[Azimuth]) -> wgpu::Buffer {
        self.reals(azimuths.iter().map(|azimuth| azimuth.to_array()).collect::<Vec<_>>().as_flattened())
    }

    /// Uploads the azimuths of values in quads, those of each φi in whole windows.
    fn quads(&self, values: &ValueGrid) -> wgpu::Buffer {
        const TERMS: [fn(&Azimuth) -> f64; QUAD_FACTORS] = [
            |a| a.sin2,
            |a| a.cos2,
            |a| a.back,
            |a| a.frame.cp,
            |a| a.frame.cm,
            |a| a.frame.sp,
            |a| a.frame.sm,
        ];
        let mut quads: Vec<f32> = Vec::new();
        for window in values.azimuths.iter().flat_map(|azimuths| azimuths.chunks(4 * VALUE_WINDOW)) {
            for term in TERMS {
                let filled = quads.len() + 4 * VALUE_WINDOW;
                quads.extend(window.iter().map(|azimuth| term(azimuth) as f32));
                // The last azimuth fills the last quad; the kernel reads nothing beyond.
                let last = quads.last().copied().unwrap_or_default();
                quads.resize(filled, last);
            }
        }
        self.baker.init(bytemuck::cast_slice(&quads), wgpu::BufferUsages::UNIFORM)
    }

    fn input<T: Pod>(&self, items: &[T]) -> wgpu::Buffer {
        self.baker.init(bytemuck::cast_slice(items), wgpu::BufferUsages::STORAGE)
    }
}
