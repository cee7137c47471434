//! The work of one lobe, uploaded: f64 factors rounded to the kernels' precision, as they lay them out.

use super::baker::{Baker, count};
use super::compose::{Kernel, VALUE_WINDOW, vectors};
use crate::error::Result;
use crate::models::{ALPHA_MIN_INTEGRAL, Model};
use crate::pair::{Azimuth, Pair};
use crate::plan::{Lobe, Precision};
use crate::sampling::Sampler;
use crate::slopes::TILE_ALPHAS;
use crate::work::{Inner, Work, WorkKind};
use bytemuck::{Pod, Zeroable};
use std::ops::Range;

/// The stages of one lobe: values in one, or raw integrals and then their outer sum.
pub(super) struct Stages {
    pub inner: Stage,
    pub sum: Option<Stage>,
}

/// A kernel and what it reads.
pub(super) struct Stage {
    pub kernel: Kernel,
    pub model: Option<&'static Model>,
    /// Channels, where the kernel is composed for them.
    pub channels: usize,
    pub precision: Precision,
    pub job: Job,
    pub inputs: Vec<wgpu::Buffer>,
    /// The rows of a table of values, which are uploaded for each tile.
    pub rows: Option<Rows>,
    /// Results for each unit of the table (see `Layout`).
    pub per_unit: usize,
    /// Units whose results one invocation makes.
    pub units: usize,
    /// Evaluations of an invocation.
    pub cost: usize,
}

/// The rows of a table of values: every α with every pair.
pub(super) struct Rows {
    alphas: Vec<f64>,
    pairs: Vec<Row>,
}

/// `Pair` of `shaders/pair.wgsl` in f32, the only precision of values on a device. The last is α.
type Row = [f32; 8];

impl Rows {
    fn new(alphas: &[f64], pairs: &[Pair]) -> Self {
        let row = |pair: &Pair| pair.to_array().map(|x| x as f32);
        Self { alphas: alphas.to_vec(), pairs: pairs.iter().map(row).collect() }
    }

    /// Some of them as the kernel lays them out, in whole windows.
    pub fn window(&self, units: &Range<usize>) -> Vec<Row> {
        let row = |unit: usize| {
            let mut row = self.pairs[unit % self.pairs.len()];
            row[7] = self.alphas[unit / self.pairs.len()] as f32;
            row
        };
        let mut rows: Vec<_> = units.clone().map(row).collect();
        rows.resize(rows.len().next_multiple_of(VALUE_WINDOW), Row::zeroed());
        rows
    }
}

/// `Job` of `shaders/kernel/job.wgsl`.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Job {
    pub weights: [[f32; 4]; 3],
    pub first: u32,
    pub end: u32,
    pub base: u32,
    pub accumulate: u32,
    pub columns: u32,
    pub azimuths: u32,
    pub nodes: u32,
    pub alpha: f32,
}

impl Stages {
    pub fn new(
        baker: &Baker,
        lobe: &Lobe,
        work: &Work,
        accumulate: bool,
        precision: Precision,
    ) -> Result<Self> {
        let upload = Upload { baker, precision };
        let channels = lobe.weights.len();
        let job = Job { accumulate: u32::from(accumulate), ..Job::new(lobe) };
        match &work.kind {
            WorkKind::Values { pairs, azimuths } => Ok(Self {
                inner: Stage {
                    kernel: if accumulate { Kernel::AddValues } else { Kernel::Values },
                    model: Some(lobe.model),
                    channels,
                    precision: Precision::F32,
                    job,
                    inputs: vec![upload.quads(azimuths)],
                    rows: Some(Rows::new(&work.alphas, pairs)),
                    per_unit: azimuths.len().div_ceil(4),
                    units: 1,
                    cost: 4,
                },
                sum: None,
            }),
            WorkKind::Integrals { inner, outer } => Ok(Self {
                inner: Stage {
                    model: Some(lobe.model),
                    per_unit: inner.count(),
                    ..Stage::inner(&upload, inner, &work.alphas)?
                },
                sum: Some(Stage {
                    kernel: Kernel::Sum,
                    model: None,
                    channels: 0,
                    precision,
                    job: Job { columns: count(channels)?, nodes: count(outer.len())?, ..job },
                    inputs: vec![upload.reals(outer)],
                    rows: None,
                    per_unit: inner.count() / outer.len(),
                    units: 1,
                    cost: outer.len(),
                }),
            }),
        }
    }

    /// Bytes between the stages for each unit.
    pub fn raw_bytes_per_unit(&self) -> usize {
        if self.sum.is_some() { self.inner.per_unit * 2 * self.inner.precision.bytes() } else { 0 }
    }
}

impl Stage {
    /// The kernel, counts and inputs of inner integrals.
    fn inner(upload: &Upload, inner: &Inner, alphas: &[f64]) -> Result<Self> {
        let (kernel, azimuths, nodes, inputs) = match inner {
            Inner::Slopes(work) => {
                let (alphas, rows) = fours(alphas);
                let pair = |[a, b]: [Range<usize>; 2]| [a.start, a.len(), b.start, b.len()].map(|n| n as u32);
                let columns: Vec<_> = work.columns.iter().cloned().map(pair).collect();
                let tiles: Vec<_> = work.tiles().map(pair).collect();
                let nodes: Vec<_> = work.nodes.iter().map(|node| [node.x, node.weight, 0.0, 0.0]).collect();
                let most = vectors(upload.precision);
                let many = work.azimuths.len().max(nodes.len()) > most;
                let table = |vectors: &[[f64; 4]]| match many {
                    true => upload.reals(vectors.as_flattened()),
                    false => upload.uniforms(vectors, most),
                };
                let inputs = vec![
                    upload.reals(&alphas),
                    upload.reals(&work.mus),
                    upload.input(&columns),
                    upload.input(&tiles),
                    table(&work.azimuths),
                    table(&nodes),
                ];
                (if many { Kernel::SlopesOfMany } else { Kernel::Slopes }, 0, rows, inputs)
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
            Inner::Analytic { mus, .. } => {
                (Kernel::Analytic, 0, 0, vec![upload.reals(alphas), upload.reals(mus)])
            }
        };
        let job = Job {
            columns: count(inner.count())?,
            azimuths: count(azimuths)?,
            nodes: count(nodes)?,
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
            per_unit: 1,
            units,
            cost: units * inner.cost(),
        })
    }
}

/// α padded to whole fours, and how many there were. What is so near the mirror that it is the mirror's
/// in f64 is 0 to the kernels.
fn fours(alphas: &[f64]) -> (Vec<f64>, usize) {
    let mut padded: Vec<_> =
        alphas.iter().map(|&alpha| if alpha < ALPHA_MIN_INTEGRAL { 0.0 } else { alpha }).collect();
    padded.resize(alphas.len().next_multiple_of(TILE_ALPHAS), 1.0);
    (padded, alphas.len())
}

impl Job {
    pub fn new(lobe: &Lobe) -> Self {
        let mut weights = [[0.0; 4]; 3];
        for (row, &[a, b]) in weights.iter_mut().zip(&lobe.weights) {
            // What f32 drops is kept for kernels in f64.
            let rest = |x: f64| (x - f64::from(x as f32)) as f32;
            *row = [a as f32, b as f32, rest(a), rest(b)];
        }
        Self { weights, ..Self::zeroed() }
    }
}

/// Uploads numbers in the kernels' precision.
struct Upload<'a> {
    baker: &'a Baker,
    precision: Precision,
}

impl Upload<'_> {
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

    fn pairs(&self, pairs: &[Pair]) -> wgpu::Buffer {
        self.reals(pairs.iter().map(|pair| pair.to_array()).collect::<Vec<_>>().as_flattened())
    }

    fn azimuths(&self, azimuths: &[Azimuth]) -> wgpu::Buffer {
        self.reals(azimuths.iter().map(|azimuth| azimuth.to_array()).collect::<Vec<_>>().as_flattened())
    }

    /// Azimuths of values by fours, sin² and then cos², in whole windows.
    fn quads(&self, azimuths: &[Azimuth]) -> wgpu::Buffer {
        let four = |four: &[Azimuth]| {
            // The last one fills the last quad.
            let of = |k: usize| &four[k.min(four.len() - 1)];
            let at = |get: fn(&Azimuth) -> f64| [0, 1, 2, 3].map(|k| get(of(k)) as f32);
            [at(|a| a.sin2), at(|a| a.cos2)]
        };
        let mut quads: Vec<_> = azimuths.chunks(4).map(four).collect();
        quads.resize(quads.len().next_multiple_of(VALUE_WINDOW), [[0.0; 4]; 2]);
        self.baker.init(bytemuck::cast_slice(&quads), wgpu::BufferUsages::UNIFORM)
    }

    fn input<T: Pod>(&self, items: &[T]) -> wgpu::Buffer {
        self.baker.init(bytemuck::cast_slice(items), wgpu::BufferUsages::STORAGE)
    }
}
