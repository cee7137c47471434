//! The range that is read of a texture is never narrower than that of the picture which its file was made of: files that
//! are cut, damaged or not complete are taken over the whole range, with a warning.

use gonio::scene::{Distribution, Scene, read};
use image::codecs::jpeg::JpegEncoder;
use image::{ImageEncoder, ImageFormat, Rgb, RgbImage, Rgba, RgbaImage};
use serde_json::json;
use std::fs;
use std::io::Cursor;
use tempfile::TempDir;

/// Roughness rises from left to right, so that a part of the picture has a part of the range.
fn picture() -> RgbImage {
    RgbImage::from_fn(48, 40, |x, y| Rgb([128, 40 + 4 * x as u8, 200 - 3 * y as u8]))
}

fn png() -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    picture().write_to(&mut bytes, ImageFormat::Png).unwrap();
    bytes.into_inner()
}

fn jpeg() -> Vec<u8> {
    let mut bytes = Vec::new();
    let picture = picture();
    let encoder = JpegEncoder::new_with_quality(&mut bytes, 90);
    encoder.write_image(&picture, picture.width(), picture.height(), image::ColorType::Rgb8.into()).unwrap();
    bytes
}

/// 24 × 24 texels in ten scans, by libjpeg 2.1: with bands of coefficients, and bits that later scans refine.
fn progressive() -> Vec<u8> {
    let pairs = PROGRESSIVE.as_bytes().chunks_exact(2);
    pairs.map(|pair| u8::from_str_radix(std::str::from_utf8(pair).unwrap(), 16).unwrap()).collect()
}

/// R8G8B8 in a frame of Zstandard with one raw block.
fn ktx2() -> Vec<u8> {
    let picture = picture();
    let texels = picture.as_raw();
    let block = (texels.len() as u32) << 3 | 1;
    let mut level = vec![0x28, 0xb5, 0x2f, 0xfd, 0xa0];
    level.extend((texels.len() as u32).to_le_bytes());
    level.extend(&block.to_le_bytes()[..3]);
    level.extend(texels);
    let descriptor = [28_u32, 0, 2 | 24 << 16, 1 | 1 << 8 | 1 << 16, 0, 3, 0].map(u32::to_le_bytes).concat();
    let mut bytes = b"\xABKTX 20\xBB\r\n\x1A\n".to_vec();
    let header = [23, 1, picture.width(), picture.height(), 0, 0, 1, 1, 2, 104, 28, 0, 0];
    bytes.extend(header.map(u32::to_le_bytes).concat());
    bytes.extend([0, 0, 132, level.len() as u64, texels.len() as u64].map(u64::to_le_bytes).concat());
    bytes.extend(descriptor);
    bytes.extend(level);
    bytes
}

/// A scene with one material of one texture.
struct Textured(TempDir);

impl Textured {
    fn new() -> Self {
        let folder = TempDir::new().unwrap();
        let root = json!({
            "asset": { "version": "2.0" }, "images": [{ "uri": "texture" }], "textures": [{ "source": 0 }],
            "materials": [{ "name": "M", "pbrMetallicRoughness": { "metallicRoughnessTexture": { "index": 0 } },
                "extensions": { "KHR_materials_sheen": { "sheenColorFactor": [1, 1, 1], "sheenRoughnessFactor": 1,
                    "sheenRoughnessTexture": { "index": 0 } } } }],
        });
        fs::write(folder.path().join("x.gltf"), root.to_string()).unwrap();
        Self(folder)
    }

    fn read(&self, bytes: &[u8]) -> Scene {
        fs::write(self.0.path().join("texture"), bytes).unwrap();
        read(&self.0.path().join("x.gltf")).unwrap()
    }

    /// The texels that the file has, or the whole range, with a warning.
    fn holds(&self, bytes: &[u8], whole: &Scene, what: &str) -> bool {
        let scene = self.read(bytes);
        let ranges = |scene: &Scene| -> Vec<[f64; 2]> {
            let lobes = &scene.materials[0].lobes;
            let roughness = lobes.iter().filter_map(|lobe| lobe.roughness.as_ref());
            roughness
                .map(|roughness| [roughness.min(), roughness.max()])
                .chain(scene.materials[0].metallic)
                .collect()
        };
        if !scene.warnings.is_empty() {
            assert!(ranges(&scene).iter().all(|range| *range == [0.0, 1.0]), "{what}: {:?}", ranges(&scene));
            assert!(
                scene.warnings.iter().all(|w| w.contains("material M") && w.contains("texture")),
                "{what}"
            );
            return true;
        }
        let [found, true_ranges] = [ranges(&scene), ranges(whole)];
        found.len() == true_ranges.len()
            && found
                .iter()
                .zip(&true_ranges)
                .all(|(found, whole)| found[0] <= whole[0] && whole[1] <= found[1])
    }
}

#[test]
fn whole_files_are_believed() {
    let textured = Textured::new();
    for (what, bytes) in files() {
        let scene = textured.read(&bytes);
        assert_eq!(scene.warnings, [""; 0], "{what}");
        let roughness = scene.materials[0].lobes.iter().find(|lobe| lobe.model == "ggx").unwrap();
        let roughness = roughness.roughness.as_ref().unwrap();
        assert!(roughness.min() < 0.25 && roughness.max() > 0.8, "{what}: {roughness:?}");
        assert_ne!(roughness, &Distribution::uniform(0.0, 1.0), "{what}");
    }
}

#[test]
fn files_that_are_cut_are_taken_over_the_whole_range() {
    let textured = Textured::new();
    for (what, bytes) in files() {
        for length in
            (0..bytes.len()).step_by(1 + bytes.len() / 150).chain([bytes.len() - 2, bytes.len() - 1])
        {
            let scene = textured.read(&bytes[..length]);
            assert_eq!(scene.warnings.len(), 2, "{what} of {length} bytes: {:?}", scene.warnings);
            assert!(textured.holds(&bytes[..length], &scene, what), "{what} of {length} bytes");
        }
        // A picture that another program closed again: the end is there, and not what is before it.
        if what.ends_with("JPEG") {
            for length in (0..bytes.len() - 2).step_by(1 + bytes.len() / 150) {
                let closed = [&bytes[..length], &[0xff, 0xd9]].concat();
                assert_eq!(textured.read(&closed).warnings.len(), 2, "{what} of {length} bytes, closed");
            }
        }
    }
}

/// PNG has checksums. Of JPEG and KTX2, which have none, damage is found that leaves no whole picture: where a piece of the
/// file is lost or there twice, and where the header says something else. (A few bytes that are lost within a block of a JPEG
/// leave as many blocks as there were, and no trace.)
#[test]
fn files_that_are_damaged_are_not_taken_too_narrow() {
    let textured = Textured::new();
    for (what, bytes) in files() {
        let whole = textured.read(&bytes);
        let mut state = 1_u64;
        let mut random = |below: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize % below
        };
        for round in 0..150 {
            let at = random(bytes.len() - 160);
            let piece = at..at + 64 + random(96);
            let mut damaged = bytes.clone();
            match round % 3 {
                0 => drop(damaged.drain(piece)),
                1 => drop(damaged.splice(at..at, bytes[piece].to_vec())),
                _ if what == "PNG" => damaged[at] ^= 1 << random(8),
                _ => damaged[random(24)] ^= 1 << random(8),
            }
            assert!(textured.holds(&damaged, &whole, what), "{what}, round {round}, at {at}");
        }
    }
}

/// The descriptor of a KTX2 says what its bytes are: one that says something else, or nothing, is not believed.
#[test]
fn a_ktx2_is_what_its_descriptor_says() {
    let textured = Textured::new();
    for at in 104..124 {
        for value in [0x80, 0xff] {
            let mut bytes = ktx2();
            // Of primaries, flags and the block's size nothing depends.
            if ![114, 115, 117, 119].contains(&at) {
                bytes[at] = value;
                assert_eq!(textured.read(&bytes).warnings.len(), 2, "{value} at {at}");
            }
        }
    }
}

/// The chunk with the alpha of a palette is one that decoders pass over where it is broken.
#[test]
fn alpha_is_not_lost() {
    let textured = Textured::new();
    let mut bytes = Cursor::new(Vec::new());
    let picture = RgbaImage::from_fn(8, 8, |x, y| Rgba([0, 255, 255, 16 * (x + y) as u8]));
    picture.write_to(&mut bytes, ImageFormat::Png).unwrap();
    let whole = textured.read(bytes.get_ref());
    assert_eq!(whole.warnings, [""; 0]);
    // A chunk of no meaning, with a checksum that is not its own.
    let mut damaged = bytes.into_inner();
    damaged.splice(33..33, *b"\0\0\0\x01tRNS\x10abcd");
    assert_eq!(textured.read(&damaged).warnings.len(), 2);
    assert!(textured.holds(&damaged, &whole, "alpha"));
}

fn files() -> [(&'static str, Vec<u8>); 4] {
    [("PNG", png()), ("JPEG", jpeg()), ("progressive JPEG", progressive()), ("KTX2", ktx2())]
}

const PROGRESSIVE: &str = "ffd8ffe000104a46494600010100000100010000ffdb004300100b0c0e0c0a100e0d0e1211101318281a181616183123251d283a333d3c\
     3933383740485c4e404457453738506d51575f626768673e4d71797064785c656763ffdb0043011112121815182f1a1a2f634238426363\
     636363636363636363636363636363636363636363636363636363636363636363636363636363636363636363636363ffc20011080018\
     001803011100021101031101ffc4001500010100000000000000000000000000000403ffc4001701000301000000000000000000000000\
     0003040502ffda000c03010002100310000001281a48855ca63a341220d729928d040835ca9fffc4001610010101000000000000000000\
     00000000000102ffda0008010100010502ca23288ca23fffc400161101010100000000000000000000000000020010ffda000801030101\
     3f019cf1cf1cefffc40017110101010100000000000000000000000002000112ffda0008010201013f0142d3712169b448dcda6fffc400\
     14100100000000000000000000000000000030ffda0008010100063f021fffc400161001010100000000000000000000000000000110ff\
     da0008010100013f21610946b087ffda000c03010002000300000010686f4f9fffc4001711010101010000000000000000000000000001\
     2111ffda0008010301013f10eab14ee294ee2b14ffc400161101010100000000000000000000000000011020ffda0008010201013f1082\
     e422cbffc4001810000301010000000000000000000000000001213111ffda0008010100013f1058648a610202d173a470e4cfffd9";
