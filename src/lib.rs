//! **gonio**, a gonioreflectometer in compute shaders: BRDF values and cosine-weighted hemispherical
//! integrals over dense (θ, φ) grids, computed by WGSL kernels and measured against an independent f64
//! reference.
//!
//! # Architecture
//!
//! ```text
//! scene (glTF | recipe) → plan → kernels → tables → files
//!                          └→ reference (CPU, f64) → cross-check
//! ```
//!
//! One abstraction carries everything: **table = quantity × axes × subject**. A DFG look-up table is
//! [`split_sum`](quantity::SPLIT_SUM) of the GGX basis over (roughness, μ); a goniometer's sweep is
//! [`brdf`](quantity::BRDF) over (θi, θe, δφ).
//!
//! | module | what it knows | what it must not know |
//! |---|---|---|
//! | [`scene`] | materials, and the ranges their parameters take | devices, resolutions |
//! | [`plan`] | which tables, over which axes, by which rule: plain data | devices, files |
//! | [`models`] | the parts and models: WGSL, and its f64 twin for the CPU path | the reference |
//! | [`gpu`] | composing, validating and recording the kernels that a plan needs | scenes, files |
//! | [`mod@reference`] | the textbook's formulas in f64, adaptive quadrature | everything else |
//! | [`check`] | a table's texels against the reference | how they were computed |
//! | [`promises`] | what a BRDF promises, and the worst input that breaks it | how it is evaluated |
//! | [`trade`] | every method at every cost: time and error, and the front | files, devices |
//! | [`atlas`] | what f32 loses against f64, by model and decade of α; the published forms of GGX | how values are computed |
//! | [`bake`] | the order of it all: evaluate, look, check, write | how any of it is done |
//! | `portrait` | what a picture of a BRDF shows: lobes, lit spheres, ρ_dh | how it is drawn |
//! | [`points`] | values at any list of pairs of directions, unlooked at | tables, files |
//! | [`factor`] | what a lobe is multiplied with by the two cosines: compensation, coats, sheen | azimuths, devices |
//! | [`mapped`] | integrals by directions that the host finds, for lobes that no kernel has a map for | where a lobe lives: the models |
//! | [`radiometry`] | solid angles, beams, photons: SI | everything else |
//! | [`light`] | environment maps and other lights; irradiance, harmonics, exitant radiance, radiosity | files, pictures |
//! | [`table`], [`axis`], [`quantity`], [`storage`], [`setting`] | what a table is | where it came from |
//! | `work`, `slopes`, `sampling`, `spread` | the rules: nodes, weights, matrices, in f64 | devices |
//! | `interpolation`, `optimise` | what a bilinear reader gets, and the cheapest table for it | devices |
//! | `files` | EXR, NPY, PNG, the manifest; sets written all or nothing | physics |
//!
//! Three evaluations of each model exist, on purpose. The **shader** and its **twin** (same file name,
//! same formulas, from angles, in f32 and f64) bake; the **reference** (the crate `gonio-reference`, written
//! from the papers, from half vectors) judges both and shares nothing with them.
//!
//! A scene bakes **bases**, not colours: a model with unit weights over the roughness that occurs. Its
//! components A and B are what F0 and F90 multiply, so a material is weights on bases,
//! f = Σ (a·A + b·B), and the manifest has the weights.
//!
//! # Conventions
//!
//! n = +z; ωi and ωe are unit and point away from the surface; θ is the zenith angle and φ the azimuth,
//! rad; μ = cos θ; f is in sr⁻¹, without the cosine; δφ = φe − φi − π ∈ (−π, π] is 0 in the mirror
//! direction; α = roughness². Every evaluation takes μ = max(cos θ, 2⁻²⁴): f diverges where both
//! directions graze.
//!
//! # Embedding
//!
//! [`gpu::Baker`] works on your `wgpu::Device`, records into your encoder and returns a buffer or a
//! texture, without read-back:
//!
//! ```no_run
//! use gonio::{axis::{Axis, Variable}, gpu::{Baker, TextureFormat}, models, plan::TablePlan, quantity, wgpu};
//!
//! fn dfg(device: &wgpu::Device, queue: &wgpu::Queue, encoder: &mut wgpu::CommandEncoder) -> gonio::Result<wgpu::Texture> {
//!     let axes = vec![Axis::natural(Variable::Roughness, 64)?, Axis::natural(Variable::Mu, 64)?];
//!     let table = TablePlan::basis("dfg", &quantity::SPLIT_SUM, model::find("ggx")?, None, axes)?;
//!     Baker::new(device, queue).record_texture(encoder, &table, TextureFormat::Rg16Float)
//! }
//! ```
//!
//! # Features
//!
//! Without any feature (`default-features = false`) the crate bakes tables, on a device or the CPU, and nothing else:
//! that is what an embedder takes, who has opened a `wgpu::Device` already. `Cargo.toml` says what each feature adds;
//! `cli`, the default, is the command and has all of them.

// Helpers that only another feature's room uses are dead in a build with some features. The builds with none and with
// all are held to have no dead code.
#![cfg_attr(
    all(not(feature = "cli"), any(feature = "check", feature = "files")),
    allow(dead_code, unused_imports)
)]

pub mod backend;
pub mod bake;
pub mod base;
#[cfg(feature = "batch")]
pub mod batch;
#[cfg(feature = "check")]
pub mod check;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;
#[cfg(feature = "cli")]
mod figure;
mod integrate;
#[cfg(feature = "files")]
pub mod io;
#[cfg(feature = "lab")]
pub mod lab;
#[cfg(feature = "light")]
pub mod light;
pub mod model;
pub mod plan;
#[cfg(feature = "scene")]
pub mod scene;
pub mod shader;
pub mod table;
#[cfg(feature = "verify")]
pub mod verify;

pub use base::error::{Error, Result};
#[cfg(feature = "check")]
pub use gonio_reference as reference;
pub use wgpu;
