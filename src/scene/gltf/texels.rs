//! What a metallic-roughness texture holds: roughness in G, metalness in B, both linear.

use crate::scene::Distribution;
use image::{DynamicImage, ImageReader, Limits};
use std::io::Cursor;

/// How often each level occurs. Texels that no geometry shows count too, and filtering a texture
/// never leaves the range of its texels: the ranges are never too narrow.
#[derive(Debug)]
pub struct Texels {
    green: Vec<u64>,
    blue: Vec<u64>,
}

/// No texture of a real scene is larger; a decompression bomb is.
const MAX_SIDE: u32 = 1 << 14;

impl Texels {
    /// Decodes a PNG or a JPEG; the error is the reason, for a message.
    pub fn decode(bytes: &[u8]) -> Result<Self, String> {
        if let Some(format) = undecodable(bytes) {
            return Err(format!("{format} is not decoded"));
        }
        let mut reader =
            ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|e| e.to_string())?;
        let mut limits = Limits::default(); // at most 512 MiB
        limits.max_image_width = Some(MAX_SIDE);
        limits.max_image_height = Some(MAX_SIDE);
        reader.limits(limits);
        match reader.decode().map_err(|e| format!("cannot be decoded ({e})"))? {
            DynamicImage::ImageLuma8(i) => Self::count(&i, 1, [0, 0]),
            DynamicImage::ImageLumaA8(i) => Self::count(&i, 2, [0, 0]),
            DynamicImage::ImageRgb8(i) => Self::count(&i, 3, [1, 2]),
            DynamicImage::ImageRgba8(i) => Self::count(&i, 4, [1, 2]),
            DynamicImage::ImageLuma16(i) => Self::count(&i, 1, [0, 0]),
            DynamicImage::ImageLumaA16(i) => Self::count(&i, 2, [0, 0]),
            DynamicImage::ImageRgb16(i) => Self::count(&i, 3, [1, 2]),
            DynamicImage::ImageRgba16(i) => Self::count(&i, 4, [1, 2]),
            _ => Err("its pixels are neither 8 nor 16 bit".into()),
        }
    }

    /// The roughness that `factor` makes of the texels.
    pub fn roughness(&self, factor: f64) -> Distribution {
        let levels = levels(&self.green, factor).map(|(value, count)| (value, count as f64));
        Distribution::weighted(levels).unwrap_or(Distribution::constant(factor))
    }

    /// The least and greatest metalness that `factor` makes of the texels.
    pub fn metallic(&self, factor: f64) -> [f64; 2] {
        let mut values = levels(&self.blue, factor).filter(|&(_, count)| count > 0).map(|(value, _)| value);
        let first = values.next().unwrap_or(factor);
        [first, values.last().unwrap_or(first)]
    }

    /// Counts channels `green` and `blue` of interleaved pixels.
    fn count<T: Copy + Into<usize>>(
        pixels: &[T],
        channels: usize,
        [green, blue]: [usize; 2],
    ) -> Result<Self, String> {
        let levels = 1 << (8 * size_of::<T>());
        let mut texels = Self { green: vec![0; levels], blue: vec![0; levels] };
        for pixel in pixels.chunks_exact(channels) {
            texels.green[pixel[green].into()] += 1;
            texels.blue[pixel[blue].into()] += 1;
        }
        Ok(texels)
    }
}

/// The value of each level, factor · k / (2ⁿ − 1), and its count.
fn levels(counts: &[u64], factor: f64) -> impl Iterator<Item = (f64, u64)> {
    let top = (counts.len() - 1) as f64;
    counts.iter().enumerate().map(move |(k, &count)| (factor * k as f64 / top, count))
}

/// The names of formats that glTF extensions allow and gonio does not decode, by their first bytes.
fn undecodable(bytes: &[u8]) -> Option<&'static str> {
    let is = |magic: &[u8], at: usize| bytes.get(at..).is_some_and(|rest| rest.starts_with(magic));
    if is(b"\xABKTX 20\xBB", 0) {
        Some("KTX2")
    } else if is(b"WEBP", 8) {
        Some("WebP")
    } else if is(b"ftypavif", 4) {
        Some("AVIF")
    } else if is(b"DDS ", 0) {
        Some("DDS")
    } else {
        None
    }
}
