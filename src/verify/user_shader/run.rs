//! Runs a user's function on a device.

use super::UserFunction;
use super::compose::{CUT, STRIDE, WORKGROUP, job};
use super::resources::{RESOURCES, bind_group, has_f32};
use crate::backend::gpu::device::Device;
use crate::base::angles::Angles;
use crate::base::error::{Error, Result};
use crate::base::half_angle::MU_MIN;
use crate::base::timings::Stopwatch;
use crate::verify::limits;
use crate::verify::{ParameterRange, Subject, Symmetry};
use rayon::prelude::*;
use std::borrow::Cow;
use std::f64::consts::FRAC_PI_2;
use std::sync::mpsc;
use std::time::Duration;

/// The directions of a pair as the function gets them: (x, y, z), n = +z, rounded to f32.
///
/// θ = π/2 is the horizon, z = 0. Where both are nearer to it than 2⁻²⁴ they are put there: f diverges, and a
/// half vector of opposite directions would be 0. So is ωi alone where the cosine is to be divided out. Beyond π/2 both
/// are on the horizon to the bit. A sine or cosine of an azimuth that is 0 but for the digits of π is 0, and opposite
/// azimuths are so to the bit.
pub fn directions(angles: &Angles, cosine: bool) -> [[f32; 3]; 2] {
    vectors(angles, cosine).map(|vector| vector.map(|x| x as f32 + 0.0)) // no −0
}

fn vectors(angles: &Angles, cosine: bool) -> [[f64; 3]; 2] {
    let (mut mu_i, mut mu_e) = (cos(angles.theta_i), cos(angles.theta_e));
    let is_exact = angles.theta_i > FRAC_PI_2 && angles.theta_e > FRAC_PI_2 && !cosine;
    if !is_exact && mu_i < MU_MIN && (mu_e < MU_MIN || cosine) {
        mu_i = MU_MIN;
        mu_e = if mu_e < MU_MIN { MU_MIN } else { mu_e };
    }
    let is_opposite = angles.delta_phi().abs() <= f64::EPSILON * (1.0 + angles.phi_e.abs());
    let (phi_e, sign_e) = if is_opposite { (angles.phi_i, -1.0) } else { (angles.phi_e, 1.0) };
    let without_dust = |x: f64| if x.abs() < f64::EPSILON { 0.0 } else { x };
    let vector = |theta: f64, phi: f64, mu: f64, sign: f64| {
        let (sin, [sin_phi, cos_phi]) = (sign * theta.sin(), [phi.sin(), phi.cos()].map(without_dust));
        [sin * cos_phi, sin * sin_phi, mu]
    };
    [vector(angles.theta_i, angles.phi_i, mu_i, 1.0), vector(angles.theta_e, phi_e, mu_e, sign_e)]
}

/// What a pair is on the device: ωi and ωi · h, ωo and ωi · ωo, h.
fn pair(angles: &Angles, cosine: bool) -> [f32; STRIDE] {
    let [i, o] = vectors(angles, cosine);
    let sum = [0, 1, 2].map(|k| i[k] + o[k]);
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let length = dot(sum, sum).sqrt();
    // Of opposite directions it is none; the normal is as good as any.
    let h = if length > 0.0 { sum.map(|x| x / length) } else { [0.0, 0.0, 1.0] };
    let [a, b, c] =
        [(i, dot(i, h)), (o, dot(i, o)), (h, 0.0)].map(|([x, y, z], w)| [x, y, z, w].map(|x| x as f32 + 0.0));
    let mut all = [0.0; STRIDE];
    for (four, values) in all.chunks_exact_mut(4).zip([a, b, c]) {
        four.copy_from_slice(&values);
    }
    all
}

/// cos θ, 0 at the f64 nearest to π/2 and beyond.
fn cos(theta: f64) -> f64 {
    if theta < FRAC_PI_2 { theta.cos() } else { 0.0 }
}

/// A user's BRDF on a device.
pub struct UserShader<'a> {
    device: &'a Device,
    function: UserFunction,
    parameters: Vec<ParameterRange>,
    /// Whether it has cos θi in it.
    cosine: bool,
    symmetry: Symmetry,
    /// Turns after which the driver stops its loops, if it has any and the driver does.
    loop_turns: Option<u32>,
    /// Whether the driver may have stopped them.
    is_cut: bool,
    pipeline: wgpu::ComputePipeline,
    bindings: wgpu::BindGroup,
    /// Textures and samplers, where it reads some.
    resources: Option<wgpu::BindGroup>,
    job: wgpu::Buffer,
    pairs: wgpu::Buffer,
    values: wgpu::Buffer,
    untouched: wgpu::Buffer,
    staging: wgpu::Buffer,
    /// Pairs in a dispatch, as many as the time allows; no result depends on it.
    batch: usize,
}

/// A group of bindings: the user's file has none left.
pub(super) const GROUP: u32 = 0;
/// Pairs in a dispatch: at first, and at most.
const BATCH: usize = WORKGROUP;
const LARGEST_BATCH: usize = 1 << 17;
/// Dispatches longer than this, s, are halved, shorter than a quarter doubled: well below the 2 s after which
/// drivers lose patience.
const LONG: f64 = 0.08;
/// A shader that takes longer for one dispatch does not end.
const PATIENCE: Duration = Duration::from_secs(30);
/// What values hold before they are computed: a NaN that no arithmetic makes.
const UNTOUCHED: u32 = 0xffc0_71ed;

impl<'a> UserShader<'a> {
    /// Compiles a function for a device. `parameters` are its own, in its order.
    ///
    /// # Errors
    /// When the parameters are not its own, or the device refuses the shader.
    pub fn new(
        device: &'a Device,
        function: UserFunction,
        parameters: Vec<ParameterRange>,
        cosine: bool,
        symmetry: Symmetry,
    ) -> Result<Self> {
        let names = || function.parameters().iter().map(|parameter| &parameter.name);
        if !parameters.iter().map(|parameter| &parameter.name).eq(names()) {
            return Err(Error::input(format!(
                "{}: fn {} takes the parameters [{}], in this order",
                function.file,
                function.entry,
                names().cloned().collect::<Vec<_>>().join(", ")
            )));
        }
        if let Some(name) = function.unbound() {
            return Err(Error::input(format!("{}: nothing is bound to `{name}`", function.name())));
        }
        let fitted = function.parameters().iter().zip(parameters).map(|(own, range)| own.fitted(range));
        let parameters = fitted.collect::<Result<_>>()?;
        if function.half && !device.wgpu().0.features().contains(wgpu::Features::SHADER_F16) {
            return Err(Error::Device(format!(
                "{}: fn {} computes in f16, which {} cannot (SHADER_F16)",
                function.file,
                function.entry,
                device.name()
            )));
        }
        let refused = |why: Error| {
            Error::input(format!("{}: the device does not take fn {}: {why}", function.file, function.entry))
        };
        let loop_turns = if function.loops { device.canary()?.loop_turns } else { None };
        let (wgpu, _) = device.wgpu();
        let pipeline = device.guarded(|| {
            limits::with_stack(function.is_deep, || {
                let source = wgpu::ShaderSource::Naga(Cow::Owned(function.compose(loop_turns)?));
                let module = wgpu.create_shader_module(wgpu::ShaderModuleDescriptor {
                    label: Some(&function.entry),
                    source,
                });
                device.fault()?;
                Ok(wgpu.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                    label: Some(&function.entry),
                    layout: None,
                    module: &module,
                    entry_point: None,
                    compilation_options: Default::default(),
                    cache: None,
                }))
            })
        });
        let pipeline = pipeline.map_err(refused)?;

        use wgpu::BufferUsages as Usage;
        let buffer = |size: usize, usage| {
            wgpu.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size: size as u64,
                usage,
                mapped_at_creation: false,
            })
        };
        let size = LARGEST_BATCH * function.signature.result.channels * 4;
        let job_buffer = buffer(job(function.parameters(), &[], 0).len(), Usage::UNIFORM | Usage::COPY_DST);
        let pairs = buffer(LARGEST_BATCH * STRIDE * 4, Usage::STORAGE | Usage::COPY_DST);
        let values = buffer(size, Usage::STORAGE | Usage::COPY_DST | Usage::COPY_SRC);
        let staging = buffer(size, Usage::MAP_READ | Usage::COPY_DST);
        let pattern: Vec<u8> = UNTOUCHED.to_ne_bytes().repeat(size / 4);
        let untouched = device.baker().init(&pattern, Usage::COPY_SRC);
        let bindings = wgpu.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(GROUP),
            entries: &[&job_buffer, &pairs, &values]
                .map(|buffer| buffer.as_entire_binding())
                .into_iter()
                .zip(0..)
                .map(|(resource, binding)| wgpu::BindGroupEntry { binding, resource })
                .collect::<Vec<_>>(),
        });
        let has_resources = !function.slots.is_empty();
        let resources = device.guarded(|| {
            let layout = has_resources.then(|| pipeline.get_bind_group_layout(RESOURCES));
            let (wgpu, queue) = device.wgpu();
            Ok(layout.map(|layout| bind_group(wgpu, queue, &layout, &function.slots)))
        })?;
        device.fault()?;
        Ok(Self {
            device,
            function,
            parameters,
            cosine,
            symmetry,
            loop_turns,
            is_cut: false,
            pipeline,
            bindings,
            resources,
            job: job_buffer,
            pairs,
            values,
            untouched,
            staging,
            batch: BATCH,
        })
    }

    /// One dispatch, of no more than a batch.
    fn dispatch(&mut self, setting: &[f64], angles: &[Angles], out: &mut Vec<f32>) -> Result<()> {
        let device = self.device;
        device.guarded(|| self.dispatch_unguarded(setting, angles, out))
    }

    fn dispatch_unguarded(&mut self, setting: &[f64], angles: &[Angles], out: &mut Vec<f32>) -> Result<()> {
        let (device, queue) = self.device.wgpu();
        let cosine = self.cosine;
        let pairs: Vec<[f32; STRIDE]> =
            angles.par_iter().with_min_len(512).map(|angles| pair(angles, cosine)).collect();
        let bytes = (angles.len() * self.function.signature.result.channels * 4) as u64;
        queue.write_buffer(&self.job, 0, &job(self.function.parameters(), setting, angles.len()));
        queue.write_buffer(&self.pairs, 0, bytemuck::cast_slice(&pairs));
        let mut encoder = device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(&self.untouched, 0, &self.values, 0, bytes);
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(GROUP, &self.bindings, &[]);
            if let Some(resources) = &self.resources {
                pass.set_bind_group(RESOURCES, resources, &[]);
            }
            pass.dispatch_workgroups(angles.len().div_ceil(WORKGROUP) as u32, 1, 1);
        }
        encoder.copy_buffer_to_buffer(&self.values, 0, &self.staging, 0, bytes);
        let start = Stopwatch::start();
        let submission = queue.submit([encoder.finish()]);
        let (sender, mapped) = mpsc::channel();
        self.staging.map_async(wgpu::MapMode::Read, ..bytes, move |result| {
            let _ = sender.send(result);
        });
        let lost = |why: String| Error::Device(format!("{}: {why}", self.device.name()));
        let wait = wgpu::PollType::Wait { submission_index: Some(submission), timeout: Some(PATIENCE) };
        let polled = device.poll(wait);
        self.device.fault()?;
        if let Err(wgpu::PollError::Timeout) = polled {
            return Err(lost(format!(
                "fn {} did not end in {} s for {} pairs of directions",
                self.function.entry,
                PATIENCE.as_secs(),
                angles.len()
            )));
        }
        polled.map_err(|e| lost(e.to_string()))?;
        mapped.recv().map_err(|e| lost(e.to_string()))?.map_err(|e| lost(e.to_string()))?;
        let view = self.staging.get_mapped_range(..bytes).map_err(|e| lost(e.to_string()))?;
        let first = out.len();
        out.extend(view.chunks_exact(4).map(|b| f32::from_ne_bytes([b[0], b[1], b[2], b[3]])));
        drop(view);
        self.staging.unmap();
        if out[first..].iter().any(|value| value.to_bits() == UNTOUCHED) {
            return Err(lost(format!(
                "it did not run fn {} for every pair of directions",
                self.function.entry
            )));
        }
        if out[first..].iter().any(|value| value.to_bits() == CUT) {
            self.is_cut = true;
            return Err(lost(format!("it stops the loops of fn {}", self.function.entry)));
        }
        if cosine {
            // f cos θi as it was returned, by the cosine as it was given. What is not finite stays so.
            for (values, pair) in
                out[first..].chunks_exact_mut(self.function.signature.result.channels).zip(&pairs)
            {
                values.iter_mut().for_each(|value| *value /= pair[2]);
            }
        }
        let seconds = start.seconds();
        if seconds > LONG {
            self.batch = (self.batch / 2).max(WORKGROUP);
        } else if seconds < LONG / 4.0 && angles.len() == self.batch {
            self.batch = (self.batch * 2).min(LARGEST_BATCH);
        }
        Ok(())
    }
}

impl Subject for UserShader<'_> {
    fn name(&self) -> String {
        self.function.name()
    }

    fn parameters(&self) -> &[ParameterRange] {
        &self.parameters
    }

    fn channels(&self) -> usize {
        self.function.signature.result.channels
    }

    fn evaluate(&mut self, setting: &[f64], mut angles: &[Angles], out: &mut Vec<f32>) -> Result<()> {
        while !angles.is_empty() {
            let (now, later) = angles.split_at(angles.len().min(self.batch));
            self.dispatch(setting, now, out)?;
            angles = later;
        }
        Ok(())
    }

    fn symmetry(&self) -> Symmetry {
        self.symmetry
    }

    fn rounding(&self) -> f64 {
        0.5 * f64::from(f32::EPSILON)
    }

    fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if self.resources.is_some() && !has_f32(self.device.wgpu().0) {
            notes.push("its textures are in f16, as this device does not filter f32".into());
        }
        notes
    }

    fn cut_short(&self) -> Option<String> {
        let turns = self.loop_turns.filter(|_| self.is_cut)?;
        Some(format!(
            "the loops of fn {} take more than {} turns for a pair, and this driver silently stops loops after {turns} turns of \
             all pairs in step; use another driver or fewer turns",
            self.function.entry,
            limits::certain_turns(turns),
        ))
    }
}
