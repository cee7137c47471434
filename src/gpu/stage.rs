//! The work of one lobe, uploaded: f64 factors rounded to f32, as the kernels lay them out.

use super::baker::{Baker, RAW_BYTES, count};
use super::compose::{Kernel, VALUE_WINDOW};
use crate::error::Result;
use crate::models::{ALPHA_MIN_INTEGRAL, Model};
use crate::pair::{Azimuth, AzimuthF32, Pair, PairF32};
use crate::plan::Lobe;
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
    pairs: Vec<PairF32>,
}

impl Rows {
    /// Some of them as the kernel lays them out, in whole windows.
    pub fn window(&self, units: &Range<usize>) -> Vec<PairF32> {
        let row = |unit| {
            let pair: PairF32 = self.pairs[unit % self.pairs.len()];
            pair.with_alpha(self.alphas[unit / self.pairs.len()])
        };
        let mut rows: Vec<_> = units.clone().map(row).collect();
        rows.resize(rows.len().next_multiple_of(VALUE_WINDOW), PairF32::zeroed());
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
    pub pad: u32,
}

impl Stages {
    pub fn new(baker: &Baker, lobe: &Lobe, work: &Work, accumulate: bool) -> Result<Self> {
        let channels = lobe.weights.len();
        let job = Job { accumulate: u32::from(accumulate), ..Job::new(lobe) };
        match &work.kind {
            WorkKind::Values { pairs, azimuths } => Ok(Self {
                inner: Stage {
                    kernel: if accumulate { Kernel::AddValues } else { Kernel::Values },
                    model: Some(lobe.model),
                    channels,
                    job,
                    inputs: vec![baker.quads(azimuths)],
                    rows: Some(Rows {
                        alphas: work.alphas.clone(),
                        pairs: pairs.iter().map(PairF32::from).collect(),
                    }),
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
                    ..Stage::inner(baker, inner, &work.alphas)?
                },
                sum: Some(Stage {
                    kernel: Kernel::Sum,
                    model: None,
                    channels: 0,
                    job: Job { columns: count(channels)?, nodes: count(outer.len())?, ..job },
                    inputs: vec![baker.reals(outer)],
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
        if self.sum.is_some() { self.inner.per_unit * RAW_BYTES } else { 0 }
    }
}

impl Stage {
    /// The kernel, counts and inputs of inner integrals.
    fn inner(baker: &Baker, inner: &Inner, alphas: &[f64]) -> Result<Self> {
        let (kernel, azimuths, nodes, inputs) = match inner {
            Inner::Slopes(work) => {
                // What is so near the mirror that it is the mirror's in f64 is 0 to the kernel.
                let mut alphas: Vec<_> = alphas
                    .iter()
                    .map(|&alpha| if alpha < ALPHA_MIN_INTEGRAL { 0.0 } else { alpha })
                    .collect();
                let rows = alphas.len();
                alphas.resize(rows.next_multiple_of(TILE_ALPHAS), 1.0);
                let pair = |[a, b]: [Range<usize>; 2]| [a.start, a.len(), b.start, b.len()].map(|n| n as u32);
                let columns: Vec<_> = work.columns.iter().cloned().map(pair).collect();
                let tiles: Vec<_> = work.tiles().map(pair).collect();
                let azimuths: Vec<_> = work.azimuths.iter().map(|a| a.map(|x| x as f32)).collect();
                let nodes: Vec<_> = work.nodes.iter().map(|n| [n.x as f32, n.weight as f32]).collect();
                let inputs = vec![
                    baker.reals(&alphas),
                    baker.reals(&work.mus),
                    baker.input(&columns),
                    baker.input(&tiles),
                    baker.input(&azimuths),
                    baker.input(&nodes),
                ];
                (Kernel::Slopes, 0, rows, inputs)
            }
            Inner::Product { pairs, azimuths } => {
                let inputs = vec![baker.reals(alphas), baker.pairs(pairs), baker.azimuths(azimuths)];
                (Kernel::Product, azimuths.len(), 0, inputs)
            }
            Inner::Analytic { mus, .. } => {
                (Kernel::Analytic, 0, 0, vec![baker.reals(alphas), baker.reals(mus)])
            }
        };
        let job = Job {
            columns: count(inner.count())?,
            azimuths: count(azimuths)?,
            nodes: count(nodes)?,
            ..Job::zeroed()
        };
        let units = if kernel == Kernel::Slopes { TILE_ALPHAS } else { 1 };
        Ok(Self {
            kernel,
            model: None,
            channels: 0,
            job,
            inputs,
            rows: None,
            per_unit: 1,
            units,
            cost: units * inner.cost(),
        })
    }
}

impl Job {
    fn new(lobe: &Lobe) -> Self {
        let mut weights = [[0.0; 4]; 3];
        for (row, [a, b]) in weights.iter_mut().zip(&lobe.weights) {
            *row = [*a as f32, *b as f32, 0.0, 0.0];
        }
        Self { weights, ..Self::zeroed() }
    }
}

impl Baker {
    fn reals(&self, values: &[f64]) -> wgpu::Buffer {
        self.input(&values.iter().map(|&x| x as f32).collect::<Vec<_>>())
    }

    fn pairs(&self, pairs: &[Pair]) -> wgpu::Buffer {
        self.input(&pairs.iter().map(PairF32::from).collect::<Vec<_>>())
    }

    fn azimuths(&self, azimuths: &[Azimuth]) -> wgpu::Buffer {
        self.input(&azimuths.iter().map(AzimuthF32::from).collect::<Vec<_>>())
    }

    /// Azimuths by fours, sin² and then cos², in whole windows.
    fn quads(&self, azimuths: &[Azimuth]) -> wgpu::Buffer {
        let four = |four: &[Azimuth]| {
            // The last one fills the last quad.
            let of = |k: usize| &four[k.min(four.len() - 1)];
            let at = |get: fn(&Azimuth) -> f64| [0, 1, 2, 3].map(|k| get(of(k)) as f32);
            [at(|a| a.sin2), at(|a| a.cos2)]
        };
        let mut quads: Vec<_> = azimuths.chunks(4).map(four).collect();
        quads.resize(quads.len().next_multiple_of(VALUE_WINDOW), [[0.0; 4]; 2]);
        self.init(bytemuck::cast_slice(&quads), wgpu::BufferUsages::UNIFORM)
    }

    fn input<T: Pod>(&self, items: &[T]) -> wgpu::Buffer {
        self.init(bytemuck::cast_slice(items), wgpu::BufferUsages::STORAGE)
    }
}
