//! Small files of each format, made here.

use exr::prelude::{Encoding, Image, SpecificChannels, WritableImage};
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use std::f32::consts::FRAC_PI_4;
use std::io::Cursor;

const SIDE: u32 = 8;

/// The scene around a texture.
pub const TEXTURED: &str = r#"{"asset":{"version":"2.0"},"images":[{"uri":"texture"}],"textures":[{"source":0}],
"materials":[{"pbrMetallicRoughness":{"metallicRoughnessTexture":{"index":0}}}]}"#;

const EXTENDED: &str = r#"{"asset":{"version":"2.0"},"extensionsUsed":["KHR_materials_clearcoat"],
"buffers":[{"uri":"data:;base64,AAAAAAAAAAAAAAAAAAAAAA==","byteLength":16}],"bufferViews":[{"buffer":0,"byteLength":16}],
"images":[{"bufferView":0,"mimeType":"image/png"}],"samplers":[{}],"textures":[{"source":0,"sampler":0}],
"materials":[{"name":"m","pbrMetallicRoughness":{"baseColorFactor":[1,0.5,0.25,1],"roughnessFactor":0.5,"metallicFactor":0.25,
"metallicRoughnessTexture":{"index":0}},"extensions":{"KHR_materials_clearcoat":{"clearcoatFactor":0.5,
"clearcoatRoughnessFactor":0.1},"KHR_materials_sheen":{"sheenColorFactor":[0.5,0.5,0.5],"sheenRoughnessFactor":0.4},
"KHR_materials_anisotropy":{"anisotropyStrength":0.5},"KHR_materials_ior":{"ior":1.4},
"KHR_materials_iridescence":{"iridescenceFactor":1,"iridescenceIor":1.3},"KHR_materials_specular":{"specularFactor":0.5}}}]}"#;

pub fn gltf() -> Vec<Vec<u8>> {
    vec![TEXTURED.into(), EXTENDED.into(), include_bytes!("../../assets/demo/demo.gltf").to_vec()]
}

pub fn glb() -> Vec<Vec<u8>> {
    let mut json =
        br#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":8}],"materials":[{"name":"m"}]}"#.to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let chunks = [(*b"JSON", json), (*b"BIN\0", vec![0; 8])];
    let body: Vec<u8> = chunks
        .iter()
        .flat_map(|(kind, data)| [&(data.len() as u32).to_le_bytes()[..], kind, data].concat())
        .collect();
    vec![[&b"glTF"[..], &2_u32.to_le_bytes(), &(12 + body.len() as u32).to_le_bytes(), &body].concat()]
}

pub fn recipe() -> Vec<Vec<u8>> {
    let demo = include_bytes!("../../assets/demo/recipe.toml").to_vec();
    let small = "tolerance = 1e-3\n[materials.m]\nlobes = [{ model = \"ggx\", roughness = [0.1, 0.5], f0 = 0.04 }]\n\
                 [[tables]]\nname = \"t\"\nmodel = \"ggx\"\nquantity = \"split_sum\"\naxes = { roughness = 4, mu = 4 }\n";
    vec![small.into(), demo]
}

fn levels() -> Vec<u8> {
    (0..SIDE * SIDE * 3).map(|k| (k * 37 % 251) as u8).collect()
}

pub fn ktx2() -> Vec<Vec<u8>> {
    let level = levels();
    // A data format descriptor without samples, of linear RGB; and a frame of Zstandard with one raw block.
    let dfd: Vec<u8> = [28_u32, 0, 2 | 24 << 16, 1 | 1 << 8 | 1 << 16, 0, 3, 0]
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    let block = (level.len() as u32) << 3 | 1;
    let frame =
        [&[0x28, 0xb5, 0x2f, 0xfd, 0x20, level.len() as u8][..], &block.to_le_bytes()[..3], &level].concat();
    [(0, level.clone()), (2, frame)]
        .map(|(scheme, data)| {
            let mut bytes = b"\xABKTX 20\xBB\r\n\x1A\n".to_vec();
            for word in [23, 1, SIDE, SIDE, 0, 0, 1, 1, scheme, 80 + 24, dfd.len() as u32, 0, 0] {
                bytes.extend(word.to_le_bytes());
            }
            for long in [0, 0, 80 + 24 + dfd.len(), data.len(), level.len()] {
                bytes.extend((long as u64).to_le_bytes());
            }
            [bytes, dfd.clone(), data].concat()
        })
        .into()
}

pub fn jpeg() -> Vec<Vec<u8>> {
    [(ExtendedColorType::Rgb8, 3), (ExtendedColorType::L8, 1)]
        .into_iter()
        .filter_map(|(color, channels)| {
            let mut bytes = Vec::new();
            let encoder = JpegEncoder::new_with_quality(&mut bytes, 90);
            let pixels = (SIDE * SIDE) as usize * channels;
            encoder.write_image(&levels()[..pixels], SIDE, SIDE, color).ok().map(|()| bytes)
        })
        .collect()
}

pub fn png() -> Vec<Vec<u8>> {
    [(ExtendedColorType::Rgb8, 192), (ExtendedColorType::L8, 64), (ExtendedColorType::L16, 128)]
        .into_iter()
        .filter_map(|(color, count)| {
            let mut bytes = Vec::new();
            PngEncoder::new(&mut bytes)
                .write_image(&levels()[..count], SIDE, SIDE, color)
                .ok()
                .map(|()| bytes)
        })
        .collect()
}

pub fn exr() -> Vec<Vec<u8>> {
    use exr::prelude::Compression;
    let compressions = [
        Compression::Uncompressed,
        Compression::RLE,
        Compression::ZIP1,
        Compression::ZIP16,
        Compression::PIZ,
        Compression::B44,
    ];
    compressions
        .into_iter()
        .filter_map(|compression| {
            let channels = SpecificChannels::rgb(|at: exr::math::Vec2<usize>| {
                let x = (at.x() + 8 * at.y()) as f32;
                (half::f16::from_f32(x), half::f16::from_f32(0.5 * x), half::f16::from_f32(x.sin().abs()))
            });
            let encoding = Encoding { compression, ..Encoding::UNCOMPRESSED };
            let image = Image::from_encoded_channels((SIDE as usize * 2, SIDE as usize), encoding, channels);
            let mut bytes = Cursor::new(Vec::new());
            image.write().non_parallel().to_buffered(&mut bytes).ok().map(|()| bytes.into_inner())
        })
        .collect()
}

pub fn hdr() -> Vec<Vec<u8>> {
    let (width, height) = (16, 8);
    let head = |extra: &str| {
        format!("#?RADIANCE\n{extra}FORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n").into_bytes()
    };
    let flat = [head(""), [100, 110, 120, 129].repeat(width * height)].concat();
    // Rows in runs: of each component two of 8 equal bytes.
    let row = [&[2, 2, 0, width as u8][..], &[136, 7, 136, 9].repeat(4)].concat();
    let runs = [head("EXPOSURE=2\nCOLORCORR=1 1 2\n"), row.repeat(height)].concat();
    vec![flat, runs]
}

pub fn npy() -> Vec<Vec<u8>> {
    let row = [0.5, 0.25, FRAC_PI_4, 1.0];
    ["<f8", ">f8", "<f4", ">f4"]
        .map(|kind| {
            let mut header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': (3, 4), }}");
            header += &" ".repeat(63 - (10 + header.len()) % 64);
            header.push('\n');
            let number = |x: f32| match kind {
                "<f8" => f64::from(x).to_le_bytes().to_vec(),
                ">f8" => f64::from(x).to_be_bytes().to_vec(),
                "<f4" => x.to_le_bytes().to_vec(),
                _ => x.to_be_bytes().to_vec(),
            };
            let rows = row.map(number).concat().repeat(3);
            [&b"\x93NUMPY\x01\x00"[..], &(header.len() as u16).to_le_bytes(), header.as_bytes(), &rows]
                .concat()
        })
        .into()
}

pub fn csv() -> Vec<Vec<u8>> {
    let text =
        "theta_i,phi_i,theta_e,phi_e\n# two\n0.5,0.25,0.7853981633974483,1\n\n\"0.1\", 0, 1e-3, -2.5\r\n";
    vec![text.into(), "\u{feff}0,0,0,0\n".into()]
}

pub fn wgsl() -> Vec<Vec<u8>> {
    let lobe = "/* a lobe */ struct M { a: f32, c: vec3f }\nconst PI = 3.14159265; // π\n\
        fn d(h: vec3f, m: M) -> f32 { let t = h.z * h.z * (m.a * m.a - 1.0) + 1.0; return m.a * m.a / (PI * t * t); }\n\
        fn brdf(wi: vec3f, wo: vec3f, a: f32, r: f32) -> vec3f { let h = normalize(wi + wo); \
        return M(a, vec3f(r)).c * d(h, M(a, vec3f(r))) / (4.0 * max(wi.z * wo.z, 1e-4)); }\n";
    let loops = "const W = array<f32, 3>(0.1, 0.2, 0.3); fn g(x: f32) -> f32 { var s = 0.0; \
        for (var k = 0u; k < 3u; k++) { if x > 0.5 { continue; } else if x < 0.1 { break; } s += W[k]; } \
        loop { s += 1.0; continuing { break if s > 2.0; } } switch i32(s) { case 0: { s = 1.0; } default: { } } \
        while s > 5.0 { s -= 1.0; } return s; }\n\
        fn brdf(wi: vec3f, wo: vec3f) -> f32 { return select(g(wi.z), 0.5, wo.z > 0.5); }\n";
    vec![lobe.into(), loops.into()]
}
