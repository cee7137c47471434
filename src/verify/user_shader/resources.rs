//! Textures and samplers that a user's function reads.

use crate::base::error::{Error, Result};

/// The group of their bindings; the check's own is the one before.
pub(super) const RESOURCES: u32 = 1;

/// What a shader reads by a binding of its own.
#[derive(Debug, Clone)]
pub enum ShaderResource {
    /// A `texture_2d<f32>`.
    Texture(ShaderTexture),
    /// A `sampler`.
    Sampler {
        /// Whether it interpolates between texels.
        linear: bool,
        /// Whether coordinates outside [0, 1] wrap; else they are clamped.
        repeat: bool,
    },
}

/// A picture of one mip level, RGBA.
#[derive(Debug, Clone)]
pub struct ShaderTexture {
    width: u32,
    height: u32,
    texels: Vec<[f32; 4]>,
}

impl ShaderTexture {
    /// A picture whose texels come row by row, the first at (0, 0).
    ///
    /// # Errors
    /// When there are not width × height texels, or none.
    pub fn new(width: u32, height: u32, texels: Vec<[f32; 4]>) -> Result<Self> {
        match width > 0 && height > 0 && texels.len() == width as usize * height as usize {
            true => Ok(Self { width, height, texels }),
            false => {
                Err(Error::input(format!("{} texels are no picture of {width} × {height}", texels.len())))
            }
        }
    }
}

/// A binding that a function reaches, and what is bound to it.
#[derive(Debug, Clone)]
pub(super) struct Slot {
    pub name: String,
    pub is_sampler: bool,
    pub binding: u32,
    pub bound: Option<ShaderResource>,
}

impl Slot {
    /// Takes what fits.
    pub fn bind(&mut self, resource: ShaderResource) -> Result<()> {
        let (name, what) = (&self.name, if self.is_sampler { "a sampler" } else { "a texture" });
        if self.is_sampler != matches!(resource, ShaderResource::Sampler { .. }) {
            return Err(Error::input(format!("`{name}` is {what}")));
        }
        match self.bound.replace(resource) {
            Some(_) => Err(Error::input(format!("`{name}` is bound twice"))),
            None => Ok(()),
        }
    }
}

/// Puts resources on a device, for the layout of a pipeline.
pub(super) fn bind_group(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    layout: &wgpu::BindGroupLayout,
    slots: &[Slot],
) -> wgpu::BindGroup {
    enum Made {
        View(wgpu::TextureView),
        Sampler(wgpu::Sampler),
    }
    let made: Vec<_> = slots
        .iter()
        .filter_map(|slot| {
            let made = match slot.bound.as_ref()? {
                ShaderResource::Texture(picture) => Made::View(upload(device, queue, picture)),
                ShaderResource::Sampler { linear, repeat } => {
                    let address =
                        if *repeat { wgpu::AddressMode::Repeat } else { wgpu::AddressMode::ClampToEdge };
                    let filter = if *linear { wgpu::FilterMode::Linear } else { wgpu::FilterMode::Nearest };
                    Made::Sampler(device.create_sampler(&wgpu::SamplerDescriptor {
                        address_mode_u: address,
                        address_mode_v: address,
                        mag_filter: filter,
                        min_filter: filter,
                        ..Default::default()
                    }))
                }
            };
            Some((slot.binding, made))
        })
        .collect();
    let entries: Vec<_> = made
        .iter()
        .map(|(binding, made)| wgpu::BindGroupEntry {
            binding: *binding,
            resource: match made {
                Made::View(view) => wgpu::BindingResource::TextureView(view),
                Made::Sampler(sampler) => wgpu::BindingResource::Sampler(sampler),
            },
        })
        .collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
}

/// Whether a device interpolates between texels in f32; one that does not has them in f16.
pub(super) fn has_f32(device: &wgpu::Device) -> bool {
    device.features().contains(wgpu::Features::FLOAT32_FILTERABLE)
}

fn upload(device: &wgpu::Device, queue: &wgpu::Queue, picture: &ShaderTexture) -> wgpu::TextureView {
    let size = wgpu::Extent3d { width: picture.width, height: picture.height, depth_or_array_layers: 1 };
    let (format, bytes) = match has_f32(device) {
        true => (wgpu::TextureFormat::Rgba32Float, bytemuck::cast_slice(&picture.texels).to_vec()),
        false => {
            let halves =
                picture.texels.iter().flatten().flat_map(|&x| half::f16::from_f32(x).to_bits().to_ne_bytes());
            (wgpu::TextureFormat::Rgba16Float, halves.collect())
        }
    };
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let row = bytes.len() as u32 / picture.height;
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
    queue.write_texture(texture.as_image_copy(), &bytes, layout, size);
    texture.create_view(&Default::default())
}
