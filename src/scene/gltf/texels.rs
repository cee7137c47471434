//! What a texture holds: roughness in G and metalness in B, or in other channels what extensions say, all of it linear.

use crate::scene::Distribution;
use crate::scene::gltf::ktx2;
use image::{DynamicImage, ImageReader, Limits};
use std::io::Cursor;

/// How often each level occurs. Texels that no geometry shows count too, and filtering a texture
/// never leaves the range of its texels: the ranges are never too narrow.
#[derive(Debug)]
pub struct Texels([Vec<u64>; 4]);

/// A channel of a texture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Channel {
    Red,
    Green,
    Blue,
    Alpha,
}

/// No texture of a real scene is larger; a decompression bomb is.
pub const MAX_SIDE: u32 = 1 << 14;

impl Texels {
    /// Decodes a PNG, a JPEG or the pixels of a KTX2; the error is the reason, for a message.
    pub fn decode(bytes: &[u8]) -> Result<Self, String> {
        if let Some(format) = undecodable(bytes) {
            return Err(format!("{format} is not decoded"));
        }
        if bytes.starts_with(KTX2) {
            return Self::of(&ktx2::decode(bytes)?);
        }
        let mut reader =
            ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|e| e.to_string())?;
        let mut limits = Limits::default(); // at most 512 MiB
        limits.max_image_width = Some(MAX_SIDE);
        limits.max_image_height = Some(MAX_SIDE);
        reader.limits(limits);
        Self::of(&reader.decode().map_err(|e| format!("cannot be decoded ({e})"))?)
    }

    fn of(image: &DynamicImage) -> Result<Self, String> {
        match image {
            DynamicImage::ImageLuma8(i) => Ok(Self::count(i, 1, [0, 0, 0])),
            DynamicImage::ImageLumaA8(i) => Ok(Self::count(i, 2, [0, 0, 0])),
            DynamicImage::ImageRgb8(i) => Ok(Self::count(i, 3, [0, 1, 2])),
            DynamicImage::ImageRgba8(i) => Ok(Self::count(i, 4, [0, 1, 2])),
            DynamicImage::ImageLuma16(i) => Ok(Self::count(i, 1, [0, 0, 0])),
            DynamicImage::ImageLumaA16(i) => Ok(Self::count(i, 2, [0, 0, 0])),
            DynamicImage::ImageRgb16(i) => Ok(Self::count(i, 3, [0, 1, 2])),
            DynamicImage::ImageRgba16(i) => Ok(Self::count(i, 4, [0, 1, 2])),
            _ => Err("its pixels are neither 8 nor 16 bit".into()),
        }
    }

    /// The roughness that `factor` makes of a channel.
    pub fn roughness(&self, channel: Channel, factor: f64) -> Distribution {
        let levels = levels(&self.0[channel as usize], factor).map(|(value, count)| (value, count as f64));
        Distribution::weighted(levels).unwrap_or(Distribution::constant(factor))
    }

    /// The least and greatest metalness that `factor` makes of the texels.
    pub fn metallic(&self, factor: f64) -> [f64; 2] {
        let mut values = levels(&self.0[Channel::Blue as usize], factor)
            .filter(|&(_, count)| count > 0)
            .map(|(value, _)| value);
        let first = values.next().unwrap_or(factor);
        [first, values.last().unwrap_or(first)]
    }

    /// Counts the levels of interleaved pixels, of whose channels these are R, G and B; A is the last of 2 or 4, else 1.
    fn count<T: Copy + Into<usize>>(pixels: &[T], channels: usize, rgb: [usize; 3]) -> Self {
        let levels: usize = 1 << (8 * size_of::<T>());
        let mut counts = std::array::from_fn(|_| vec![0; levels]);
        for pixel in pixels.chunks_exact(channels) {
            for (counts, k) in counts.iter_mut().zip(rgb) {
                counts[pixel[k].into()] += 1;
            }
            let alpha = if channels.is_multiple_of(2) { pixel[channels - 1].into() } else { levels - 1 };
            counts[3][alpha] += 1;
        }
        Self(counts)
    }
}

const KTX2: &[u8] = b"\xABKTX 20\xBB";

/// The value of each level, factor · k / (2ⁿ − 1), and its count.
fn levels(counts: &[u64], factor: f64) -> impl Iterator<Item = (f64, u64)> {
    let top = (counts.len() - 1) as f64;
    counts.iter().enumerate().map(move |(k, &count)| (factor * k as f64 / top, count))
}

/// The names of formats that glTF extensions allow and gonio does not decode, by their first bytes.
fn undecodable(bytes: &[u8]) -> Option<&'static str> {
    let is = |magic: &[u8], at: usize| bytes.get(at..).is_some_and(|rest| rest.starts_with(magic));
    if is(b"WEBP", 8) {
        Some("WebP")
    } else if is(b"ftypavif", 4) {
        Some("AVIF")
    } else if is(b"DDS ", 0) {
        Some("DDS")
    } else {
        None
    }
}
