//! The seconds that each stage of a bake takes.

use serde::Serialize;
use std::time::Instant;

/// Measures wall-clock time. All of the crate reads the clock through it, so a platform that has another clock (a
/// browser) changes this file alone.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stopwatch(Instant);

impl Stopwatch {
    /// Starts now.
    pub fn start() -> Self {
        Self(Instant::now())
    }

    /// Seconds since the start.
    pub fn seconds(self) -> f64 {
        self.0.elapsed().as_secs_f64()
    }
}

/// The seconds that each stage of a bake took.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Timings {
    /// Reading the scene and its textures, and planning.
    pub scene: f64,
    /// Finding and opening the device.
    pub device: f64,
    /// Composing and validating shaders.
    pub compose: f64,
    /// Making factors and nodes, compiling pipelines, uploading.
    pub compile: f64,
    /// Running the kernels, or the CPU path. Software drivers compile a kernel when it first runs, unless they find it
    /// in a cache: that is most of a cold start.
    pub dispatch: f64,
    /// Running them again by a finer rule, to certify the first.
    pub certify: f64,
    /// Copying results back.
    pub readback: f64,
    /// Comparing with the reference: in a set of tables while the device computes the next one, so that all stages
    /// together may be longer than the bake.
    pub check: f64,
    /// Writing files.
    pub write: f64,
}
