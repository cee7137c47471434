//! Environment maps mean what their files say, or are refused with the reason: windows, layers, compression, exposures,
//! orientations; and no bytes make reading panic. `GONIO_MUTATIONS` makes more of them.

use exr::image::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, Layers};
use exr::math::Vec2;
use exr::meta::attribute::{EnvironmentMap, IntegerBounds, LineOrder};
use exr::prelude::{Blocks, Compression, LayerAttributes, WritableImage, f16};
use gonio::light::{InvalidTexels, MapFile, read};
use std::io::Cursor;

const WHOLE: [usize; 2] = [16, 8];

/// Bytes as a file, read.
fn map(bytes: &[u8]) -> Result<MapFile, String> {
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), bytes).unwrap();
    read(file.path(), InvalidTexels::Clamp).map_err(|why| why.to_string())
}

fn refused(bytes: &[u8], what: &[&str]) {
    let why = map(bytes).unwrap_err();
    assert!(what.iter().all(|what| why.contains(what)), "{why}");
}

type Part = Layer<AnyChannels<FlatSamples>>;

/// A part with some channels; the sample at (x, y) of channel k is 1000 k + 100 y + x, counted from `origin`.
fn part(names: &[&str], [width, height]: [usize; 2], [x0, y0]: [i32; 2], compression: Compression) -> Part {
    let channel = |(k, name): (usize, &&str)| {
        let sample = |i: usize| {
            let [x, y] = [(i % width) as f32 + x0 as f32, (i / width) as f32 + y0 as f32];
            1000.0 * k as f32 + 100.0 * y + x
        };
        AnyChannel::new(*name, FlatSamples::F32((0..width * height).map(sample).collect()))
    };
    let channels = AnyChannels::sort(names.iter().enumerate().map(channel).collect());
    let encoding = Encoding { compression, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
    let mut part = Layer::new((width, height), LayerAttributes::named("main"), encoding, channels);
    part.attributes.layer_position = Vec2(x0, y0);
    part
}

fn exr(parts: Vec<Part>) -> Vec<u8> {
    let mut image = Image::from_layer(parts[0].clone());
    image.attributes.display_window = IntegerBounds::new((0, 0), (WHOLE[0], WHOLE[1]));
    let image = Image { attributes: image.attributes, layer_data: Layers::from(parts) };
    let mut bytes = Cursor::new(Vec::new());
    image.write().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

fn plain(compression: Compression) -> Vec<u8> {
    exr(vec![part(&["R", "G", "B"], WHOLE, [0, 0], compression)])
}

#[test]
fn a_map_is_its_display_window() {
    let whole = map(&plain(Compression::ZIP16)).unwrap();
    assert_eq!((whole.map.texel(3, 5), whole.notes.len()), ([305.0, 1305.0, 2305.0], 0));
    for (size, origin) in [([5, 4], [3, 2]), ([20, 3], [-2, 6]), ([16, 8], [4, -3]), ([40, 40], [-7, -9])] {
        let cropped = map(&exr(vec![part(&["R", "G", "B"], size, origin, Compression::RLE)])).unwrap();
        assert_eq!([cropped.map.width(), cropped.map.height()], WHOLE);
        assert!(cropped.notes[0].contains("data window"), "{:?}", cropped.notes);
        for (row, column) in (0..WHOLE[1]).flat_map(|row| (0..WHOLE[0]).map(move |column| (row, column))) {
            let within = |at: usize, k: usize| (0..size[k] as i32).contains(&(at as i32 - origin[k]));
            let truth =
                if within(column, 0) && within(row, 1) { whole.map.texel(row, column) } else { [0.0; 3] };
            assert_eq!(cropped.map.texel(row, column), truth, "{size:?} at {origin:?}: {row}, {column}");
        }
    }
    refused(
        &exr(vec![part(&["R", "G", "B"], [4, 4], [16, 0], Compression::RLE)]),
        &["no pixel", "4 × 4 at (16, 0)"],
    );
}

#[test]
fn the_layer_that_is_the_map_is_found_or_all_are_listed() {
    let of = |names: &[&str]| map(&exr(vec![part(names, WHOLE, [0, 0], Compression::ZIP1)]));
    let first = |names: &[&str]| of(names).unwrap().map.texel(0, 1);
    assert_eq!(first(&["Y"]), [1.0; 3]);
    assert_eq!(first(&["A", "Y", "Z"]), [1001.0; 3]);
    let blender = ["V.Combined.R", "V.Combined.G", "V.Combined.B", "V.Combined.A", "V.Depth.Z"];
    assert_eq!(first(&blender), [1.0, 1001.0, 2001.0]);
    assert_eq!(first(&["a.R", "a.G", "a.B", "R", "G", "B"]), [3001.0, 4001.0, 5001.0]);
    let why = |names: &[&str]| of(names).unwrap_err();
    for names in
        [&["a.R", "a.G", "a.B", "b.R", "b.G", "b.B"][..], &["Y", "RY", "BY"], &["X", "Y", "Z"], &["R", "G"]]
    {
        let why = why(names);
        assert!(names.iter().all(|name| why.contains(name)) && !why.contains("whole"), "{why}");
    }
    let mut other = part(&["R", "G", "B"], [2, 2], [0, 0], Compression::ZIP1);
    other.attributes.layer_name = Some("other".into());
    let two = exr(vec![part(&["R", "G", "B"], WHOLE, [0, 0], Compression::ZIP1), other.clone()]);
    refused(&two, &["2 layers", "main: R", "other: B"]);
    let depth = exr(vec![part(&["Z"], WHOLE, [0, 0], Compression::ZIP1), other]);
    assert_eq!(map(&depth).unwrap().map.texel(1, 1), [101.0, 1101.0, 2101.0]);
}

#[test]
fn cubes_and_dwa_are_refused_by_their_headers() {
    let mut cube = part(&["R", "G", "B"], WHOLE, [0, 0], Compression::ZIP1);
    cube.attributes.environment_map = Some(EnvironmentMap::Cube);
    refused(&exr(vec![cube]), &["cube", "exrenvmap"]);
    for compression in [Compression::DWAA(None), Compression::DWAB(None)] {
        refused(&plain(compression), &["DWAA", "ZIP"]);
    }
    let compressions = [Compression::Uncompressed, Compression::PIZ, Compression::PXR24, Compression::B44];
    for compression in compressions {
        let [r, ..] = map(&plain(compression)).unwrap().map.texel(3, 5);
        assert!((r - 305.0).abs() < 2.0, "{compression:?}: {r}");
    }
}

/// Puts a number in the place of the last attribute of this name and type, `skip` bytes into its value.
fn patch(bytes: &mut [u8], attribute: &[u8], skip: usize, number: i32) {
    let at = (0..bytes.len()).rev().find(|&at| bytes[at..].starts_with(attribute)).unwrap();
    let at = at + attribute.len() + 4 + skip;
    bytes[at..at + 4].copy_from_slice(&number.to_le_bytes());
}

/// What a header claims, of any part, takes no memory.
#[test]
fn a_header_that_claims_too_much_is_refused() {
    let parts = |names: &[&str], compression| {
        let mut other = part(names, [2, 2], [0, 0], compression);
        other.attributes.layer_name = Some("other".into());
        exr(vec![part(&["R", "G", "B"], WHOLE, [0, 0], Compression::ZIP1), other])
    };
    for mut file in [plain(Compression::ZIP1), parts(&["Z"], Compression::ZIP1)] {
        patch(&mut file, b"dataWindow\0box2i\0", 8, 99_999);
        patch(&mut file, b"dataWindow\0box2i\0", 12, 99_999);
        if file.windows(10).any(|name| name == b"chunkCount") {
            patch(&mut file, b"chunkCount\0int\0", 0, 100_000);
        }
        refused(&file, &["100000 × 100000"]);
    }
    let many: Vec<_> = (0..2000).map(|k| format!("c{k}")).collect();
    let many: Vec<_> = many.iter().map(String::as_str).collect();
    refused(&parts(&many, Compression::ZIP1), &["2000 channels"]);
    let mut tiled = part(&["R", "G", "B"], WHOLE, [0, 0], Compression::RLE);
    tiled.encoding.blocks = Blocks::Tiles(Vec2(2048, 1024));
    refused(&exr(vec![tiled]), &["8388608 bytes"]);
}

// ---- Radiance HDR ----------------------------------------------------------------------------------

/// 3 × 2 pixels whose R is 1, 2, … in the order of the file.
fn hdr(head: &str) -> Vec<u8> {
    let pixels = (1..=6).flat_map(|k| [k, 2 * k, 3 * k, 136]);
    head.bytes().chain(pixels).collect()
}

fn reds(bytes: &[u8]) -> Vec<f32> {
    map(bytes).unwrap().map.texels().iter().map(|texel| texel[0]).collect()
}

#[test]
fn exposures_are_undone() {
    let head = |lines: &str| hdr(&format!("#?RADIANCE\n{lines}FORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 3\n"));
    let first = |lines: &str| map(&head(lines)).unwrap().map.texel(0, 1);
    assert_eq!(first(""), [2.0, 4.0, 6.0]);
    assert_eq!(first("EXPOSURE=4\nEXPOSURE= 0.5\n"), [1.0, 2.0, 3.0]);
    assert_eq!(first("COLORCORR=2 4 0.5\nEXPOSURE=0.5\n"), [2.0, 2.0, 24.0]);
    // Of an ancestor.
    assert_eq!(first("\tEXPOSURE=4\n"), [2.0, 4.0, 6.0]);
    let zero = map(&head("EXPOSURE=0\n")).unwrap();
    assert_eq!(zero.map.texel(0, 1), [2.0, 4.0, 6.0]);
    assert!(zero.notes[0].contains("EXPOSURE=0") && zero.notes[0].contains("counts as 1"));
    for line in ["EXPOSURE=-1", "EXPOSURE=two", "COLORCORR=1 2", "EXPOSURE=nan"] {
        refused(&head(&format!("{line}\n")), &[line]);
    }
    refused(&head("FORMAT=32-bit_rle_xyze\n"), &["XYZ", "ra_xyze"]);
    refused(&head("FORMAT=float\n"), &["\"float\""]);
}

#[test]
fn every_orientation_is_read() {
    let up_down = [4.0, 5.0, 6.0, 1.0, 2.0, 3.0];
    for (size, truth) in [
        ("-Y 2 +X 3", [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
        ("+Y 2 +X 3", up_down),
        ("-Y 2 -X 3", [3.0, 2.0, 1.0, 6.0, 5.0, 4.0]),
        ("+Y 2 -X 3", [6.0, 5.0, 4.0, 3.0, 2.0, 1.0]),
        ("+X 3 -Y 2", [1.0, 3.0, 5.0, 2.0, 4.0, 6.0]),
        ("+X 3 +Y 2", [2.0, 4.0, 6.0, 1.0, 3.0, 5.0]),
        ("-X 3 -Y 2", [5.0, 3.0, 1.0, 6.0, 4.0, 2.0]),
        ("-X 3 +Y 2", [6.0, 4.0, 2.0, 5.0, 3.0, 1.0]),
    ] {
        for head in ["#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n", "#?RGBE\r\n# by hand\r\n\r\n"] {
            let end = if head.contains('\r') { "\r\n" } else { "\n" };
            let bytes = hdr(&format!("{head}{size}{end}"));
            assert_eq!(reds(&bytes), truth, "{size}");
            assert_eq!(map(&bytes).unwrap().map.width(), 3);
        }
    }
    for size in ["-Y 2 +Y 3", "2 3", "-Y two +X 3", "*Y 2 +X 3", ""] {
        refused(&hdr(&format!("#?RADIANCE\n\n{size}\n")), &["-Y 512 +X 1024"]);
    }
}

#[test]
fn run_lengths_are_followed_and_fit() {
    let line = |width: u8, codes: &[u8]| {
        let mut bytes = b"#?RADIANCE\n\n-Y 1 +X 8\n".to_vec();
        bytes.extend([2, 2, 0, width]);
        bytes.extend(codes);
        bytes
    };
    let rest = [128 + 8, 0, 128 + 8, 0, 128 + 8, 136];
    let of = |red: &[u8]| [red, &rest].concat();
    assert_eq!(reds(&line(8, &of(&[128 + 5, 7, 3, 1, 2, 3]))), [7.0, 7.0, 7.0, 7.0, 7.0, 1.0, 2.0, 3.0]);
    refused(&line(9, &of(&[128 + 5, 7, 3, 1, 2, 3])), &["9 pixels", "header says 8"]);
    refused(&line(8, &of(&[128 + 9, 7])), &["do not fit"]);
    refused(&line(8, &of(&[0, 7])), &["do not fit"]);
    refused(&line(8, &[128 + 5, 7, 3, 1]), &["not a whole", "line 0 of 1"]);
    // Of old files: a pixel, four more, and one.
    let old = b"#?RADIANCE\n\n-Y 1 +X 6\n\x09\0\0\x88\x01\x01\x01\x04\x05\0\0\x88";
    assert_eq!(reds(old), [9.0, 9.0, 9.0, 9.0, 9.0, 5.0]);
    refused(b"#?RADIANCE\n\n-Y 1 +X 6\n\x01\x01\x01\x04", &["do not fit"]);
}

// ---- Any bytes -------------------------------------------------------------------------------------

/// Files that work, of each kind.
fn seeds() -> Vec<Vec<u8>> {
    let compressions = [
        Compression::Uncompressed,
        Compression::RLE,
        Compression::ZIP1,
        Compression::ZIP16,
        Compression::PIZ,
        Compression::PXR24,
        Compression::B44,
        Compression::B44A,
        Compression::DWAA(None),
    ];
    let mut seeds: Vec<_> = compressions.map(plain).into();
    // Some compress half floats alone.
    seeds.extend([Compression::PIZ, Compression::PXR24, Compression::B44, Compression::B44A].map(
        |compression| {
            let mut halves = part(&["R", "G", "B"], WHOLE, [0, 0], compression);
            for channel in &mut halves.channel_data.list {
                let FlatSamples::F32(samples) = &channel.sample_data else { unreachable!() };
                channel.sample_data = FlatSamples::F16(samples.iter().map(|&x| f16::from_f32(x)).collect());
            }
            exr(vec![halves])
        },
    ));
    let mut tiled = part(&["R", "G", "B"], WHOLE, [0, 0], Compression::ZIP1);
    tiled.encoding.blocks = Blocks::Tiles(Vec2(4, 4));
    seeds.push(exr(vec![tiled]));
    let mut line = b"#?RADIANCE\nEXPOSURE=2\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 8\n\x02\x02\0\x08".to_vec();
    line.extend([133, 7, 3, 1, 2, 3, 136, 0, 136, 0, 136, 136]);
    seeds.extend([line, hdr("#?RGBE\n\n+X 3 -Y 2\n")]);
    seeds
}

#[test]
fn any_bytes_are_read_or_refused() {
    let count = std::env::var("GONIO_MUTATIONS").map_or(200, |count| count.parse().unwrap());
    let file = tempfile::NamedTempFile::new().unwrap();
    let mut state = 0x2545_f491u32;
    let mut below = move |n: usize| {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        state as usize % n.max(1)
    };
    for seed in seeds() {
        for _ in 0..count {
            let mut bytes = seed.clone();
            for _ in 0..=below(4) {
                bytes.extend(bytes.is_empty().then_some(0));
                let at = below(bytes.len());
                let end = (at + below(12)).min(bytes.len());
                match below(5) {
                    0 => bytes[at] = below(256) as u8,
                    1 => bytes[at] ^= 1 << below(8),
                    2 => drop(bytes.drain(at..end)),
                    3 => bytes.truncate(at + 1),
                    _ => {
                        let extremes = [0u32, 1, 0x7f, 0xff, 0x7fff_ffff, 0x8000_0000, u32::MAX];
                        let word = extremes[below(7)].to_le_bytes();
                        bytes[at..end].iter_mut().zip(word).for_each(|(byte, by)| *byte = by);
                    }
                }
            }
            std::fs::write(file.path(), &bytes).unwrap();
            if let Err(why) = read(file.path(), InvalidTexels::Clamp) {
                let why = why.to_string();
                assert!(!why.contains("internal") && why.len() < 4000, "{why}");
            }
        }
    }
}
