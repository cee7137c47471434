//! Random and quasi-random draws of the sampling rules: one table for all texels, or a sequence for each texel.

use crate::model::parameters::Setting;
use crate::table::rule::CHUNK;
use std::f64::consts::PI;

/// The distribution and the sequence that a microfacet normal is drawn from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sampler {
    /// The distribution of normals, by Hammersley's points.
    Ndf,
    /// The visible normals, by Hammersley's points, centred.
    Vndf,
    /// The visible normals, at random.
    Random,
}

/// The inner integrals by sampling: one for each (α, μ, chunk).
pub(crate) struct SampleRule {
    pub sampler: Sampler,
    pub sampling: &'static crate::model::Sampling,
    pub mirror_limit: fn(f64, &Setting) -> [f64; 2],
    pub mus: Vec<f64>,
    /// The number of samples of a chunk.
    pub chunk: usize,
    pub chunks: usize,
    /// The two numbers of each sample; empty where samples are random.
    pub draws: Vec<[f64; 2]>,
}

impl SampleRule {
    pub fn new(
        sampler: Sampler,
        slopes: &'static crate::model::Slopes,
        sampling: &'static crate::model::Sampling,
        mus: Vec<f64>,
        samples: usize,
    ) -> Self {
        let chunk = samples.min(CHUNK);
        let draws = match sampler {
            Sampler::Random => Vec::new(),
            Sampler::Ndf => hammersley(samples).map(|[u, v]| [(u / (1.0 - u)).sqrt(), v]).collect(),
            Sampler::Vndf => centred(samples).collect(),
        };
        let mirror_limit = slopes.mirror_limit;
        Self { sampler, sampling, mirror_limit, mus, chunk, chunks: samples / chunk, draws }
    }

    /// The sum over a chunk of samples, in f64.
    pub fn sum(&self, row: usize, k: usize, setting: &Setting) -> [f64; 2] {
        let (column, chunk) = (k / self.chunks, k % self.chunks);
        let mu = self.mus[column];
        let add = |sum: [f64; 2], [a, b]: [f64; 2]| [sum[0] + a, sum[1] + b];
        let draws = || self.draws[chunk * self.chunk..][..self.chunk].iter().copied();
        match self.sampler {
            Sampler::Ndf => draws().map(|draw| (self.sampling.ndf)(draw, mu, setting)).fold([0.0; 2], add),
            Sampler::Vndf => draws().map(|draw| (self.sampling.vndf)(draw, mu, setting)).fold([0.0; 2], add),
            Sampler::Random => {
                let mut pcg = Pcg::new((row * self.mus.len() + column) as u32, chunk as u32);
                let draws = (0..self.chunk).map(|_| pcg.draw());
                draws.map(|draw| (self.sampling.vndf)(draw, mu, setting)).fold([0.0; 2], add)
            }
        }
    }
}

/// Hammersley's n points (u, cos φ) as Karis 2013 and Filament's `cmgen` take them: φ = 2π k/n, and u the radical inverse
/// of k, from 0.
fn hammersley(n: usize) -> impl Iterator<Item = [f64; 2]> {
    (0..n as u32).map(move |k| {
        let reversed = f64::from(k.reverse_bits()) / 2f64.powi(32);
        [reversed, (2.0 * PI * f64::from(k) / n as f64).cos()]
    })
}

/// The same points centred in their cells, with φ over half a turn: enough for lobes that are symmetric in φ. Both favour the
/// sampler, which has no direction at u = 0.
fn centred(n: usize) -> impl Iterator<Item = [f64; 2]> {
    let half = 0.5 / n as f64;
    (0..n as u32).map(move |k| {
        let reversed = f64::from(k.reverse_bits()) / 2f64.powi(32);
        [f64::from(k) / n as f64 + half, (PI * (reversed + half)).cos()]
    })
}

/// The PCG random number generator, the twin of `shaders/sampling/random.wgsl`.
struct Pcg(u32);

impl Pcg {
    fn new(texel: u32, chunk: u32) -> Self {
        let hash = |x| Self::permuted(Self::stepped(x));
        Self(hash(hash(texel).wrapping_add(chunk)))
    }

    fn draw(&mut self) -> [f64; 2] {
        let u = self.uniform();
        [u, (PI * self.uniform()).cos()]
    }

    fn uniform(&mut self) -> f64 {
        self.0 = Self::stepped(self.0);
        (f64::from(Self::permuted(self.0) >> 8) + 0.5) / 2f64.powi(24)
    }

    fn stepped(x: u32) -> u32 {
        x.wrapping_mul(747_796_405).wrapping_add(2_891_336_453)
    }

    fn permuted(x: u32) -> u32 {
        let word = ((x >> ((x >> 28) + 4)) ^ x).wrapping_mul(277_803_737);
        (word >> 22) ^ word
    }
}
