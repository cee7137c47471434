//! Reading environment maps: OpenEXR and Radiance HDR.

use crate::base::error::{Error, Result};
use crate::light::environment::{Clamped, Environment, check_size};
use exr::meta::MetaData;
use exr::prelude::{ReadChannels, ReadLayers, read as exr_read};
use image::ImageDecoder;
use image::codecs::hdr::HdrDecoder;
use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::path::Path;

/// The largest file that is opened: twice the size of 2²⁵ uncompressed texels.
const MAX_BYTES: u64 = 1 << 30;

/// OpenEXR, "OpenEXR File Layout": the magic number.
const EXR: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// What to do with a map that has texels which are no radiance: negative, infinite or NaN.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InvalidTexels<'a> {
    /// Refuse the map. The message offers to correct it, or this remedy of the caller's: "clamp it".
    Refuse {
        /// The end of "mend the map, or …".
        remedy: &'a str,
    },
    /// Replace them as [`Environment::clamped`] does, and count them.
    Clamp,
}

/// Reads an environment map in latitude and longitude. Its first bytes, not its name, tell OpenEXR from Radiance HDR.
///
/// # Errors
/// When the file is not such a map, is cut short, has too many texels, or texels that are no radiance.
pub fn read(path: &Path, invalid: InvalidTexels) -> Result<(Environment, Clamped)> {
    read_texels(path)
        .and_then(|(width, height, texels)| match invalid {
            InvalidTexels::Clamp => Environment::clamped(width, height, texels),
            InvalidTexels::Refuse { remedy } => {
                let map = Environment::checked(width, height, texels, remedy)?;
                Ok((map, Clamped::default()))
            }
        })
        .map_err(|error| error.at(path.display()))
}

type Texels = (usize, usize, Vec<[f32; 3]>);

fn read_texels(path: &Path) -> Result<Texels> {
    let mut file = File::open(path).map_err(Error::io("read", path))?;
    let bytes = file.metadata().map_err(Error::io("read", path))?.len();
    if bytes > MAX_BYTES {
        return Err(Error::input(format!("{bytes} bytes, more than the {MAX_BYTES} that are read")));
    }
    let mut head = Vec::new();
    file.by_ref().take(4).read_to_end(&mut head).map_err(Error::io("read", path))?;
    file.rewind().map_err(Error::io("read", path))?;
    let file = BufReader::new(file);
    match head[..] {
        [] => Err(Error::input("it is empty; give an OpenEXR or a Radiance HDR map")),
        _ if head == EXR => read_exr(file),
        [b'#', b'?', ..] => read_hdr(file),
        _ => Err(Error::input("neither OpenEXR nor Radiance HDR; give a map in one of these")),
    }
}

fn read_exr(mut file: BufReader<File>) -> Result<Texels> {
    let fault = |why: exr::error::Error| {
        Error::input(format!(
            "not a whole OpenEXR file ({why}); write the map again as scanlines with R, G and B"
        ))
    };
    // The size is checked before memory is reserved for it.
    let headers = MetaData::read_from_buffered(&mut file, false).map_err(fault)?.headers;
    if let Some(size) = headers.first().map(|header| header.layer_size) {
        check_size(size.width(), size.height())?;
    }
    file.rewind().map_err(|why| Error::input(why.to_string()))?;
    let image = exr_read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| (size.width(), vec![[0.0f32; 3]; size.area()]),
            |(width, texels): &mut (usize, Vec<[f32; 3]>), at, (r, g, b): (f32, f32, f32)| {
                texels[at.y() * *width + at.x()] = [r, g, b];
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_buffered(file)
        .map_err(fault)?;
    let size = image.layer_data.size;
    let (_, texels) = image.layer_data.channel_data.pixels;
    Ok((size.width(), size.height(), texels))
}

fn read_hdr(file: BufReader<File>) -> Result<Texels> {
    let fault = |why: image::ImageError| {
        Error::input(format!("not a whole Radiance HDR file ({why}); write the map again"))
    };
    let decoder = HdrDecoder::new(file).map_err(fault)?;
    let [width, height] = <[u32; 2]>::from(decoder.dimensions()).map(|n| n as usize);
    check_size(width, height)?;
    let pixels = image::DynamicImage::from_decoder(decoder).map_err(fault)?.into_rgb32f().into_raw();
    Ok((width, height, pixels.as_chunks().0.to_vec()))
}
