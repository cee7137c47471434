//! KTX2 that is no more than pixels: one picture of 8 or 16 bits a channel, linear, as it is or in Zstandard. What is
//! compressed for GPUs (Basis Universal, BC, ASTC) is not decoded.

use crate::scene::gltf::texels::{Texels, check_size};
use ktx2::{Format, Header, LevelIndex, SupercompressionScheme};
use ruzstd::decoding::StreamingDecoder;
use std::io::Read;

pub const MAGIC: &[u8] = b"\xABKTX 20\xBB";

/// Counts the texels of the finest level. A channel that the file has not is 0, and A 1, as samplers have it.
pub fn decode(bytes: &[u8]) -> Result<Texels, String> {
    let broken = |why: &str| format!("this KTX2 cannot be decoded ({why})");
    let short = || broken("it ends early");
    let header = Header::from_bytes(bytes.first_chunk().ok_or_else(short)?);
    let header = header.map_err(|e| broken(&e.to_string()))?;
    if header.supercompression_scheme == Some(SupercompressionScheme::BasisLZ) || header.format.is_none() {
        return Err("KTX2 is not decoded where it is in Basis Universal".into());
    }
    let Some((channels, is_deep)) = header.format.and_then(layout) else {
        let format = header.format.map_or_else(String::new, |format| format!("{format:?}"));
        return Err(format!("KTX2 is not decoded where its format is {format}"));
    };
    let (width, height) = (header.pixel_width, header.pixel_height.max(1));
    check_size([width, height])?;
    if header.pixel_depth > 1 || header.layer_count > 1 || header.face_count != 1 {
        return Err("KTX2 is not decoded where it is more than one picture".into());
    }
    let index = header.index;
    let descriptor = range(bytes, index.dfd_byte_offset.into(), index.dfd_byte_length.into());
    if !descriptor.is_some_and(is_linear) {
        return Err(broken("its data format descriptor is not that of linear pixels"));
    }
    let level = bytes.get(Header::LENGTH..).and_then(<[u8]>::first_chunk).ok_or_else(short)?;
    let level = LevelIndex::from_bytes(level);
    let data = range(bytes, level.byte_offset, level.byte_length).ok_or_else(short)?;
    // The finest level comes last; buffers may be padded.
    if bytes.len() as u64 - level.byte_offset - level.byte_length > MAX_PADDING {
        return Err(broken("there are other bytes behind its picture"));
    }
    let depth = if is_deep { 2 } else { 1 };
    let size = u64::from(width) * u64::from(height) * channels.len() as u64 * depth;
    let sources = [0, 1, 2, 3].map(|k| channels.iter().position(|&channel| channel == k));
    let mut texels = Texels::none(is_deep);
    let wrong = |length: u64| format!("this KTX2 is broken: {length} bytes of texels in place of {size}");
    match header.supercompression_scheme {
        None if data.len() as u64 != size => return Err(wrong(data.len() as u64)),
        None => texels.add_bytes(data, channels.len(), sources),
        Some(SupercompressionScheme::Zstandard) => {
            let mut decoder = StreamingDecoder::new(data).map_err(|e| broken(&e.to_string()))?;
            let mut left = size;
            let mut piece = Vec::new();
            // Piece by piece, and no more than there should be: a bomb takes no memory.
            loop {
                piece.clear();
                let wanted = left.clamp(1, PIECE);
                let read = decoder.by_ref().take(wanted).read_to_end(&mut piece);
                let read = read.map_err(|e| broken(&e.to_string()))? as u64;
                if read == 0 && left == 0 {
                    break;
                }
                left = left.checked_sub(wanted).filter(|_| read == wanted).ok_or_else(|| match left {
                    0 => format!("this KTX2 is broken: it has more than {size} bytes of texels"),
                    left => wrong(size - left + read),
                })?;
                texels.add_bytes(&piece, channels.len(), sources);
            }
            let checksum = decoder.decoder.get_checksum_from_data();
            if checksum.is_some() && checksum != decoder.decoder.get_calculated_checksum() {
                return Err(broken("its checksum does not fit"));
            }
        }
        Some(scheme) => return Err(format!("KTX2 is not decoded where it is in {scheme:?}")),
    }
    Ok(texels)
}

/// The most bytes behind the picture.
const MAX_PADDING: u64 = 15;

/// A multiple of the bytes of every texel: 1, 2, 3, 4, 6 or 8.
const PIECE: u64 = 24 << 12;

fn range(bytes: &[u8], offset: u64, length: u64) -> Option<&[u8]> {
    let start = usize::try_from(offset).ok()?;
    bytes.get(start..start.checked_add(usize::try_from(length).ok()?)?)
}

/// Whether a basic data format descriptor (Khronos Data Format 1.3) is of single texels, RGB, and linear.
fn is_linear(descriptor: &[u8]) -> bool {
    const RGBSDA: u8 = 1;
    const LINEAR: u8 = 1;
    let [a, b, c, d, 0, 0, 0, 0, 2, 0, _, _, RGBSDA, _, LINEAR, _, 0, 0, 0, 0, ..] = *descriptor else {
        return false;
    };
    u32::from_le_bytes([a, b, c, d]) as usize == descriptor.len()
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
