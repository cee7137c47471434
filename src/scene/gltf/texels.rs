//! What a texture holds: roughness in G and metalness in B, or in other channels what extensions say, all of it linear.
//!
//! A decoder that goes on behind damage makes a picture that nobody painted. So each format is checked to be whole, by its
//! own checksums or by the count of its data, before its texels are believed.

use crate::scene::Distribution;
use crate::scene::gltf::{jpeg, ktx2, png};
use image::{DynamicImage, ImageReader, Limits};
use std::io::Cursor;
use std::sync::{Mutex, PoisonError};

/// How often each level occurs in R, G, B and A. Texels that no geometry shows count too, and filtering a texture
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
const MAX_SIDE: u32 = 1 << 14;

/// Pictures of more texels are decoded one at a time.
const LARGE: u64 = 1 << 24;

/// Which of a texel's numbers R, G, B and A are; a channel that it has not is 0, and A 1.
type Sources = [Option<usize>; 4];

const GREY: Sources = [Some(0), Some(0), Some(0), None];
const GREY_ALPHA: Sources = [Some(0), Some(0), Some(0), Some(1)];
const RGB: Sources = [Some(0), Some(1), Some(2), None];
const RGBA: Sources = [Some(0), Some(1), Some(2), Some(3)];

impl Texels {
    /// Decodes a PNG, a JPEG or the pixels of a KTX2; the error is the reason, for a message.
    pub fn decode(bytes: &[u8]) -> Result<Self, String> {
        static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());
        if let Some(format) = undecodable(bytes) {
            return Err(format!("{format} is not decoded"));
        }
        if bytes.starts_with(ktx2::MAGIC) {
            return ktx2::decode(bytes);
        }
        let broken = |why: String| format!("cannot be decoded ({why})");
        if bytes.starts_with(png::MAGIC) {
            png::check(bytes).map_err(broken)?;
        } else if bytes.starts_with(jpeg::MAGIC) {
            jpeg::check(bytes).map_err(broken)?;
        }
        let reader = || ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|e| e.to_string());
        let size = reader()?.into_dimensions().map_err(|e| broken(e.to_string()))?;
        check_size(size.into())?;
        let large = u64::from(size.0) * u64::from(size.1) > LARGE;
        let _alone = large.then(|| ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner));
        let mut reader = reader()?;
        reader.limits(Limits::default()); // at most 512 MiB
        Self::of(&reader.decode().map_err(|e| broken(e.to_string()))?)
    }

    fn of(image: &DynamicImage) -> Result<Self, String> {
        let mut texels =
            Self::none(image.color().bits_per_pixel() > 8 * u16::from(image.color().channel_count()));
        match image {
            DynamicImage::ImageLuma8(i) => texels.add(i, 1, GREY),
            DynamicImage::ImageLumaA8(i) => texels.add(i, 2, GREY_ALPHA),
            DynamicImage::ImageRgb8(i) => texels.add(i, 3, RGB),
            DynamicImage::ImageRgba8(i) => texels.add(i, 4, RGBA),
            DynamicImage::ImageLuma16(i) => texels.add(i, 1, GREY),
            DynamicImage::ImageLumaA16(i) => texels.add(i, 2, GREY_ALPHA),
            DynamicImage::ImageRgb16(i) => texels.add(i, 3, RGB),
            DynamicImage::ImageRgba16(i) => texels.add(i, 4, RGBA),
            _ => return Err("its pixels are neither 8 nor 16 bit".into()),
        }
        Ok(texels)
    }

    /// No texels yet, of 8 or 16 bits a channel.
    pub fn none(is_deep: bool) -> Self {
        Self(std::array::from_fn(|_| vec![0; 1 << if is_deep { 16 } else { 8 }]))
    }

    /// Counts pixels of so many interleaved channels, two bytes each where the texels are deep.
    pub fn add_bytes(&mut self, bytes: &[u8], channels: usize, sources: Sources) {
        if self.0[0].len() == 256 {
            return self.add(bytes, channels, sources);
        }
        let pairs = bytes.chunks_exact(2).map(|pair| u16::from_le_bytes([pair[0], pair[1]]));
        self.add(&pairs.collect::<Vec<_>>(), channels, sources);
    }

    fn add<T: Copy + Into<usize>>(&mut self, pixels: &[T], channels: usize, sources: Sources) {
        let top = self.0[0].len() - 1;
        for (k, (counts, source)) in self.0.iter_mut().zip(sources).enumerate() {
            match source {
                Some(source) => {
                    for pixel in pixels.chunks_exact(channels) {
                        counts[pixel[source].into()] += 1;
                    }
                }
                None => {
                    counts[if k == Channel::Alpha as usize { top } else { 0 }] +=
                        (pixels.len() / channels) as u64
                }
            }
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
}

/// Refuses pictures that are larger than any of a real scene.
pub fn check_size([width, height]: [u32; 2]) -> Result<(), String> {
    if width > MAX_SIDE || height > MAX_SIDE {
        return Err(format!("it has {width} × {height} texels, and {MAX_SIDE} a side are the most"));
    }
    Ok(())
}

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
