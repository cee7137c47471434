//! The work of one lobe, uploaded: f64 factors rounded to the kernels' precision, as they lay them out.

use crate::backend::gpu::baker::{Baker, count};
use crate::base::error::{Error, Result};
use crate::base::half_angle::{Azimuth, Pair};
use crate::base::precision::{INTEGRAL_F32, Precision};
use crate::base::sequence::stride;
use crate::base::tolerance::is_fine;
use crate::integrate::chebyshev::Matrix;
use crate::integrate::direction_rule::{MappedWork, Texel};
use crate::integrate::rule_set::{Inner, ValueWork, Work, WorkKind};
use crate::integrate::sample_rule::Sampler;
use crate::integrate::scale::Scale;
use crate::integrate::slope_rule::{Side, TILE_ALPHAS, TILE_COLUMNS};
use crate::model::directions::POINT;
use crate::model::lobe::Lobe;
use crate::model::{ALPHA_MIN_INTEGRAL, Model, SlopeCounts};
use crate::shader::{COARSE_NODES, Kernel, QUAD_FACTORS, VALUE_WINDOW};
use bytemuck::{Pod, Zeroable};
use std::ops::Range;

/// The stages of one lobe: one that makes the channels, or raw integrals and then their outer sums.
pub(crate) struct Dispatches {
    pub inner: Stage,
    pub outer: Vec<Stage>,
    /// How many α the inner stage takes, if they are the table's sources: all of them for each tile.
    pub sources: Option<usize>,
}

/// A kernel and what it reads.
pub(crate) struct Stage {
    pub kernel: Kernel,
    pub model: Option<&'static Model>,
    /// Channels that it makes; 0 where its results are raw.
    pub channels: usize,
    pub precision: Precision,
    pub job: Job,
    pub inputs: Vec<wgpu::Buffer>,
    /// The rows of a table of values, which are uploaded for each tile.
    pub rows: Option<Rows>,
    /// The directions of integrals that the host finds, which are uploaded for each dispatch.
    pub mapped: Option<MappedWork>,
    /// Results for each unit of the table (see `Layout`) or source of its α; not of outer sums.
    pub per_unit: usize,
    /// Units whose results one invocation makes.
    pub units: usize,
    /// Evaluations of an invocation.
    pub cost: usize,
}

/// The rows of a table of values: every α with every θi, φi and θe.
pub(crate) struct Rows {
    alphas: Vec<f64>,
    values: ValueWork,
    /// What the lobe is multiplied with at each α.
    scales: Vec<Scale>,
}

/// `Given` of `shaders/kernel/values.wgsl`, in f32: the only precision of values on a device.
type Row = [f32; 12];
const ALPHA: usize = 7;
const PLACE: usize = 10;
const SCALE: usize = 11;

impl Rows {
    /// Some of them as the kernel lays them out, those of a φi together: as many groups as there are φi.
    pub fn of(&self, units: &Range<usize>) -> Vec<Vec<Row>> {
        let mut groups = vec![Vec::new(); self.values.frames.len()];
        for unit in units.clone() {
            let (alpha, row) = (unit / self.values.rows(), unit % self.values.rows());
            let (pair, frame) = self.values.place(row);
            let Pair { mu_i, mu_e, .. } = *pair;
            let mut row = Row::default();
            row.iter_mut().zip(pair.to_array()).for_each(|(out, x)| *out = x as f32);
            // A tile has fewer rows than a float counts.
            row[PLACE] = (unit - units.start) as f32;
            row[SCALE] = self.scales.get(alpha).map_or(1.0, |scale| scale.at(mu_i, mu_e)) as f32;
            row[ALPHA] = self.alphas[alpha] as f32;
            groups[frame].push(row);
        }
        groups
    }
}

/// `Job` of `shaders/kernel/job.wgsl`.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Job {
    pub weights: [[f32; 4]; 3],
    pub first: u32,
    pub end: u32,
    pub base: u32,
    pub columns: u32,
    pub azimuths: u32,
    pub nodes: u32,
    pub tiles: u32,
    pub alpha: f32,
    pub parameters: [[f32; 4]; 4],
}

impl Dispatches {
    pub fn new(
        baker: &Baker,
        lobe: &Lobe,
        work: &Work,
        accumulate: bool,
        precision: Precision,
    ) -> Result<Self> {
        let upload = Upload { baker, precision };
        let channels = lobe.weights().len();
        let alphas: Vec<_> = work.alphas.iter().map(|&alpha| lobe.model().on_device(alpha)).collect();
        let has_words = baker.device.features().contains(wgpu::Features::SHADER_INT64);
        match &work.kind {
            WorkKind::Values(values) => Ok(Self {
                inner: Stage {
                    kernel: match accumulate {
                        true => Kernel::AddValues,
                        false if has_words && work.scales.is_empty() => Kernel::WideValues,
                        false => Kernel::Values,
                    },
                    model: Some(lobe.model()),
                    channels,
                    precision: Precision::F32,
                    job: Job::new(lobe, 1.0),
                    inputs: vec![upload.quads(values)],
                    rows: Some(Rows { alphas, values: values.clone(), scales: work.scales.clone() }),
                    mapped: None,
                    per_unit: values.columns().div_ceil(4),
                    units: 1,
                    cost: 4,
                },
                outer: Vec::new(),
                sources: None,
            }),
            WorkKind::Integrals { inner, outer } => {
                let stage = Stage::inner(&upload, inner, &alphas)?;
                let parameters = Job::new(lobe, 1.0).parameters;
                let job = Job { parameters, ..stage.job };
                let inner = Stage { model: Some(lobe.model()), per_unit: inner.count(), job, ..stage };
                // A texel that is one inner integral needs no sum.
                if let ([Matrix { rows: 1, values, .. }], false) = (&outer[..], accumulate)
                    && let &[weight] = &values[..]
                {
                    let job = Job { weights: Job::new(lobe, weight).weights, ..inner.job };
                    return Ok(Self {
                        inner: Stage { channels, job, ..inner },
                        outer: Vec::new(),
                        sources: None,
                    });
                }
                // The last of them makes channels.
                let last = outer.len() - 1;
                // What f32 rounds may be more than a fine rule's tolerance.
                let rounding = if precision == Precision::F32 { INTEGRAL_F32 } else { 0.0 };
                let below_zero = |k| if k == last { work.below_zero().max(rounding) as f32 } else { 0.0 };
                let kernel = |k| if k == last && accumulate { Kernel::AddSum } else { Kernel::Sum };
                let stage = |(k, matrix)| {
                    Ok(Stage {
                        kernel: kernel(k),
                        channels: if k == last { channels } else { 0 },
                        ..Stage::outer(&upload, matrix, Job { alpha: below_zero(k), ..Job::new(lobe, 1.0) })?
                    })
                };
                let outer = outer.iter().enumerate().map(stage).collect::<Result<_>>()?;
                Ok(Self { inner, outer, sources: work.is_spread().then_some(work.alphas.len()) })
            }
        }
    }

    /// What the inner stage does for some units of the table.
    pub fn inner_units(&self, units: &Range<usize>) -> Range<usize> {
        self.sources.map_or(units.clone(), |sources| 0..sources)
    }

    /// The order in which the inner stage takes its rows of four α, if it has one: of its units', and of those
    /// before them, which it does not take.
    pub fn order(&self, units: &Range<usize>) -> Option<Vec<u32>> {
        matches!(self.inner.kernel, Kernel::Slopes | Kernel::FineSlopes).then(|| {
            let (first, end) = (units.start / TILE_ALPHAS, units.end.div_ceil(TILE_ALPHAS));
            let rows = end - first;
            (0..first).chain(mixed(rows).map(|row| first + row)).map(|row| row as u32).collect()
        })
    }

    /// Bytes between the stages for each unit: none where few sources serve all units.
    pub fn raw_bytes_per_unit(&self) -> usize {
        let direct = !self.outer.is_empty() && self.sources.is_none();
        if direct { self.inner.per_unit * 2 * self.inner.precision.bytes() } else { 0 }
    }

    /// Bytes of what is uploaded for each unit.
    pub fn uploaded_bytes_per_unit(&self) -> usize {
        let points =
            if self.inner.kernel == Kernel::Mapped { self.inner.per_unit * self.inner.cost } else { 0 };
        points * POINT * self.inner.precision.bytes()
    }
}

impl Stage {
    /// The kernel, counts and inputs of inner integrals.
    fn inner(upload: &Upload, inner: &Inner, alphas: &[f64]) -> Result<Self> {
        let (kernel, azimuths, nodes, inputs) = match inner {
            Inner::Slopes(work) => {
                let (alphas, rows) = fours(alphas);
                let side = |side: Side| {
                    let SlopeCounts { azimuths, nodes } = side.counts;
                    [side.first_azimuth, azimuths, side.first_node, nodes].map(|n| n as u32)
                };
                let tiles: Vec<_> = work.tiles.iter().map(|tile| tile.map(side)).collect();
                let nodes: Vec<_> = work.nodes.iter().map(|node| [node.x, node.weight, 0.0, 0.0]).collect();
                if !is_fine(work.tolerance) && nodes.len() > COARSE_NODES {
                    return Err(Error::Internal(format!("{} nodes of coarse rules", nodes.len())));
                }
                let (kernel, nodes) = match is_fine(work.tolerance) {
                    false => (Kernel::Slopes, upload.uniforms(&nodes, COARSE_NODES)),
                    true => (Kernel::FineSlopes, upload.reals(nodes.as_flattened())),
                };
                let inputs = vec![
                    upload.reals(&alphas),
                    upload.reals(&work.mus),
                    upload.input(&tiles),
                    upload.reals(work.azimuths.as_flattened()),
                    nodes,
                ];
                (kernel, 0, rows, inputs)
            }
            Inner::Product { pairs, azimuths } => {
                let inputs = vec![upload.reals(alphas), upload.pairs(pairs), upload.azimuths(azimuths)];
                (Kernel::Product, azimuths.len(), 0, inputs)
            }
            Inner::Samples(work) => {
                let (alphas, rows) = fours(alphas);
                let mut inputs = vec![upload.reals(&alphas), upload.reals(&work.mus)];
                let kernel = match work.sampler {
                    Sampler::Ndf => Kernel::Ndf,
                    Sampler::Vndf => Kernel::Vndf,
                    Sampler::Random => Kernel::Random,
                };
                if !work.draws.is_empty() {
                    inputs.push(upload.reals(work.draws.as_flattened()));
                }
                (kernel, work.chunk, rows, inputs)
            }
            // Its points are uploaded for each dispatch.
            Inner::Mapped(_) => (Kernel::Mapped, 0, 0, vec![upload.reals(alphas)]),
            Inner::Analytic { mus, .. } => {
                (Kernel::Analytic, 0, 0, vec![upload.reals(alphas), upload.reals(mus)])
            }
        };
        let job = Job {
            columns: count(inner.count())?,
            azimuths: count(azimuths)?,
            nodes: count(nodes)?,
            tiles: count(inner.count().div_ceil(TILE_COLUMNS))?,
            ..Job::zeroed()
        };
        let units = if matches!(inner, Inner::Slopes(_) | Inner::Samples(_)) { TILE_ALPHAS } else { 1 };
        Ok(Self {
            kernel,
            model: None,
            channels: 0,
            precision: upload.precision,
            job,
            inputs,
            rows: None,
            mapped: if let Inner::Mapped(work) = inner { Some(work.clone()) } else { None },
            per_unit: 1,
            units,
            cost: units * inner.cost(),
        })
    }
}

impl Stage {
    /// An outer sum.
    fn outer(upload: &Upload, matrix: &Matrix, job: Job) -> Result<Self> {
        Ok(Self {
            kernel: Kernel::Sum,
            model: None,
            channels: 0,
            precision: upload.precision,
            job: Job { azimuths: count(matrix.rows)?, nodes: count(matrix.columns)?, ..job },
            inputs: vec![upload.fours_of_rows(matrix)],
            rows: None,
            mapped: None,
            per_unit: 0,
            units: TILE_SUMS,
            // Of 4 × 4 sums: some 64 operations a column, as an evaluation.
            cost: matrix.columns,
        })
    }
}

/// Rows, and columns, that one invocation of an outer sum takes.
pub(crate) const TILE_SUMS: usize = 4;

/// α padded to whole fours, and how many there were. What is so near the mirror that it is the mirror's
/// in f64 is 0 to the kernels.
fn fours(alphas: &[f64]) -> (Vec<f64>, usize) {
    let mut padded: Vec<_> =
        alphas.iter().map(|&alpha| if alpha < ALPHA_MIN_INTEGRAL { 0.0 } else { alpha }).collect();
    padded.resize(alphas.len().next_multiple_of(TILE_ALPHAS), 1.0);
    (padded, alphas.len())
}

/// 0 to n − 1 such that each run of them is spread over all: software drivers give each core a contiguous
/// share of a dispatch, and the cost of a row depends on α.
fn mixed(n: usize) -> impl Iterator<Item = usize> {
    let stride = stride(n);
    (0..n).map(move |k| k * stride % n)
}

impl Job {
    /// The channels' weights, times `scale`, and the lobe's parameters.
    pub fn new(lobe: &Lobe, scale: f64) -> Self {
        // What f32 drops is kept for kernels in f64.
        let rest: fn(f64) -> f32 = |x| (x - f64::from(x as f32)) as f32;
        let mut weights = [[0.0; 4]; 3];
        for (row, &weight) in weights.iter_mut().zip(lobe.weights()) {
            let [a, b] = weight.map(|x| scale * x);
            *row = [a as f32, b as f32, rest(a), rest(b)];
        }
        let mut parameters = lobe.parameters();
        (lobe.model().derive)(&mut parameters);
        let at = |k: usize| [0, 1, 2, 3].map(|j| parameters[4 * k + j]);
        let (first, second) = (at(0), at(1));
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
    /// The points of some texels, one texel after the other: the range of each, what has none, and all points.
    pub fn texels(&self, texels: &[Texel]) -> [wgpu::Buffer; 3] {
        let (mut ranges, mut limits, mut points) = (Vec::new(), Vec::new(), Vec::new());
        for texel in texels {
            let first = points.len() as u32;
            limits.push(match texel {
                Texel::Limit(limit) => *limit,
                Texel::Samples(samples) => {
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

    /// A uniform array of so many vectors, the rest of them 0.
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

    /// Of each four rows, column after column.
    fn fours_of_rows(&self, matrix: &Matrix) -> wgpu::Buffer {
        let at = |row: usize, column: usize| match row < matrix.rows {
            true => matrix.values[row * matrix.columns + column],
            false => 0.0,
        };
        let fours = (0..matrix.rows).step_by(TILE_SUMS);
        let columns =
            |row| (0..matrix.columns).flat_map(move |k| (row..row + TILE_SUMS).map(move |r| at(r, k)));
        self.reals(&fours.flat_map(columns).collect::<Vec<_>>())
    }

    fn pairs(&self, pairs: &[Pair]) -> wgpu::Buffer {
        self.reals(pairs.iter().map(|pair| pair.to_plain()).collect::<Vec<_>>().as_flattened())
    }

    fn azimuths(&self, azimuths: &[Azimuth]) -> wgpu::Buffer {
        self.reals(azimuths.iter().map(|azimuth| azimuth.to_array()).collect::<Vec<_>>().as_flattened())
    }

    /// Azimuths of values by fours, as the kernel takes them, those of each φi in whole windows.
    fn quads(&self, values: &ValueWork) -> wgpu::Buffer {
        const FACTORS: [fn(&Azimuth) -> f64; QUAD_FACTORS] = [
            |a| a.sin2,
            |a| a.cos2,
            |a| a.back,
            |a| a.frame.cp,
            |a| a.frame.cm,
            |a| a.frame.sp,
            |a| a.frame.sm,
        ];
        let mut quads: Vec<f32> = Vec::new();
        for window in values.frames.iter().flat_map(|azimuths| azimuths.chunks(4 * VALUE_WINDOW)) {
            for factor in FACTORS {
                let filled = quads.len() + 4 * VALUE_WINDOW;
                quads.extend(window.iter().map(|azimuth| factor(azimuth) as f32));
                // The last one fills the last quad; of what is beyond nothing is read.
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
