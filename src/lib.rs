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
//! [`split_sum`](table::quantity::SPLIT_SUM) of the GGX basis over (roughness, μ); a goniometer's sweep is
//! [`brdf`](table::quantity::BRDF) over (θi, θe, δφ).
//!
//! Modules stand in layers: each uses those above it in this table and none below. Features are in parentheses.
//!
//! | module | what it has |
//! |---|---|
//! | [`base`] | errors, the tolerance and how it is spent, f32 budgets, angles, quadrature, solid angles |
//! | [`table`] | what a table is: axes, quantities, storage, rules, values and their error |
//! | [`model`] | the models and the parts that they are made of: shaders and f64 twins |
//! | [`plan`] | one table to bake, checked once and then immutable |
//! | `integrate` | nodes, weights and matrices in f64, for the device and the CPU path |
//! | [`shader`] | composing and validating WGSL, registering a model of your own |
//! | [`backend`] | the CPU path, and the device through wgpu: [`Baker`](backend::gpu::Baker) and [`Device`](backend::gpu::Device) |
//! | `check` (check) | comparison with the reference, the error of bilinear look-ups, the smallest table |
//! | [`bake`] | evaluate, certify, check; values at any list of pairs of directions |
//! | `scene` (scene) | glTF scenes, recipes, materials, and the planner of their tables |
//! | `io` (files) | EXR, NPY, PNG, targets, the manifest; sets that are written all or nothing |
//! | `light` (light) | environment maps, skies; irradiance, harmonics, exitant radiance, radiosity |
//! | `verify` (verify) | the properties of a BRDF, and the worst input that breaks them |
//! | `batch` (batch) | all tables of a scene into one folder |
//! | `lab` (lab) | what f32 loses, and what each method costs |
//!
//! `docs/architecture.md` in the repository says what each must not know, and how to add a part, a quantity, a format or
//! a target. `docs/slope_map.md` derives the integrals of microfacet lobes.
//!
//! Three evaluations of each model exist, on purpose. The **shader** and its **twin** (same file name, same formulas, from
//! angles, in f32 and f64) bake. The **reference** (the crate `gonio-reference`, written from the papers, from half
//! vectors) judges both and shares nothing with them.
//!
//! A scene bakes **bases**, not colours: a model with unit weights over the roughness that occurs. Its components A and B
//! are what F0 and F90 multiply, so a material is weights on bases, f = Σ (a·A + b·B), and the manifest has the weights.
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
//! [`Baker`](backend::gpu::Baker) works on your `wgpu::Device`, records into your encoder and returns a buffer or a
//! texture, without read-back:
//!
//! ```
//! use gonio::backend::gpu::{Baker, TextureFormat};
//! use gonio::plan::TablePlan;
//! use gonio::table::axis::{Axis, Variable};
//! use gonio::table::quantity::SPLIT_SUM;
//! use gonio::{model, wgpu};
//!
//! fn dfg(
//!     device: &wgpu::Device,
//!     queue: &wgpu::Queue,
//!     encoder: &mut wgpu::CommandEncoder,
//! ) -> gonio::Result<wgpu::Texture> {
//!     let axes = vec![Axis::natural(Variable::Roughness, 64)?, Axis::natural(Variable::Mu, 64)?];
//!     let table = TablePlan::basis("dfg", &SPLIT_SUM, model::find("ggx")?, None, axes)?;
//!     Baker::new(device, queue).record_texture(encoder, &table, TextureFormat::Rg16Float)
//! }
//! ```
//!
//! [`Device::from_wgpu`](backend::gpu::Device::from_wgpu) makes an [`Evaluator`](bake::Evaluator) of your device. It bakes,
//! certifies and returns tables to the host, as the command does:
//!
//! ```
//! use gonio::backend::gpu::Device;
//! use gonio::bake::{Evaluator, Unobserved};
//! use gonio::base::timings::Timings;
//! use gonio::plan::TablePlan;
//! use gonio::table::{Check, Table};
//! use gonio::wgpu;
//!
//! fn bake(device: &wgpu::Device, queue: &wgpu::Queue, plan: &TablePlan) -> gonio::Result<Table> {
//!     let evaluator = Evaluator::Device(Box::new(Device::from_wgpu(device, queue)));
//!     evaluator.bake(plan, Check::Sample(0), &mut Timings::default(), &Unobserved)
//! }
//! ```
//!
//! # Features
//!
//! Without any feature (`default-features = false`) the crate bakes tables, on a device or the CPU, and nothing else. That
//! is enough for an embedder who has opened a `wgpu::Device`.
//!
//! | feature | what it adds |
//! |---|---|
//! | `check` | comparison with the f64 reference, the error of bilinear look-ups, the smallest table |
//! | `scene` | scenes and recipes (glTF, TOML), and the plan of their tables; has `check` |
//! | `files` | table files and their manifest: EXR, NPY, PNG previews |
//! | `batch` | all tables of a scene into a folder, larger than memory if need be; has `files`, `scene` |
//! | `verify` | reciprocity, energy, symmetry, finite values of a BRDF or a WGSL function; has `scene` |
//! | `light` | environment maps, skies, irradiance, harmonics, exitant radiance, radiosity; has `scene` |
//! | `lab` | the atlas of f32 errors and the trade-off of methods; has `files`, `verify` |
//! | `cli` (default) | the command and its figures, and all of the above, with `vulkan`, `metal` and `dx12` |
//! | `vulkan`, `vulkan-portability`, `metal`, `dx12`, `gles`, `webgpu` | that back end of wgpu |

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
#[cfg(any(feature = "fuzz", all(test, feature = "cli")))]
#[doc(hidden)]
pub mod fuzz;
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
