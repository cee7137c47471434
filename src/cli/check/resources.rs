//! Reads what `--bind` names: pictures for textures, words for samplers.

use crate::base::error::{Error, Result};
use crate::verify::user_shader::{ShaderResource, ShaderTexture, UserFunction};
use std::path::Path;

/// Binds `NAME=FILE` and `NAME=linear|nearest[-clamp|-repeat]`.
pub fn bind(function: &mut UserFunction, binds: &[String]) -> Result<()> {
    for bind in binds {
        let (name, value) = bind.split_once('=').ok_or_else(|| {
            Error::input(format!(
                "--bind {bind}: give NAME=FILE, or for a sampler NAME=linear or nearest-repeat"
            ))
        })?;
        let resource = match sampler(value) {
            Some(sampler) => Ok(sampler),
            None => picture(Path::new(value)).map(ShaderResource::Texture),
        };
        let bound = resource.and_then(|resource| function.bind(name, resource));
        bound.map_err(|error| error.at(format!("--bind {bind}")))?;
    }
    match function.unbound() {
        Some(name) => Err(Error::input(format!(
            "{} reads `{name}`; give --bind {name}=FILE for a texture (EXR, NPY, PNG, JPEG), or --bind {name}=linear for a \
             sampler",
            function.name()
        ))),
        None => Ok(()),
    }
}

fn sampler(text: &str) -> Option<ShaderResource> {
    let (filter, address) = text.split_once('-').unwrap_or((text, "clamp"));
    let linear = match filter {
        "linear" => true,
        "nearest" => false,
        _ => return None,
    };
    match address {
        "clamp" => Some(ShaderResource::Sampler { linear, repeat: false }),
        "repeat" => Some(ShaderResource::Sampler { linear, repeat: true }),
        _ => None,
    }
}

/// Reads a picture; values of PNG and JPEG are taken as they are, 0 to 1, without a transfer function.
fn picture(path: &Path) -> Result<ShaderTexture> {
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
    let fault = |why: String| Error::input(format!("{}: {why}", path.display()));
    let bytes = std::fs::read(path).map_err(Error::io("read", path))?;
    match extension.as_deref() {
        Some("exr") => exr(&bytes).map_err(fault),
        Some("npy") => npy(&bytes).map_err(fault),
        Some("png" | "jpg" | "jpeg") => {
            let image =
                image::load_from_memory(&bytes).map_err(|error| fault(error.to_string()))?.to_rgba32f();
            let (width, height) = image.dimensions();
            ShaderTexture::new(width, height, image.pixels().map(|pixel| pixel.0).collect())
        }
        _ => Err(fault("a texture is EXR, NPY, PNG or JPEG".into())),
    }
}

fn exr(bytes: &[u8]) -> Result<ShaderTexture, String> {
    use exr::prelude::*;
    let layer = read()
        .no_deep_data()
        .largest_resolution_level()
        .rgba_channels(
            |size, _| (size.width(), vec![[0.0_f32; 4]; size.area()]),
            |(width, texels), at, (r, g, b, a): (f32, f32, f32, f32)| {
                texels[at.y() * *width + at.x()] = [r, g, b, a]
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_buffered(std::io::Cursor::new(bytes));
    let image = layer.map_err(|error| error.to_string())?;
    let size = image.layer_data.size;
    let (_, texels) = image.layer_data.channel_data.pixels;
    ShaderTexture::new(size.width() as u32, size.height() as u32, texels).map_err(|error| error.to_string())
}

/// An array of (height, width) or (height, width, channels), in f32 or f64.
fn npy(bytes: &[u8]) -> Result<ShaderTexture, String> {
    let file = npyz::NpyFile::new(bytes).map_err(|error| error.to_string())?;
    let shape = file.shape().to_vec();
    let (height, width, channels) = match shape[..] {
        [height, width] => (height, width, 1),
        [height, width, channels @ 1..=4] => (height, width, channels),
        _ => {
            return Err(format!(
                "its shape is {shape:?}; a texture is (height, width) or (height, width, 1 to 4)"
            ));
        }
    };
    if file.order() == npyz::Order::Fortran {
        return Err("its order is Fortran's; save it in C order".into());
    }
    let is_double = matches!(file.dtype(), npyz::DType::Plain(kind) if kind.size_field() == 8);
    let values: Vec<f32> = match is_double {
        true => file.into_vec::<f64>().map(|values| values.into_iter().map(|x| x as f32).collect()),
        false => file.into_vec::<f32>(),
    }
    .map_err(|error| error.to_string())?;
    // Channels that are not there are 0, alpha is 1, as for a texture of fewer channels.
    let texel = |values: &[f32]| {
        let mut texel = [0.0, 0.0, 0.0, 1.0];
        texel[..values.len()].copy_from_slice(values);
        texel
    };
    let texels = values.chunks_exact(channels as usize).map(texel).collect();
    let [width, height] = [width, height].map(|size| u32::try_from(size).unwrap_or(0));
    ShaderTexture::new(width, height, texels).map_err(|error| error.to_string())
}
