//! Bakes a table into a texture, without leaving the device.

use crate::backend::gpu::baker::{Baker, DispatchStep, Recorded, count};
use crate::base::error::{Error, Result};
use crate::base::precision::Precision;
use crate::plan::TablePlan;
use crate::shader::Kernel;
use crate::table::ErrorKind;
use bytemuck::{Pod, Zeroable};

/// The formats that a table can be a texture in: two or four channels, halves or floats.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TextureFormat {
    /// Two halves; filterable everywhere. Rounds by up to 2.4e-4 below 1.
    Rg16Float,
    /// Four halves.
    Rgba16Float,
    /// Two floats; filterable only with `FLOAT32_FILTERABLE`.
    Rg32Float,
    /// Four floats.
    Rgba32Float,
}

impl TextureFormat {
    fn wgpu(self) -> wgpu::TextureFormat {
        match self {
            Self::Rg16Float => wgpu::TextureFormat::Rg16Float,
            Self::Rgba16Float => wgpu::TextureFormat::Rgba16Float,
            Self::Rg32Float => wgpu::TextureFormat::Rg32Float,
            Self::Rgba32Float => wgpu::TextureFormat::Rgba32Float,
        }
    }

    fn is_half(self) -> bool {
        matches!(self, Self::Rg16Float | Self::Rgba16Float)
    }

    fn channels(self) -> usize {
        if matches!(self, Self::Rg16Float | Self::Rg32Float) { 2 } else { 4 }
    }
}

/// The uniforms of the packing kernel: `Packing` of `shaders/kernel/pack.wgsl`.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Packing {
    width: u32,
    texels: u32,
    channels: u32,
    row: u32,
    words: u32,
    pitch: u32,
    half: u32,
    pad: u32,
}

impl Baker {
    /// Records the baking of `table` into `encoder` and returns the texture that will hold it: width
    /// is the last axis, height the product of the others, row 0 the first value. Channels that the
    /// table lacks are 0, alpha 1. Does not submit, read back or block.
    ///
    /// # Errors
    /// When the table does not fit a texture of the device, or does not fit the format.
    pub fn record_texture(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        table: &TablePlan,
        format: TextureFormat,
    ) -> Result<wgpu::Texture> {
        let refuse = |why: String| Err(Error::Device(format!("table \"{}\": {why}", table.name())));
        if table.channels().len() > format.channels() {
            return refuse(format!("{format:?} has no room for {} channels", table.channels().len()));
        }
        if format.is_half() && table.quantity().error == ErrorKind::Relative {
            return refuse(format!(
                "values of {} leave the range of halves; take a float format",
                table.quantity().name
            ));
        }
        let width = table.axes().last().map_or(1, |axis| axis.len());
        let size = [width, table.texels() / width].map(|n| u32::try_from(n).unwrap_or(u32::MAX));
        let limit = self.device.limits().max_texture_dimension_2d;
        if size[0].max(size[1]) > limit {
            return refuse(format!("{} × {} texels; the device's textures end at {limit}", size[0], size[1]));
        }
        let prepared = self.prepare(table)?;
        // Nothing is recorded before all buffers and pipelines are there.
        let texture = self.scoped(|| self.texture(&prepared.recorded, size, format))?;
        prepared.encode(encoder);
        texture.encode(encoder);
        Ok(texture.texture)
    }

    /// Makes the texture of a recorded table, and what copies it there.
    fn texture(
        &self,
        recorded: &Recorded,
        [width, height]: [u32; 2],
        format: TextureFormat,
    ) -> Result<PackedTexture> {
        let words = format.channels() as u32 / if format.is_half() { 2 } else { 1 };
        let pitch = (width * words * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let packing = Packing {
            width,
            texels: width * height,
            channels: recorded.channels as u32,
            row: (recorded.row * recorded.channels) as u32,
            words,
            pitch: pitch / 4,
            half: u32::from(format.is_half()),
            pad: 0,
        };
        let packing = self.init(bytemuck::bytes_of(&packing), wgpu::BufferUsages::UNIFORM);
        let texels = self.output(pitch as usize * height as usize);
        let pipeline = self.pipeline(Kernel::Pack, None, 0, Precision::F32)?;
        let buffers = [&packing, &recorded.buffer, &texels];
        let bind_group = self.bind(&pipeline, buffers.map(wgpu::Buffer::as_entire_binding));
        // More workgroups than a dimension takes stand in rows.
        let all = (width * height).div_ceil(64);
        let across = all.min(count(self.max_workgroups())?);
        let step =
            DispatchStep { pipeline, bind_group, workgroups: [across, all.div_ceil(across)], evaluations: 0 };
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
        let texture = self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("gonio table"),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: format.wgpu(),
            usage: wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_DST
                | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        Ok(PackedTexture { step, texels, pitch, texture })
    }
}

/// A texture, and the dispatch and the copy that fill it.
struct PackedTexture {
    step: DispatchStep,
    /// The rows of texels as a copy wants them.
    texels: wgpu::Buffer,
    /// The bytes from one row to the next.
    pitch: u32,
    texture: wgpu::Texture,
}

impl PackedTexture {
    fn encode(&self, encoder: &mut wgpu::CommandEncoder) {
        self.step.encode(encoder);
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(self.pitch), rows_per_image: None };
        encoder.copy_buffer_to_texture(
            wgpu::TexelCopyBufferInfo { buffer: &self.texels, layout },
            self.texture.as_image_copy(),
            self.texture.size(),
        );
    }
}
