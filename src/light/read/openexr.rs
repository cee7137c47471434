//! Reads OpenEXR maps. The crate `exr` decodes; all that a header claims is checked before memory is taken for it.

use crate::base::error::{Error, Result};
use crate::light::environment::check_size;
use crate::light::read::MapPicture;
use exr::block::{self, UncompressedBlock, reader::ChunksReader};
use exr::compression::Compression;
use exr::error::Error as Fault;
use exr::math::Vec2;
use exr::meta::BlockDescription;
use exr::meta::attribute::{EnvironmentMap, IntegerBounds, SampleType};
use exr::meta::header::Header;
use half::f16;
use std::io::{Read, Seek};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Bytes of a block of pixels at most, which is decoded at once. The decoder needs some four times as much beside the map.
const MAX_BLOCK: usize = 1 << 26;
/// The same where runs are decoded, which damaged files can make 64 times as long.
const MAX_RUNS: usize = 1 << 23;
/// Channels of a part at most.
const MAX_CHANNELS: usize = 1024;
/// Channels that a message names.
const NAMED: usize = 40;

/// Reads a map. A panic of the decoder, whose sums for a damaged block of B44 may overflow where that is checked, is an error.
pub(super) fn read(file: impl Read + Seek) -> Result<MapPicture> {
    catch_unwind(AssertUnwindSafe(|| decode(file))).unwrap_or_else(|_| {
        Err(Error::input("not a whole OpenEXR file (its decoder stopped); write the map again"))
    })
}

fn decode(file: impl Read + Seek) -> Result<MapPicture> {
    let reader = block::read(file, false).map_err(explain)?;
    let headers = reader.headers();
    headers.iter().try_for_each(check_part)?;
    let layer = picture(headers)?;
    let header = headers[layer.part].clone();
    check_kind(&header)?;
    let (data, display) = (header.data_window(), header.shared_attributes.display_window);
    let (width, height) = (display.size.width(), display.size.height());
    let notes = windows(data, display)?;
    let mut texels = vec![[0.0f32; 3]; width * height];

    // What is outside of the data window is 0, and data outside of the display window are no part of the picture.
    let to_display = [0, 1].map(|k| i64::from(origin(data)[k]) - i64::from(origin(display)[k]));
    let within = |position: usize, k: usize| {
        let at = i64::try_from(position).ok()? + to_display[k];
        usize::try_from(at).ok().filter(|&at| at < [width, height][k])
    };
    let mut put = |block: &UncompressedBlock| {
        for line in block.lines(&header.channels) {
            let at = line.location;
            let Some(row) = within(at.position.y(), 1) else { continue };
            let kind = header.channels.list[at.channel].sample_type;
            for (k, sample) in line.value.chunks_exact(kind.bytes_per_sample()).enumerate() {
                let Some(column) = within(at.position.x() + k, 0) else { continue };
                let value = number(kind, sample);
                for (channel, texel) in layer.channels.iter().zip(&mut texels[row * width + column]) {
                    if *channel == at.channel {
                        *texel = value;
                    }
                }
            }
        }
    };
    // Each block has a place of its own: as many as there must be, and no two at one.
    let mut is_taken = vec![false; data.size.area()];
    let chunks = reader.filter_chunks(true, |_, tile, block| {
        block.layer == layer.part && tile.is_largest_resolution_level()
    });
    chunks
        .and_then(|chunks| {
            chunks.decompress_sequential(false, |_, block| {
                let Vec2(x, y) = block.index.pixel_position;
                let place = is_taken.get_mut(y * data.size.width() + x);
                let is_right = block.index.layer == layer.part && block.index.level == Vec2(0, 0);
                if !is_right || place.is_none_or(|taken| std::mem::replace(taken, true)) {
                    return Err(Fault::Invalid("two blocks at one place".into()));
                }
                put(&block);
                Ok(())
            })
        })
        .map_err(explain)?;
    Ok(MapPicture { width, height, texels, notes })
}

fn explain(fault: Fault) -> Error {
    Error::input(match fault {
        Fault::NotSupported(what) => {
            format!(
                "OpenEXR of a kind that is not read: {what}; write the map as scanlines with ZIP compression"
            )
        }
        Fault::Io(why) => why.to_string(),
        Fault::Invalid(why) => format!("not a whole OpenEXR file ({why}); write the map again"),
        Fault::Aborted => "reading was stopped".into(),
    })
}

// ---- What a header claims --------------------------------------------------------------------------

/// Refuses a part of the file, whether it is the map or not, that would take much memory.
fn check_part(header: &Header) -> Result<()> {
    let display = header.shared_attributes.display_window;
    for size in [header.layer_size, display.size] {
        check_size(size.width(), size.height())?;
    }
    let channels = header.channels.list.len();
    if channels > MAX_CHANNELS {
        return Err(Error::input(format!(
            "a part of {channels} channels, more than the {MAX_CHANNELS} that are read; write R, G and B alone"
        )));
    }
    let pixels = match header.blocks {
        BlockDescription::Tiles(tiles) => tiles.tile_size.width().checked_mul(tiles.tile_size.height()),
        BlockDescription::ScanLines => {
            header.layer_size.width().checked_mul(header.compression.scan_lines_per_block())
        }
    };
    let bytes = pixels.and_then(|pixels| pixels.checked_mul(header.channels.bytes_per_pixel));
    let most = if header.compression == Compression::RLE { MAX_RUNS } else { MAX_BLOCK };
    match bytes {
        Some(bytes) if bytes <= most => Ok(()),
        _ => Err(Error::input(format!(
            "its blocks of pixels have more than the {most} bytes that are decoded at once; write the map as scanlines \
             with ZIP compression"
        ))),
    }
}

/// Refuses a map of another kind than latitude and longitude, or that is not decoded safely.
fn check_kind(header: &Header) -> Result<()> {
    if header.own_attributes.environment_map == Some(EnvironmentMap::Cube) {
        return Err(Error::input(
            "it is a cube map (envmap = cube); convert it to latitude and longitude, as by OpenEXR's exrenvmap -l",
        ));
    }
    if let Compression::DWAA(_) | Compression::DWAB(_) = header.compression {
        return Err(Error::input(
            "its compression is DWAA or DWAB, which is not read, as a damaged file could end the program; write the map \
             with ZIP or PIZ compression",
        ));
    }
    if header.channels.list.iter().any(|channel| channel.sampling != Vec2(1, 1)) {
        return Err(Error::input(format!(
            "some channels have fewer samples than others, which is not read; write R, G and B at each pixel; {}",
            listed(std::slice::from_ref(header))
        )));
    }
    Ok(())
}

fn origin(window: IntegerBounds) -> [i32; 2] {
    [window.position.x(), window.position.y()]
}

/// Notes windows that differ.
fn windows(data: IntegerBounds, display: IntegerBounds) -> Result<Vec<String>> {
    if data == display {
        return Ok(Vec::new());
    }
    let words = |window: IntegerBounds| {
        let [x, y] = origin(window);
        format!("{} × {} at ({x}, {y})", window.size.width(), window.size.height())
    };
    let (data_words, display_words) = (words(data), words(display));
    let overlap = |k: usize| {
        let ends = |window: IntegerBounds| {
            let from = i64::from(origin(window)[k]);
            [from, from + [window.size.width(), window.size.height()][k] as i64]
        };
        let ([a, b], [c, d]) = (ends(data), ends(display));
        a.max(c) < b.min(d)
    };
    if !overlap(0) || !overlap(1) {
        return Err(Error::input(format!(
            "its data window, {data_words}, has no pixel in its display window, {display_words}; write the map again"
        )));
    }
    Ok(vec![format!(
        "its data window is {data_words}, its display window {display_words}: the map is the latter, and 0 where there are \
         no data"
    )])
}

// ---- Channels --------------------------------------------------------------------------------------

/// The channels that are a map's R, G and B.
struct Layer {
    part: usize,
    /// What precedes their names: "ViewLayer.Combined.".
    prefix: String,
    channels: [usize; 3],
}

/// The layer that is the map: the only one with R, G and B, or the only one of these without a prefix, which is OpenEXR's
/// name of the picture itself. In a file without R, G and B it is the only one with a luminance Y, which is grey.
fn picture(headers: &[Header]) -> Result<Layer> {
    let mut found = layers(headers, ["R", "G", "B"]);
    let is_colour = !found.is_empty();
    if !is_colour {
        found = layers(headers, ["Y", "Y", "Y"]);
        // With X and Z it is a vector, with RY and BY only part of a colour.
        found.retain(|layer| {
            let names = names(&headers[layer.part]);
            !["X", "RY", "BY"].iter().any(|name| names.contains(&format!("{}{name}", layer.prefix)))
        });
    }
    let plain = |layer: &Layer| layer.prefix.is_empty();
    if found.len() > 1 && found.iter().filter(|layer| plain(layer)).count() == 1 {
        found.retain(plain);
    }
    match <[Layer; 1]>::try_from(found) {
        Ok([layer]) => Ok(layer),
        Err(found) => {
            let what = match (is_colour, found.len()) {
                (_, 0) => "no layer with R, G and B, nor a luminance Y alone".into(),
                (true, n) => format!("{n} layers with R, G and B"),
                (false, n) => format!("{n} layers with a luminance Y"),
            };
            Err(Error::input(format!(
                "it has {what}; write the one that is the map alone; {}",
                listed(headers)
            )))
        }
    }
}

fn layers(headers: &[Header], wanted: [&str; 3]) -> Vec<Layer> {
    let of_part = |(part, header): (usize, &Header)| {
        let names = names(header);
        let first = |name: &String| {
            let prefix = name.strip_suffix(wanted[0])?;
            (prefix.is_empty() || prefix.ends_with('.')).then(|| prefix.to_owned())
        };
        let layer = |prefix: String| {
            let find = |wanted: &str| names.iter().position(|name| *name == format!("{prefix}{wanted}"));
            let [r, g, b] = wanted.map(find);
            Some(Layer { part, channels: [r?, g?, b?], prefix })
        };
        names.iter().filter_map(first).filter_map(layer).collect::<Vec<_>>()
    };
    headers.iter().enumerate().flat_map(of_part).collect()
}

fn names(header: &Header) -> Vec<String> {
    header.channels.list.iter().map(|channel| channel.name.to_string()).collect()
}

/// "its channels are A, B, R".
fn listed(headers: &[Header]) -> String {
    let of_part = |header: &Header| {
        let part = header.own_attributes.layer_name.as_ref().filter(|_| headers.len() > 1);
        let part = part.map_or(String::new(), |name| format!("{name}: "));
        names(header)
            .into_iter()
            .map(move |name| format!("{part}{name}").escape_debug().to_string())
            .collect::<Vec<_>>()
    };
    let all: Vec<_> = headers.iter().flat_map(of_part).collect();
    let more = if all.len() > NAMED { format!(" and {} more", all.len() - NAMED) } else { String::new() };
    format!("its channels are {}{more}", all[..all.len().min(NAMED)].join(", "))
}

fn number(kind: SampleType, bytes: &[u8]) -> f32 {
    let four = || bytes.try_into().unwrap_or_default();
    match kind {
        SampleType::F16 => f16::from_ne_bytes(bytes.try_into().unwrap_or_default()).to_f32(),
        SampleType::F32 => f32::from_ne_bytes(four()),
        SampleType::U32 => u32::from_ne_bytes(four()) as f32,
    }
}
