//! What it saves to compile only what is needed: the module of one model beside one module of the whole library,
//! which switches over its models at run time. `cargo run --release --example needed [-- MODEL [DEVICE]]`
//!
//! Drivers keep compiled shaders on disk; Mesa's cache is off with `MESA_SHADER_CACHE_DISABLE=true`.

use gonio::backend::gpu::{Device, DeviceChoice};
use gonio::base::precision::Precision;
use gonio::model;
use gonio::model::Model;
use gonio::shader::{Kernel, compose, validate};
use gonio::{Error, Result, wgpu};
use std::time::Instant;

const ROUNDS: usize = 3;

fn main() -> Result<()> {
    let mut args = std::env::args().skip(1);
    let model = model::find(&args.next().unwrap_or("ggx".into()))?;
    let choice = args.next().unwrap_or("auto".into()).parse().unwrap_or(DeviceChoice::Auto);
    let (device, line) = Device::choose(&choice)?;
    println!("{line}");
    let Some(opened) = device else { return Ok(()) };
    let (device, queue) = opened.wgpu();

    let library: Vec<_> = model::all().filter(|model| !model.is_delta()).collect();
    let texts = [
        (format!("{} alone", model.name), source(model)),
        (format!("all {} models in one", library.len()), all_in_one(&library)),
    ];
    println!("{:26} {:>9} {:>10}", "kernel of values", "bytes", "compile");
    let mut medians = Vec::new();
    for (what, text) in &texts {
        // What is not valid compiles in no time.
        validate(text, Precision::F32)?;
        let mut times: Vec<_> =
            (0..ROUNDS).map(|round| compile(device, queue, text, round)).collect::<Result<_>>()?;
        times.sort_by(f64::total_cmp);
        medians.push(times[ROUNDS / 2]);
        println!("{what:26} {:>9} {:>7.0} ms", text.len(), 1e3 * times[ROUNDS / 2]);
    }
    println!(
        "needed alone: {:.1} % of the bytes, {:.1} % of the time",
        100.0 * texts[0].1.len() as f64 / texts[1].1.len() as f64,
        100.0 * medians[0] / medians[1]
    );
    Ok(())
}

fn source(model: &Model) -> String {
    compose(Kernel::Points, Some(model), 3, Precision::F32)
}

/// What parts share that knows no model: once is enough.
const ELEMENTARY: &str = "with elementary";

/// The kernel with every model's parts under names of their own, and `lobe` a switch.
fn all_in_one(library: &[&Model]) -> String {
    let mut module = String::new();
    let (mut lobes, mut rows) = (String::new(), String::new());
    for (k, model) in library.iter().enumerate() {
        let text = source(model);
        let (shared, own): (Vec<&str>, Vec<&str>) = text.split("\n// ---- ").partition(|section| {
            let name = section.lines().next().unwrap_or_default();
            name == ELEMENTARY
                || !(name.starts_with("with ") || model.parts.iter().any(|part| part.name == name))
        });
        let own = own.iter().map(|section| format!("\n// ---- {section}")).collect::<String>();
        let elementary = shared.iter().find(|section| section.starts_with(ELEMENTARY));
        if k == 0 {
            module = shared.join("\n// ---- ");
        } else if let Some(section) = elementary.filter(|_| !module.contains(ELEMENTARY)) {
            module += &format!("\n// ---- {section}");
        }
        module += &renamed(&own, k);
        lobes += &format!("        case {k}u: {{ return lobe_{k}(p, a, alpha, row); }}\n");
        rows += &format!("        case {k}u: {{ return lobe_row_{k}(p, alpha); }}\n");
    }
    module += &format!(
        "fn lobe(p: Pair, a: Azimuth, alpha: real, row: real) -> real2 {{\n    switch job.tiles {{\n{lobes}        \
         default: {{ return real2(); }}\n    }}\n}}\nfn lobe_row(p: Pair, alpha: real) -> real {{\n    \
         switch job.tiles {{\n{rows}        default: {{ return 0.0; }}\n    }}\n}}\n"
    );
    module
}

/// What parts define, with a number behind each name.
fn renamed(text: &str, k: usize) -> String {
    let defined: Vec<_> = text
        .lines()
        .filter_map(|line| {
            ["fn ", "const ", "struct ", "alias "].iter().find_map(|kind| line.strip_prefix(kind))
        })
        .map(|rest| rest.split(|c: char| !is_word(c)).next().unwrap_or_default())
        .collect();
    let mut out = String::new();
    let mut rest = text;
    while let Some(start) = rest.find(is_word) {
        let end = rest[start..].find(|c: char| !is_word(c)).map_or(rest.len(), |length| start + length);
        let (before, word) = (&rest[..start], &rest[start..end]);
        out += before;
        out += word;
        // A member of a struct is no definition of a part.
        if defined.contains(&word) && !before.ends_with('.') {
            out += &format!("_{k}");
        }
        rest = &rest[end..];
    }
    out + rest
}

fn is_word(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

/// Seconds from text to the end of the first dispatch, which is when some drivers compile.
fn compile(device: &wgpu::Device, queue: &wgpu::Queue, text: &str, round: usize) -> Result<f64> {
    // No two rounds may be alike to a cache.
    let text = format!("{text}\nconst ROUND = {round}u;\n");
    let buffer = |size, usage| {
        device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
    };
    let job = buffer(256, wgpu::BufferUsages::UNIFORM);
    let storage = [0, 1].map(|_| buffer(1 << 16, wgpu::BufferUsages::STORAGE));
    let start = Instant::now();
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(text.into()),
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &module,
        entry_point: None,
        compilation_options: Default::default(),
        cache: None,
    });
    let entries = [&job, &storage[0], &storage[1]];
    let entries: Vec<_> = (0..)
        .zip(entries)
        .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
        .collect();
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &entries,
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.dispatch_workgroups(1, 1, 1);
    drop(pass);
    queue.submit([encoder.finish()]);
    device.poll(wgpu::PollType::wait_indefinitely()).map_err(|why| Error::Device(why.to_string()))?;
    Ok(start.elapsed().as_secs_f64())
}
