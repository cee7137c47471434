//! KTX2 that is no more than pixels: one picture of 8 or 16 bits a channel, linear, as it is or in Zstandard. What is
//! compressed for GPUs (Basis Universal, BC, ASTC) is not decoded.

use crate::scene::gltf::texels::MAX_SIDE;
use image::{DynamicImage, ImageBuffer};
use ktx2::{Format, Reader, SupercompressionScheme};
use std::io::Read;

/// The picture's finest level, in R, G, B and A: a channel that the file has not is 0, and A 1, as samplers have it.
pub fn decode(bytes: &[u8]) -> Result<DynamicImage, String> {
    let reader = Reader::new(bytes).map_err(|e| format!("this KTX2 cannot be decoded ({e})"))?;
    let header = reader.header();
    if header.supercompression_scheme == Some(SupercompressionScheme::BasisLZ) || header.format.is_none() {
        return Err("KTX2 is not decoded where it is in Basis Universal".into());
    }
    let Some((order, is_deep)) = header.format.and_then(layout) else {
        let format = header.format.map_or_else(String::new, |format| format!("{format:?}"));
        return Err(format!("KTX2 is not decoded where its format is {format}"));
    };
    let (width, height) = (header.pixel_width, header.pixel_height.max(1));
    if width > MAX_SIDE || height > MAX_SIDE {
        return Err(format!("it has {width} × {height} texels, and {MAX_SIDE} a side are the most"));
    }
    if header.pixel_depth > 1 || header.layer_count > 1 || header.face_count != 1 {
        return Err("KTX2 is not decoded where it is more than one picture".into());
    }
    let level = reader.levels().next().ok_or("this KTX2 has no picture")?;
    let size = u64::from(width) * u64::from(height) * order.len() as u64 * if is_deep { 2 } else { 1 };
    let data = match header.supercompression_scheme {
        None => level.data.to_vec(),
        Some(SupercompressionScheme::Zstandard) => zstandard(level.data, size)?,
        Some(scheme) => return Err(format!("KTX2 is not decoded where it is in {scheme:?}")),
    };
    if data.len() as u64 != size {
        return Err(format!("this KTX2 is broken: {} bytes of texels in place of {size}", data.len()));
    }
    let broken = || "this KTX2 is broken: its texels do not fill it".to_string();
    if is_deep {
        let texels: Vec<_> =
            data.chunks_exact(2).map(|pair| u16::from_le_bytes([pair[0], pair[1]])).collect();
        let image = ImageBuffer::from_vec(width, height, four(&texels, order, u16::MAX));
        return image.map(DynamicImage::ImageRgba16).ok_or_else(broken);
    }
    ImageBuffer::from_vec(width, height, four(&data, order, u8::MAX))
        .map(DynamicImage::ImageRgba8)
        .ok_or_else(broken)
}

/// Which of R, G, B and A its channels are, and whether they have 16 bits.
fn layout(format: Format) -> Option<(&'static [usize], bool)> {
    Some(match format {
        Format::R8_UNORM => (&[0], false),
        Format::R8G8_UNORM => (&[0, 1], false),
        Format::R8G8B8_UNORM => (&[0, 1, 2], false),
        Format::B8G8R8_UNORM => (&[2, 1, 0], false),
        Format::R8G8B8A8_UNORM => (&[0, 1, 2, 3], false),
        Format::B8G8R8A8_UNORM => (&[2, 1, 0, 3], false),
        Format::R16_UNORM => (&[0], true),
        Format::R16G16_UNORM => (&[0, 1], true),
        Format::R16G16B16_UNORM => (&[0, 1, 2], true),
        Format::R16G16B16A16_UNORM => (&[0, 1, 2, 3], true),
        _ => return None,
    })
}

fn four<T: Copy + Default>(texels: &[T], order: &[usize], one: T) -> Vec<T> {
    let four = |texel: &[T]| {
        let mut four = [T::default(), T::default(), T::default(), one];
        order.iter().zip(texel).for_each(|(&k, &value)| four[k] = value);
        four
    };
    texels.chunks_exact(order.len()).flat_map(four).collect()
}

/// No more than one byte beyond what there should be: a bomb stops there.
fn zstandard(data: &[u8], size: u64) -> Result<Vec<u8>, String> {
    let broken = |e: String| format!("this KTX2 cannot be decoded ({e})");
    let decoder = ruzstd::decoding::StreamingDecoder::new(data).map_err(|e| broken(e.to_string()))?;
    let mut texels = Vec::new();
    decoder.take(size + 1).read_to_end(&mut texels).map_err(|e| broken(e.to_string()))?;
    Ok(texels)
}
