//! An engine embeds gonio: a GGX split-sum (DFG) table baked as a texture on the engine's own device, in the
//! engine's own encoder, and sampled by the engine's next pass. The table never leaves the device.
//!
//!     cargo run --release --no-default-features --features vulkan --example embed [furnace.png]
//!
//! The picture is the white furnace one can see: a uniform environment of which a surface that loses
//! nothing must reflect exactly what it receives, and so vanish. Roughness runs from 0 to 1. Left halves
//! are GGX as it is, which loses what its microfacets would scatter again; right halves get that back by
//! the table. The first row is white, so its right halves cannot be told from the background, and the
//! program fails if they can.

use gonio::backend::gpu::{Baker, INSTALL, TextureFormat};
use gonio::plan::TablePlan;
use gonio::table::axis::{Axis, Mapping, Positions, Variable};
use gonio::table::quantity;
use gonio::{model, wgpu};
use image::{Rgba, RgbaImage};
use std::error::Error;

const COLUMNS: u32 = 11;
const ROWS: u32 = 3;
/// Pixels on a side of a sphere's cell: a row of an image is then a multiple of 256 bytes, as copies want.
const CELL: u32 = 128;
/// Radiance of the environment: below 1, so that a gain would show as well as a loss, and in sRGB exactly
/// level 225 of 255, so that it takes 0.5 % either way to be another one.
const ENVIRONMENT: f64 = 0.753;
const SIZE: wgpu::Extent3d =
    wgpu::Extent3d { width: COLUMNS * CELL, height: ROWS * CELL, depth_or_array_layers: 1 };

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args_os().nth(1).unwrap_or_else(|| "furnace.png".into());
    let (device, queue) = pollster::block_on(open())?;

    let mut encoder = device.create_command_encoder(&Default::default());
    let dfg = Baker::new(&device, &queue).record_texture(&mut encoder, &dfg()?, TextureFormat::Rg16Float)?;
    let target = draw(&device, &mut encoder, &dfg);
    let pixels = copy_out(&device, &mut encoder, &target);
    queue.submit([encoder.finish()]);

    let image = read(&device, &pixels)?;
    image.save(&path).map_err(|e| format!("{}: {e}", path.display()))?;
    println!("wrote {}", path.display());
    judge(&image)
}

/// The engine's device: a GPU if there is one, else software. gonio needs no feature and no raised limit.
async fn open() -> Result<(wgpu::Device, wgpu::Queue), Box<dyn Error>> {
    let instance = wgpu::Instance::default();
    let options = wgpu::RequestAdapterOptions {
        power_preference: wgpu::PowerPreference::HighPerformance,
        ..Default::default()
    };
    let adapter = instance.request_adapter(&options).await.map_err(|e| format!("{e}. {INSTALL}"))?;
    println!("on {}", adapter.get_info().name);
    Ok(adapter.request_device(&Default::default()).await?)
}

/// The table: A and B over μ (the texture's width) and roughness (its height). Both axes have samples at
/// both ends ("nodes"), and those of μ crowd towards grazing, where A and B bend most.
fn dfg() -> gonio::base::error::Result<TablePlan> {
    let roughness = Axis::new(Variable::Roughness, 64, [0.0, 1.0], Positions::Nodes, Mapping::Linear)?;
    let mu = Axis::new(Variable::Mu, 64, [0.0, 1.0], Positions::Nodes, Mapping::Sqrt)?;
    TablePlan::basis("dfg", &quantity::SPLIT_SUM, model::find("ggx")?, None, vec![roughness, mu])
}

/// Records the engine's pass: one triangle over everything, the spheres in the fragment shader.
fn draw(device: &wgpu::Device, encoder: &mut wgpu::CommandEncoder, dfg: &wgpu::Texture) -> wgpu::Texture {
    let format = wgpu::TextureFormat::Rgba8UnormSrgb;
    let target = device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: SIZE,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let module = device.create_shader_module(wgpu::include_wgsl!("embed/furnace.wgsl"));
    let constants = [("cell", CELL.into()), ("columns", COLUMNS.into()), ("environment", ENVIRONMENT)];
    let options = wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() };
    let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: None,
            compilation_options: options.clone(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: None,
            compilation_options: options,
            targets: &[Some(format.into())],
        }),
        multiview_mask: None,
        cache: None,
    });
    let bilinear = device.create_sampler(&wgpu::SamplerDescriptor {
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..Default::default()
    });
    let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[
            wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::TextureView(&dfg.create_view(&Default::default())),
            },
            wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(&bilinear) },
        ],
    });
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &target.create_view(&Default::default()),
            depth_slice: None,
            resolve_target: None,
            ops: Default::default(),
        })],
        ..Default::default()
    });
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &bind_group, &[]);
    pass.draw(0..3, 0..1);
    drop(pass);
    target
}

/// Records the copy of the finished image to where the host can read it.
fn copy_out(
    device: &wgpu::Device,
    encoder: &mut wgpu::CommandEncoder,
    target: &wgpu::Texture,
) -> wgpu::Buffer {
    let pixels = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(SIZE.width * SIZE.height * 4),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let layout =
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(SIZE.width * 4), rows_per_image: None };
    let to = wgpu::TexelCopyBufferInfo { buffer: &pixels, layout };
    encoder.copy_texture_to_buffer(target.as_image_copy(), to, SIZE);
    pixels
}

fn read(device: &wgpu::Device, pixels: &wgpu::Buffer) -> Result<RgbaImage, Box<dyn Error>> {
    // Should this fail, so does `get_mapped_range`.
    pixels.map_async(wgpu::MapMode::Read, .., |_| ());
    device.poll(wgpu::PollType::wait_indefinitely())?;
    let bytes = pixels.get_mapped_range(..)?.to_vec();
    RgbaImage::from_raw(SIZE.width, SIZE.height, bytes).ok_or_else(|| "the image has another size".into())
}

/// Holds the picture to what is known of it. The pass sums over directions by itself, to 0.3 %; a table, or a
/// way to sample it, that is off by more shows against the background.
fn judge(image: &RgbaImage) -> Result<(), Box<dyn Error>> {
    let off = |pixel: &Rgba<u8>, radiance: f64| pixel.0[0].abs_diff(srgb(radiance));
    let right = |&(x, y, _): &(u32, u32, &Rgba<u8>)| y < CELL && x % CELL >= CELL / 2;
    let background =
        image.enumerate_pixels().filter(right).map(|(_, _, pixel)| off(pixel, ENVIRONMENT)).max();
    let background = background.unwrap_or(u8::MAX);
    println!("white, compensated: at most {background} levels of 255 from the background (0 allowed)");

    // What vanishes must have been dark before, by as much as the closed form at μ = α = 1 says.
    let center = image.get_pixel((COLUMNS - 1) * CELL + CELL / 2 - 1, CELL / 2);
    let closed_form = off(center, ENVIRONMENT * (1.0 - 2_f64.ln()));
    println!("white, single scattering at μ = α = 1: {closed_form} levels from 1 − ln 2 (1 allowed)");
    if background > 0 || closed_form > 1 { Err("the furnace is not white".into()) } else { Ok(()) }
}

/// The level of a radiance in an sRGB image of 8 bits.
fn srgb(radiance: f64) -> u8 {
    (255.0 * (1.055 * radiance.powf(1.0 / 2.4) - 0.055)).round() as u8
}
