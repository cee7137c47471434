//! A user's own BRDF: a WGSL function of two unit vectors, run as it is, in the device's arithmetic.
//!
//! The file stays the first lines of the module, so that errors point at its own lines; a compute entry
//! point that calls the function at a list of directions is put after it.

use crate::backend::gpu::device::Device;
use crate::base::angles::Angles;
use crate::base::error::{Error, Result};
use crate::base::half_angle::MU_MIN;
use crate::base::timings::Stopwatch;
use crate::verify::limits::{self, Inlined};
use crate::verify::{ParameterRange, Subject, Symmetry};
use naga::valid::{Capabilities, ModuleInfo, ShaderStages, ValidationFlags, Validator};
use naga::{Function, Module, ScalarKind, TypeInner, VectorSize};
use rayon::prelude::*;
use std::borrow::Cow;
use std::f64::consts::FRAC_PI_2;
use std::sync::mpsc;
use std::time::Duration;

/// A function of a WGSL file that fits.
#[derive(Debug, Clone)]
pub struct UserFunction {
    file: String,
    source: String,
    entry: String,
    parameters: Vec<String>,
    channels: usize,
    /// Whether it, or what it calls, has a loop.
    loops: bool,
    /// Whether it is nested deeper than the stack of any thread holds.
    is_deep: bool,
    /// A group of bindings that the file leaves free.
    group: u32,
}

/// What a function must look like.
const SHAPE: &str = "(wi: vec3f, wo: vec3f, further f32 parameters) -> f32 or vec3f";

/// Groups of bindings that every device has.
const GROUPS: u32 = 4;

impl UserFunction {
    /// Finds `entry` in a WGSL source; `file` is its name in messages.
    ///
    /// # Errors
    /// When the file is not valid WGSL, by its own lines; when it has no such function, or one that does not
    /// take two directions and f32 parameters and return f32 or vec3f; when the function needs what only
    /// its program could give it, such as a uniform or a texture.
    pub fn parse(file: impl Into<String>, source: impl Into<String>, entry: &str) -> Result<Self> {
        let (file, source) = (file.into(), source.into());
        let is_deep = limits::check_text(&source).map_err(|error| error.at(&file))?;
        limits::with_stack(is_deep, || Self::parse_text(file, source, entry, is_deep))
    }

    fn parse_text(file: String, source: String, entry: &str, is_deep: bool) -> Result<Self> {
        let module = naga::front::wgsl::parse_str(&source).map_err(|error| {
            let mut message = error.emit_to_string_with_path(&source, &file);
            if source.lines().any(|line| line.trim_start().starts_with('#')) {
                message += "plain WGSL has no lines that begin with #: run the engine's preprocessor first, or paste what is imported";
            }
            Error::input(format!("{file} is not valid WGSL:\n{}", message.trim_end()))
        })?;
        // What any device may lack is for the device to refuse.
        let info = Validator::new(ValidationFlags::all(), Capabilities::all()).validate(&module);
        let info = info.map_err(|error| {
            let message = error.emit_to_string_with_path(&source, &file);
            Error::input(format!("{file} is not valid WGSL:\n{}", message.trim_end()))
        })?;
        let (parameters, channels) = signature(&module, &info, entry).map_err(|error| error.at(&file))?;
        let named = |function: &Function| function.name.as_deref() == Some(entry);
        let handle = module.functions.iter().find(|(_, function)| named(function)).map(|(handle, _)| handle);
        let inlined = handle.map(|handle| Inlined::new(&module, handle)).transpose();
        let loops = inlined.map_err(|error| error.at(&file))?.is_some_and(|inlined| inlined.loops);
        let is_bound =
            |group| module.global_variables.iter().any(|(_, v)| v.binding.is_some_and(|b| b.group == group));
        let group = (0..GROUPS).find(|&group| !is_bound(group)).ok_or_else(|| {
            Error::input(format!("{file}: all of the groups 0 to 3 have bindings; leave one for the check"))
        })?;
        Ok(Self { file, source, entry: entry.into(), parameters, channels, loops, is_deep, group })
    }

    /// The names of its f32 parameters, after the directions.
    pub fn parameters(&self) -> &[String] {
        &self.parameters
    }

    /// Composes the module that runs the function, and counts the turns of its loops where a driver stops them.
    ///
    /// # Errors
    /// When the function does not stand in the module as it does in its file.
    pub(crate) fn compose(&self, loop_turns: Option<u32>) -> Result<Module> {
        // The prefix must not occur in the user's source.
        let mut prefix = String::from("gonio");
        while self.source.contains(&prefix) {
            prefix += "_x";
        }
        let Self { source, entry, group, channels, .. } = self;
        let certain = loop_turns.map_or(u32::MAX, limits::certain_turns);
        let arguments: String = (0..self.parameters.len())
            .map(|k| format!(", {prefix}_job.setting[{}][{}]", k / 4, k % 4))
            .collect();
        let vectors = self.parameters.len().div_ceil(4).max(1);
        let stores: String = match channels {
            1 => format!("{prefix}_values[k] = f;"),
            _ => (0..3).map(|c| format!("{prefix}_values[3u * k + {c}u] = f[{c}]; ")).collect(),
        };
        let text = format!(
            "{source}
struct {prefix}_Job {{ setting: array<vec4<f32>, {vectors}>, count: u32, cut: u32 }}
var<private> {prefix}_turns: u32;
@group({group}) @binding(0) var<uniform> {prefix}_job: {prefix}_Job;
@group({group}) @binding(1) var<storage, read> {prefix}_pairs: array<vec4<f32>>;
@group({group}) @binding(2) var<storage, read_write> {prefix}_values: array<f32>;
@compute @workgroup_size({WORKGROUP})
fn {prefix}_main(@builtin(global_invocation_id) id: vec3<u32>) {{
    let k = id.x;
    if (k >= {prefix}_job.count) {{ return; }}
    let f = {entry}({prefix}_pairs[2u * k].xyz, {prefix}_pairs[2u * k + 1u].xyz{arguments});
    {stores}
    if ({prefix}_turns > {certain}u) {{ {prefix}_values[{channels}u * k] = bitcast<f32>({prefix}_job.cut); }}
}}
"
        );
        let module = naga::front::wgsl::parse_str(&text);
        let mut module = module.map_err(|error| Error::input(error.emit_to_string(&text)))?;
        if loop_turns.is_some() {
            limits::count_turns(&mut module, &format!("{prefix}_turns"));
        }
        Ok(module)
    }

    /// Bytes of the uniform.
    fn job(&self, setting: &[f64], count: usize) -> Vec<u8> {
        let mut words: Vec<u32> = setting.iter().map(|&value| (value as f32).to_bits()).collect();
        words.resize(4 * self.parameters.len().div_ceil(4).max(1), 0);
        words.extend([count as u32, CUT, 0, 0]);
        bytemuck::cast_slice(&words).to_vec()
    }
}

/// The names of the parameters, and the channels, of a function that fits.
fn signature(module: &Module, info: &ModuleInfo, entry: &str) -> Result<(Vec<String>, usize)> {
    let found = module.functions.iter().find(|(_, function)| function.name.as_deref() == Some(entry));
    let (handle, function) = found.ok_or_else(|| missing(module, entry))?;
    let unfit = |what: String| {
        Error::input(format!("fn {entry}{} {what}; give a function {SHAPE}", show(module, function)))
    };
    let is = |ty, inner: TypeInner| module.types[ty].inner == inner;
    let (scalar, size) = (naga::Scalar::F32, VectorSize::Tri);
    let vector = TypeInner::Vector { size, scalar };

    let (directions, rest) = function.arguments.split_at(function.arguments.len().min(2));
    if directions.len() < 2 || directions.iter().any(|a| !is(a.ty, vector.clone())) {
        return Err(unfit("does not begin with two directions, wi and wo".into()));
    }
    let mut parameters = Vec::new();
    for (k, argument) in rest.iter().enumerate() {
        let name = argument.name.clone().unwrap_or_else(|| format!("argument{}", k + 3));
        if !is(argument.ty, TypeInner::Scalar(scalar)) {
            return Err(unfit(format!("has a parameter \"{name}\" that is no f32")));
        }
        parameters.push(name);
    }
    let channels = match function.result.as_ref().map(|result| &module.types[result.ty].inner) {
        Some(TypeInner::Scalar(s)) if *s == scalar => 1,
        Some(inner) if *inner == vector => 3,
        _ => return Err(unfit("does not return f32 or vec3f".into())),
    };

    // What its program would have to provide.
    let uses = &info[handle];
    if !uses.available_stages.contains(ShaderStages::COMPUTE) {
        return Err(unfit(
            "uses what only fragment shaders have, a derivative or an implicit level of detail".into(),
        ));
    }
    let bound = module.global_variables.iter().find(|(v, var)| var.binding.is_some() && !uses[*v].is_empty());
    if let Some((_, variable)) = bound {
        let name = variable.name.as_deref().unwrap_or("a binding");
        return Err(Error::input(format!(
            "fn {entry} reads `{name}`, which only its own program can fill; wrap it in a function that takes what it reads there as f32 parameters"
        )));
    }
    if let Some((_, over)) = module.overrides.iter().find(|(_, over)| over.init.is_none()) {
        let name = over.name.as_deref().unwrap_or("a constant");
        return Err(Error::input(format!(
            "override {name} has no value; give it one, as in `override {name} = 1.0;`"
        )));
    }
    Ok((parameters, channels))
}

fn missing(module: &Module, entry: &str) -> Error {
    if module.entry_points.iter().any(|point| point.name == entry) {
        return Error::input(format!(
            "{entry} is an entry point of a pipeline; name a function {SHAPE}, which it calls"
        ));
    }
    let names: Vec<_> =
        module.functions.iter().filter_map(|(_, function)| function.name.as_deref()).collect();
    Error::input(match names[..] {
        [] => format!("there is no function {entry}, nor any other"),
        _ => format!("there is no function {entry}; there are {}", names.join(", ")),
    })
}

/// A function's arguments and result, in WGSL.
fn show(module: &Module, function: &Function) -> String {
    let name = |ty: naga::Handle<naga::Type>| {
        let ty = &module.types[ty];
        let scalar = |s: naga::Scalar| match s.kind {
            ScalarKind::Float => format!("f{}", 8 * s.width),
            ScalarKind::Sint => format!("i{}", 8 * s.width),
            ScalarKind::Uint => format!("u{}", 8 * s.width),
            _ => "bool".into(),
        };
        match (&ty.name, &ty.inner) {
            (Some(name), _) => name.clone(),
            (None, TypeInner::Scalar(s)) => scalar(*s),
            (None, TypeInner::Vector { size, scalar: s }) => format!("vec{}<{}>", *size as u8, scalar(*s)),
            _ => "…".into(),
        }
    };
    let arguments: Vec<_> = function
        .arguments
        .iter()
        .map(|a| format!("{}: {}", a.name.as_deref().unwrap_or("_"), name(a.ty)))
        .collect();
    let result = function.result.as_ref().map_or(String::new(), |result| format!(" -> {}", name(result.ty)));
    format!("({}){result}", arguments.join(", "))
}

/// The directions of a pair as the function gets them: (x, y, z), n = +z, rounded to f32.
///
/// θ = π/2 is the horizon, z = 0. Where both are nearer to it than 2⁻²⁴ they are put there: f diverges, and a
/// half vector of opposite directions would be 0. So is ωi alone where the cosine is to be divided out. Beyond π/2 both
/// are on the horizon to the bit. A sine or cosine of an azimuth that is 0 but for the digits of π is 0, and opposite
/// azimuths are so to the bit.
pub fn directions(angles: &Angles, cosine: bool) -> [[f32; 3]; 2] {
    let (mut mu_i, mut mu_e) = (cos(angles.theta_i), cos(angles.theta_e));
    let is_exact = angles.theta_i > FRAC_PI_2 && angles.theta_e > FRAC_PI_2 && !cosine;
    if !is_exact && mu_i < MU_MIN && (mu_e < MU_MIN || cosine) {
        mu_i = MU_MIN;
        mu_e = if mu_e < MU_MIN { MU_MIN } else { mu_e };
    }
    let is_opposite = angles.delta_phi().abs() <= f64::EPSILON * (1.0 + angles.phi_e.abs());
    let phi_e = if is_opposite { angles.phi_i } else { angles.phi_e };
    let sign = if is_opposite { -1.0 } else { 1.0 };
    let without_dust = |x: f64| if x.abs() < f64::EPSILON { 0.0 } else { x };
    [(angles.theta_i, angles.phi_i, mu_i, 1.0), (angles.theta_e, phi_e, mu_e, sign)].map(
        |(theta, phi, mu, sign)| {
            let (sin, [sin_phi, cos_phi]) = (sign * theta.sin(), [phi.sin(), phi.cos()].map(without_dust));
            [sin * cos_phi, sin * sin_phi, mu].map(|x| x as f32 + 0.0) // no −0
        },
    )
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
    job: wgpu::Buffer,
    pairs: wgpu::Buffer,
    values: wgpu::Buffer,
    untouched: wgpu::Buffer,
    staging: wgpu::Buffer,
    /// Pairs in a dispatch, as many as the time allows; no result depends on it.
    batch: usize,
}

const WORKGROUP: usize = 64;
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
/// What a value is where the loops took more turns than every driver runs: another such NaN.
const CUT: u32 = 0xffc0_71ee;

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
        if !parameters.iter().map(|parameter| &parameter.name).eq(&function.parameters) {
            return Err(Error::input(format!(
                "{}: fn {} takes the parameters [{}], in this order",
                function.file,
                function.entry,
                function.parameters.join(", ")
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
        let size = LARGEST_BATCH * function.channels * 4;
        let job = buffer(function.job(&[], 0).len(), Usage::UNIFORM | Usage::COPY_DST);
        let pairs = buffer(LARGEST_BATCH * 32, Usage::STORAGE | Usage::COPY_DST);
        let values = buffer(size, Usage::STORAGE | Usage::COPY_DST | Usage::COPY_SRC);
        let staging = buffer(size, Usage::MAP_READ | Usage::COPY_DST);
        let pattern: Vec<u8> = UNTOUCHED.to_ne_bytes().repeat(size / 4);
        let untouched = device.baker().init(&pattern, Usage::COPY_SRC);
        let bindings = wgpu.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(function.group),
            entries: &[&job, &pairs, &values]
                .map(|buffer| buffer.as_entire_binding())
                .into_iter()
                .zip(0..)
                .map(|(resource, binding)| wgpu::BindGroupEntry { binding, resource })
                .collect::<Vec<_>>(),
        });
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
            job,
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
        let pairs: Vec<[[f32; 4]; 2]> = angles
            .par_iter()
            .with_min_len(512)
            .map(|angles| directions(angles, cosine).map(|[x, y, z]| [x, y, z, 0.0]))
            .collect();
        let bytes = (angles.len() * self.function.channels * 4) as u64;
        queue.write_buffer(&self.job, 0, &self.function.job(setting, angles.len()));
        queue.write_buffer(&self.pairs, 0, bytemuck::cast_slice(&pairs));
        let mut encoder = device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(&self.untouched, 0, &self.values, 0, bytes);
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(self.function.group, &self.bindings, &[]);
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
            for (values, pair) in out[first..].chunks_exact_mut(self.function.channels).zip(&pairs) {
                values.iter_mut().for_each(|value| *value /= pair[0][2]);
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
        format!("fn {} of {}", self.function.entry, self.function.file)
    }

    fn parameters(&self) -> &[ParameterRange] {
        &self.parameters
    }

    fn channels(&self) -> usize {
        self.function.channels
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
