//! Devices with fewer limits than ours, as engines open them: a table, points or light are right, or refused by an error.
//! Nothing panics, and the engine's own error handler hears nothing.

use crate::common::{engine, model};
use gonio::backend::gpu::{Baker, Device, INSTALL, TextureFormat};
use gonio::bake::{Evaluator, Unobserved};
use gonio::base::timings::Timings;
use gonio::check::Check;
use gonio::plan::TablePlan;
use gonio::table::axis::{Axis, Variable};
use gonio::table::quantity::{BRDF, RHO_DH, SPLIT_SUM};
use gonio::wgpu;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Every limit set, and what an engine would do on it.
#[test]
fn a_restricted_device_is_right_or_refuses() {
    let plain = wgpu::Limits::default();
    let cases: [(&str, wgpu::Limits); 9] = [
        ("WebGPU's", plain.clone()),
        ("downlevel", wgpu::Limits::downlevel_defaults()),
        ("WebGL's", wgpu::Limits::downlevel_webgl2_defaults()),
        ("32 invocations", wgpu::Limits { max_compute_invocations_per_workgroup: 32, ..plain.clone() }),
        ("two storage buffers", wgpu::Limits { max_storage_buffers_per_shader_stage: 2, ..plain.clone() }),
        ("bindings of 256 KiB", wgpu::Limits { max_storage_buffer_binding_size: 1 << 18, ..plain.clone() }),
        ("buffers of 1 MiB", wgpu::Limits { max_buffer_size: 1 << 20, ..plain.clone() }),
        ("uniforms of 4 KiB", wgpu::Limits { max_uniform_buffer_binding_size: 4096, ..plain.clone() }),
        ("256 workgroups", wgpu::Limits { max_compute_workgroups_per_dimension: 256, ..plain.clone() }),
    ];
    for (name, limits) in cases {
        let Some((device, queue)) = engine(limits) else { continue };
        let heard = hear(&device);
        let evaluator = Evaluator::Device(Box::new(Device::from_wgpu(&device, &queue)));
        for plan in plans() {
            let result = evaluator.bake(&plan, Check::Sample(8), &mut Timings::default(), &Unobserved);
            match result {
                Ok(table) => assert!(
                    table.error.measured_max.unwrap() <= plan.tolerance(),
                    "{name}, {}: {:?}",
                    plan.name(),
                    table.error
                ),
                Err(error) => {
                    assert!(matches!(error, gonio::Error::Device(_)), "{name}, {}: {error}", plan.name());
                }
            }
            record(&device, &queue, &plan);
        }
        assert_eq!(heard.load(Ordering::Relaxed), 0, "{name}");
    }
}

/// 2049² texels are more workgroups of 64 than a dimension of a dispatch takes.
#[test]
fn a_texture_of_four_million_texels_is_whole() {
    let Some((device, queue)) = engine(wgpu::Limits::default()) else { panic!("no device. {INSTALL}") };
    let heard = hear(&device);
    let axes = [Variable::Roughness, Variable::Mu].map(|variable| Axis::natural(variable, 2049).unwrap());
    let plan = TablePlan::basis("big", &SPLIT_SUM, model("ggx"), None, axes.into()).unwrap();
    let plan = plan.with_tolerance(0.1).unwrap();
    let baker = Baker::new(&device, &queue);
    let mut encoder = device.create_command_encoder(&Default::default());
    let texture = baker.record_texture(&mut encoder, &plan, TextureFormat::Rg32Float).unwrap();
    let pitch = (2049u32 * 8).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let staging = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(pitch) * 2049,
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(pitch), rows_per_image: None };
    let to = wgpu::TexelCopyBufferInfo { buffer: &staging, layout };
    encoder.copy_texture_to_buffer(texture.as_image_copy(), to, texture.size());
    queue.submit([encoder.finish()]);
    staging.map_async(wgpu::MapMode::Read, .., |result| result.unwrap());
    device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    let bytes = staging.get_mapped_range(..).unwrap().to_vec();
    let texel = |row: usize, column: usize| {
        let at = row * pitch as usize + column * 8;
        [0, 4].map(|k| f32::from_le_bytes(bytes[at + k..][..4].try_into().unwrap()))
    };
    // The last row is that of the largest roughness, whose light is neither none nor all.
    for (row, column) in [(0, 0), (1024, 2048), (2048, 0), (2048, 2048)] {
        let [a, b] = texel(row, column);
        assert!(a > 0.0 && a < 1.1 && b >= 0.0, "{row}, {column}: {a}, {b}");
    }
    assert_eq!(heard.load(Ordering::Relaxed), 0);
}

/// A device that is lost while tables are recorded is an error, or a recording that is never read.
#[test]
fn a_lost_device_is_no_panic() {
    let Some((device, queue)) = engine(wgpu::Limits::default()) else { panic!("no device. {INSTALL}") };
    let evaluator = Evaluator::Device(Box::new(Device::from_wgpu(&device, &queue)));
    device.destroy();
    for plan in plans() {
        let result = evaluator.bake(&plan, Check::Sample(0), &mut Timings::default(), &Unobserved);
        assert!(matches!(result, Err(gonio::Error::Device(_))), "{result:?}");
        let mut encoder = device.create_command_encoder(&Default::default());
        let _ = Baker::new(&device, &queue).record(&mut encoder, &plan);
    }
}

fn plans() -> Vec<TablePlan> {
    let axis = |variable, n| Axis::natural(variable, n).unwrap();
    let angles =
        || vec![axis(Variable::ThetaI, 33), axis(Variable::ThetaE, 65), axis(Variable::DeltaPhi, 129)];
    vec![
        TablePlan::basis(
            "dfg",
            &SPLIT_SUM,
            model("ggx"),
            None,
            vec![axis(Variable::Roughness, 128), axis(Variable::Mu, 128)],
        )
        .unwrap(),
        TablePlan::basis("values", &BRDF, model("ggx"), Some(0.3), angles()).unwrap(),
        TablePlan::basis("smooth", &RHO_DH, model("burley"), Some(0.5), vec![axis(Variable::ThetaI, 64)])
            .unwrap(),
    ]
}

/// Records a table as an engine does, and submits it if it is recorded.
fn record(device: &wgpu::Device, queue: &wgpu::Queue, plan: &TablePlan) {
    let baker = Baker::new(device, queue);
    let mut encoder = device.create_command_encoder(&Default::default());
    if baker.record(&mut encoder, plan).is_ok() {
        queue.submit([encoder.finish()]);
        device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    }
}

/// Counts what reaches the engine's error handler.
fn hear(device: &wgpu::Device) -> Arc<AtomicUsize> {
    let heard = Arc::new(AtomicUsize::new(0));
    let count = heard.clone();
    device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
        println!("heard: {error}");
        count.fetch_add(1, Ordering::Relaxed);
    }));
    heard
}
