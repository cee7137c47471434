//! Promises to an engine that embeds gonio: what it records into its own encoder, on its own device, is
//! what the headless bake reads back, as a buffer and as a texture of every format.

use crate::common::*;
use gonio::backend::gpu::{Baker, INSTALL, Recorded, TextureFormat};
use gonio::check::Check;
use gonio::model::lobe::Lobe;
use gonio::plan::TablePlan;
use gonio::table::axis::{Axis, Mapping, Positions, Variable};
use gonio::table::quantity::{BRDF, RHO_DH, RHO_HH, SPLIT_SUM};
use gonio::wgpu;

const FORMATS: [(TextureFormat, usize, bool); 4] = [
    (TextureFormat::Rg16Float, 2, true),
    (TextureFormat::Rgba16Float, 4, true),
    (TextureFormat::Rg32Float, 2, false),
    (TextureFormat::Rgba32Float, 4, false),
];

/// Every format of every table, recorded into one encoder and submitted once: floats are the headless
/// bake's bit for bit, halves are those rounded, a missing channel is 0 and a missing alpha 1.
#[test]
fn textures_hold_the_headless_tables() {
    let engine = Engine::open();
    let mut encoder = engine.encoder();
    let mut copies = Vec::new();
    for plan in tables() {
        for (format, channels, half) in FORMATS {
            if plan.channels().len() > channels || (half && plan.quantity() == &BRDF) {
                continue;
            }
            let texture = engine.baker.record_texture(&mut encoder, &plan, format).unwrap();
            let copy = engine.copy_texture(&mut encoder, &texture, channels * if half { 2 } else { 4 });
            copies.push((plan.clone(), format, channels, half, texture, copy));
        }
    }
    engine.queue.submit([encoder.finish()]);

    assert_eq!(copies.len(), 4 * 4 + 2 * 2 + 2);
    for (plan, format, channels, half, texture, copy) in copies {
        let table = bake(device(), &plan, Check::Sample(0));
        let (width, height) = table.image_size();
        assert_eq!((texture.width() as usize, texture.height() as usize), (width, height));
        let bytes = engine.read(&copy);
        let size = if half { 2 } else { 4 };
        let pitch = bytes.len() / height;
        for texel in 0..table.texels() {
            let at = texel / width * pitch + texel % width * channels * size;
            for c in 0..channels {
                let bytes = &bytes[at + c * size..][..size];
                let missing = if c == 3 { 1.0 } else { 0.0 };
                let expected = table.texel(texel).get(c).copied().unwrap_or(missing) as f32;
                let (equal, found) = match *bytes {
                    [a, b] => {
                        let found = half_to_f64(u16::from_le_bytes([a, b]));
                        (is_half_of(found, expected), found)
                    }
                    [a, b, c, d] => {
                        let found = f32::from_le_bytes([a, b, c, d]);
                        (found.to_bits() == expected.to_bits(), f64::from(found))
                    }
                    _ => unreachable!(),
                };
                let place = table.coordinates(texel);
                assert!(equal, "{plan}, {format:?}, channel {c}, {place}: {found} for {expected}");
            }
        }
    }
}

/// The buffer that `record` returns, its rows padded as `Recorded` says.
#[test]
fn buffers_hold_the_headless_tables() {
    let engine = Engine::open();
    let mut encoder = engine.encoder();
    let recorded: Vec<_> = tables()
        .into_iter()
        .map(|plan| {
            let recorded = engine.baker.record(&mut encoder, &plan).unwrap();
            let copy = engine.staging(recorded.buffer.size());
            encoder.copy_buffer_to_buffer(&recorded.buffer, 0, &copy, 0, copy.size());
            (plan, recorded, copy)
        })
        .collect();
    engine.queue.submit([encoder.finish()]);

    for (plan, Recorded { width, row, height, channels, .. }, copy) in recorded {
        let table = bake(device(), &plan, Check::Sample(0));
        assert_eq!(((width, height), channels), (table.image_size(), table.channels.len()), "{plan}");
        assert_eq!(row, if plan.quantity() == &BRDF { width.next_multiple_of(4) } else { width }, "{plan}");
        let bytes = engine.read(&copy);
        assert_eq!(bytes.len(), row * height * channels * 4, "{plan}");
        let values = bytes.chunks_exact(4).map(|b| u32::from_le_bytes(b.try_into().unwrap()));
        let kept = values.enumerate().filter(|(k, _)| k / channels % row < width).map(|(_, bits)| bits);
        assert!(kept.eq(table.values.to_f32().iter().map(|v| v.to_bits())), "{plan}");
    }
}

/// Recording the same plan again, with pipelines that are compiled already, gives the same texels.
#[test]
fn a_second_recording_is_the_first() {
    let engine = Engine::open();
    let plan = &tables()[0];
    let bytes = [(); 2].map(|()| {
        let mut encoder = engine.encoder();
        let texture = engine.baker.record_texture(&mut encoder, plan, TextureFormat::Rg32Float).unwrap();
        let copy = engine.copy_texture(&mut encoder, &texture, 8);
        engine.queue.submit([encoder.finish()]);
        engine.read(&copy)
    });
    assert_eq!(bytes[0], bytes[1]);
}

#[test]
fn what_a_format_cannot_hold_is_refused() {
    let engine = Engine::open();
    let refusal = |plan: &TablePlan, format| {
        engine.baker.record_texture(&mut engine.encoder(), plan, format).unwrap_err().to_string()
    };
    let three = &material();
    for format in [TextureFormat::Rg16Float, TextureFormat::Rg32Float] {
        assert_eq!(refusal(three, format), format!("table \"paint\": {format:?} has no room for 3 channels"),);
    }
    let values = &brdf(8);
    for format in [TextureFormat::Rg16Float, TextureFormat::Rgba16Float] {
        let says = refusal(values, format);
        assert!(says.contains("brdf") && says.contains("take a float format"), "{says}");
    }
    let limit = engine.device.limits().max_texture_dimension_2d as usize;
    let long = basis(&RHO_DH, model("lambert"), &[], vec![axis(Variable::ThetaI, limit + 1)]);
    let says = refusal(&long, TextureFormat::Rg32Float);
    assert!(says.contains(&(limit + 1).to_string()) && says.contains(&limit.to_string()), "{says}");
}

/// The comparer of halves takes both neighbours of a value's rounding, and nothing beyond them.
#[test]
fn halves_are_compared_to_their_last_bit() {
    for (bits, value) in [(0x3c00, 1.0), (1, 2f64.powi(-24)), (0x3555, 0.333_251_953_125), (0x7bfe, 65472.0)]
    {
        assert_eq!(half_to_f64(bits), value);
        assert!(is_half_of(half_to_f64(bits), value as f32));
        assert!(!is_half_of(half_to_f64(bits + 1), value as f32), "{value}");
    }
}

/// Tables of each shape that packing has to get right.
fn tables() -> Vec<TablePlan> {
    let ggx = model("ggx");
    let sqrt = Axis::new(Variable::Mu, 64, [0.0, 1.0], Positions::Nodes, Mapping::Sqrt).unwrap();
    let roughness: Vec<_> = (0..64).map(|k| f64::from(k) / 63.0).collect();
    vec![
        basis(&SPLIT_SUM, ggx, &roughness, vec![sqrt]),
        // Odd, and longer than a row of 256 bytes.
        basis(&SPLIT_SUM, ggx, &[0.0, 0.2, 1.0], vec![axis(Variable::Mu, 67)]),
        // One channel; no axis at all.
        basis(&RHO_DH, model("lambert"), &[], vec![axis(Variable::ThetaI, 5)]),
        basis(&RHO_HH, ggx, &[0.5], vec![]),
        // Rows of values are padded to quads in the buffer.
        brdf(7),
        material(),
        brdf(8),
    ]
}

fn brdf(azimuths: usize) -> TablePlan {
    let axes = [(Variable::ThetaI, 3), (Variable::ThetaE, 5), (Variable::DeltaPhi, azimuths)];
    basis(&BRDF, model("ggx"), &[0.1, 0.6], axes.map(|(variable, count)| axis(variable, count)).to_vec())
}

/// RGB of two lobes, the second added to the first.
fn material() -> TablePlan {
    let lobe = |name, roughness, weights: [[f64; 2]; 3]| {
        Lobe::new(model(name), roughness, weights.to_vec()).unwrap()
    };
    let channels = ["R", "G", "B"].map(String::from).to_vec();
    let lobes = vec![
        lobe("lambert", None, [[0.5, 0.0], [0.3, 0.0], [0.1, 0.0]]),
        lobe("ggx", Some(0.4), [[0.04, 0.1]; 3]),
    ];
    TablePlan::new("paint", &RHO_DH, "paint", channels, lobes, vec![axis(Variable::ThetaI, 9)]).unwrap()
}

/// The engine: a device of its own, on the adapter that headless bakes take.
struct Engine {
    device: wgpu::Device,
    queue: wgpu::Queue,
    baker: Baker,
}

impl Engine {
    fn open() -> Self {
        let Some((device, queue)) = engine(wgpu::Limits::default()) else {
            panic!("no device to test on. {INSTALL}")
        };
        Self { baker: Baker::new(&device, &queue), device, queue }
    }

    fn encoder(&self) -> wgpu::CommandEncoder {
        self.device.create_command_encoder(&Default::default())
    }

    fn staging(&self, size: u64) -> wgpu::Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        })
    }

    fn copy_texture(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        texture: &wgpu::Texture,
        texel: usize,
    ) -> wgpu::Buffer {
        let pitch = (texture.width() * texel as u32).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = self.staging(u64::from(pitch * texture.height()));
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(pitch), rows_per_image: None };
        let to = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
        encoder.copy_texture_to_buffer(texture.as_image_copy(), to, texture.size());
        buffer
    }

    fn read(&self, buffer: &wgpu::Buffer) -> Vec<u8> {
        buffer.map_async(wgpu::MapMode::Read, .., |result| result.unwrap());
        self.device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
        buffer.get_mapped_range(..).unwrap().to_vec()
    }
}

/// Whether a half is a float rounded to nearest: 2⁻¹¹ of it, or 2⁻²⁵ below the smallest normal half.
fn is_half_of(half: f64, value: f32) -> bool {
    let value = f64::from(value);
    (half - value).abs() <= (value * 2f64.powi(-11)).max(2f64.powi(-25))
}

/// The value of a finite, non-negative half.
fn half_to_f64(bits: u16) -> f64 {
    let (exponent, fraction) = (i32::from(bits >> 10), f64::from(bits & 0x3ff) / 1024.0);
    assert!(exponent < 31, "{bits:#x} is negative, infinite or NaN");
    if exponent == 0 { fraction * 2f64.powi(-14) } else { (1.0 + fraction) * 2f64.powi(exponent - 15) }
}
