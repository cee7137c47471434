//! How fast values are written: a GGX RGB table of 64 × 256 × 512 beside a plain fill of the same bytes in
//! the same layout, warm, in one run. `cargo run --release --example fill [-- DEVICE]`

use gonio::backend::gpu::{Baker, Device, DeviceChoice, Prepared};
use gonio::model::lobe::Lobe;
use gonio::plan::TablePlan;
use gonio::table::axis::{Axis, Variable};
use gonio::table::quantity;
use gonio::{model, wgpu};
use std::time::Instant;

const SHAPE: [usize; 3] = [64, 256, 512];
const ROUNDS: usize = 31;

/// Each invocation writes `each` vectors: side by side (three of them as the value kernel does), or a whole
/// dispatch apart.
const FILL: &str = "
@group(0) @binding(0) var<storage, read_write> values: array<VECTOR>;
@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * WORKGROUPu;
    let all = groups.x * groups.y * WORKGROUPu;
    let v = VECTOR(NUMBERS);
    STORES
}";

fn main() -> gonio::Result<()> {
    let choice = std::env::args().nth(1).unwrap_or("auto".into()).parse().unwrap_or(DeviceChoice::Auto);
    let (device, line) = Device::choose(&choice)?;
    println!("{line}");
    let Some(opened) = device else { return Ok(()) };
    let (device, queue) = opened.wgpu();
    let baker = Baker::new(device, queue);

    let prepared = baker.prepare(&table()?)?;
    let bytes = prepared.recorded.buffer.size();
    let texels: usize = SHAPE.iter().product();
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: bytes,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let mut runs = vec![("GGX RGB values".to_owned(), Run::Values(prepared))];
    for workgroup in [64, 128, 256] {
        for (each, apart) in [(1, false), (3, false), (4, false), (4, true)] {
            let how = if apart { "apart" } else { "side by side" };
            let fill = Fill::new(device, &buffer, workgroup, each, apart, false);
            runs.push((format!("fill, workgroup {workgroup}, {each} vec4 {how}"), Run::Fill(fill)));
        }
    }
    // The value kernel stores so where the device has such words.
    if device.features().contains(wgpu::Features::SHADER_INT64) {
        let fill = Fill::new(device, &buffer, 256, 3, false, true);
        runs.push(("fill, workgroup 256, words of 64 bits".into(), Run::Fill(fill)));
    }

    // In turns, as the machine may have more than one speed.
    let first: Vec<_> = runs.iter().map(|(_, run)| run.time(device, queue)).collect();
    let rounds: Vec<Vec<f64>> =
        (0..ROUNDS).map(|_| runs.iter().map(|(_, run)| run.time(device, queue)).collect()).collect();
    println!("{bytes} bytes, {ROUNDS} rounds; ms");
    println!("{:40} {:>8} {:>8} {:>8} {:>8}", "", "first", "min", "median", "GB/s");
    let times = |k: usize| sorted(rounds.iter().map(|round| round[k]).collect());
    for (k, (what, _)) in runs.iter().enumerate() {
        let (times, ms) = (times(k), 1e3);
        let (min, median) = (times[0], times[ROUNDS / 2]);
        let rate = bytes as f64 / median / 1e9;
        println!("{what:40} {:8.2} {:8.2} {:8.2} {rate:8.2}", ms * first[k], ms * min, ms * median);
    }
    let median = |k: usize| times(k)[ROUNDS / 2];
    println!("{:.0} M RGB values/s", texels as f64 / median(0) / 1e6);
    let named = |name: &str| (1..runs.len()).filter(|&k| runs[k].0.contains(name)).collect::<Vec<_>>();
    for (what, fills) in [
        ("the best plain fill", named("vec4")),
        ("the best plain fill in the same layout", named("3 vec4 side by side")),
        ("the fill by words of 64 bits", named("words")),
    ] {
        let Some(best) = fills.into_iter().min_by(|&a, &b| median(a).total_cmp(&median(b))) else { continue };
        let shares = sorted(rounds.iter().map(|round| round[best] / round[0]).collect());
        let [low, middle, high] = [ROUNDS / 4, ROUNDS / 2, 3 * ROUNDS / 4].map(|k| 100.0 * shares[k]);
        println!("{middle:.0} % of {what}; quartiles of the rounds {low:.0} and {high:.0} %");
    }
    Ok(())
}

fn sorted(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values
}

/// 64 θi × 256 θe × 512 δφ of a gold-like lobe.
fn table() -> gonio::Result<TablePlan> {
    let variables = [Variable::ThetaI, Variable::ThetaE, Variable::DeltaPhi];
    let axes =
        variables.into_iter().zip(SHAPE).map(|(v, n)| Axis::natural(v, n)).collect::<gonio::Result<_>>()?;
    let ggx = model::find("ggx")?;
    let weights = [1.0, 0.78, 0.34].map(|f0| [f0, 1.0]).to_vec();
    let lobe = Lobe::new(ggx, Some(0.5), weights)?;
    let channels = ["R", "G", "B"].map(String::from).to_vec();
    TablePlan::new("values", &quantity::BRDF, "gold", channels, vec![lobe], axes)
}

/// What is timed.
enum Run {
    Values(Prepared),
    Fill(Fill),
}

impl Run {
    /// Seconds of submit and wait.
    fn time(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> f64 {
        let mut encoder = device.create_command_encoder(&Default::default());
        match self {
            Self::Values(prepared) => prepared.encode(&mut encoder),
            Self::Fill(fill) => fill.encode(&mut encoder),
        }
        let start = Instant::now();
        queue.submit([encoder.finish()]);
        let _ = device.poll(wgpu::PollType::wait_indefinitely());
        start.elapsed().as_secs_f64()
    }
}

struct Fill {
    pipeline: wgpu::ComputePipeline,
    bind_group: wgpu::BindGroup,
    workgroups: [u32; 2],
}

impl Fill {
    fn new(
        device: &wgpu::Device,
        buffer: &wgpu::Buffer,
        workgroup: u64,
        each: u64,
        apart: bool,
        wide: bool,
    ) -> Self {
        let store = |k: u64| match apart {
            true => format!("values[i + {k}u * all] = v;"),
            false => format!("values[{each}u * i + {k}u] = v;"),
        };
        let stores: String = (0..each).map(store).collect();
        let source = FILL.replace("WORKGROUP", &workgroup.to_string()).replace("STORES", &stores);
        let (vector, numbers) = match wide {
            true => ("vec2<u64>", "u64(i) | (u64(i) << 32u), u64(i)"),
            false => ("vec4f", "f32(i), 1.0, 2.0, 3.0"),
        };
        let source = source.replace("VECTOR", vector).replace("NUMBERS", numbers);
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: None,
            module: &module,
            entry_point: None,
            compilation_options: Default::default(),
            cache: None,
        });
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: buffer.as_entire_binding() }],
        });
        let groups = buffer.size() / 16 / each / workgroup;
        // Powers of two times three: whole rows within what a dimension holds.
        let rows = groups.div_ceil(65_535).next_power_of_two();
        Self { pipeline, bind_group, workgroups: [(groups / rows) as u32, rows as u32] }
    }

    fn encode(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bind_group, &[]);
        pass.dispatch_workgroups(self.workgroups[0], self.workgroups[1], 1);
    }
}
