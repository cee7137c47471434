//! Reading scenes and recipes: the ranges are those of the file, what is missing widens them, and
//! whatever is wrong gives an error that names the file and the place.

#[path = "../../examples/make_demo_scene.rs"]
#[allow(dead_code, missing_docs)]
mod make_demo_scene;

use crate::common::sample_data;
use gonio::model::compensation::Compensation;
use gonio::scene::{Distribution, Material, Scene, SubjectRequest, Weights, read};
use gonio::table::rule::Rule;
use make_demo_scene::ROUGHNESS;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

// ---- glTF: what is in the file is what is found -------------------------------------------------

#[test]
fn the_demo_scene_takes_what_its_generator_put_in() {
    let folder = demo();
    let scene = read(&folder.path().join("demo.gltf")).unwrap();
    assert_eq!(names(&scene), ["worn paint", "gold", "clay"]);
    assert_eq!(scene.warnings, [""; 0]);
    let [paint, gold, clay] = &scene.materials[..] else { unreachable!() };

    let roughness = ggx(paint);
    assert_eq!([roughness.min(), roughness.max()], ROUGHNESS);
    assert!(ROUGHNESS[0] < roughness.quantile(0.25) && roughness.quantile(0.75) < ROUGHNESS[1]);
    assert_eq!(paint.metallic, Some([0.0, 1.0]));
    assert_eq!(models(paint), ["gltf_diffuse", "ggx"]);
    assert_eq!(words(paint, 0), ["0.96 (1 − metallic) base_color", "0"]);
    assert_eq!(words(paint, 1), ["0.04 (1 − metallic) + metallic base_color", "1"]);

    assert_eq!((models(gold), ggx(gold)), (vec!["ggx"], &Distribution::constant(ROUGHNESS[0])));
    assert_eq!(gold.lobes[0].weights, Weights::Constant([[1.0, 0.78, 0.34], [1.0; 3]]));
    assert!(scene.left_out.iter().any(|l| l.what.contains("gold") && l.what.contains("gltf_diffuse")));

    assert_eq!(models(clay), ["gltf_diffuse", "ggx"]);
    let diffuse = [0.55, 0.27, 0.18].map(|c| 0.96 * c);
    assert_eq!(clay.lobes[0].weights, Weights::Constant([diffuse, [0.0; 3]]));
    assert_eq!(clay.lobes[1].weights, Weights::Constant([[0.04; 3], [1.0; 3]]));
}

#[test]
fn the_committed_demo_is_what_its_generator_makes() {
    let folder = demo();
    let committed = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/demo/demo.gltf");
    let made = read(&folder.path().join("demo.gltf")).unwrap();
    assert_eq!(read(&committed).unwrap().materials, made.materials, "run examples/make_demo_scene.rs");
}

#[test]
fn geometry_is_not_needed() {
    let folder = demo();
    let path = folder.path().join("demo.gltf");
    let before = read(&path).unwrap();
    std::fs::remove_file(folder.path().join("demo.bin")).unwrap();
    assert_eq!(read(&path).unwrap(), before);
}

/// 2 × 1 texels, written by another encoder: G = 51, 153 and B = 0, 204.
const PNG: [u8; 72] = [
    137, 80, 78, 71, 13, 10, 26, 10, 0, 0, 0, 13, 73, 72, 68, 82, 0, 0, 0, 2, 0, 0, 0, 1, 8, 2, 0, 0, 0, 123,
    64, 232, 221, 0, 0, 0, 15, 73, 68, 65, 84, 120, 218, 99, 224, 52, 102, 224, 156, 121, 6, 0, 3, 85, 1,
    171, 243, 255, 122, 146, 0, 0, 0, 0, 73, 69, 78, 68, 174, 66, 96, 130,
];
const PNG_BASE64: &str =
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAIAAAB7QOjdAAAAD0lEQVR42mPgNGbgnHkGAANVAavz/3qSAAAAAElFTkSuQmCC";

#[test]
fn an_image_is_the_same_from_wherever_it_comes() {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name);
    let view = |uri: Value| {
        let buffer =
            if uri.is_null() { json!({ "byteLength": 75 }) } else { json!({ "uri": uri, "byteLength": 75 }) };
        (
            json!({ "bufferView": 0, "mimeType": "image/png" }),
            json!({ "buffers": [buffer], "bufferViews": [{ "buffer": 0, "byteOffset": 3, "byteLength": 72 }] }),
        )
    };
    let bin = [&[0; 3], &PNG[..]].concat();
    std::fs::create_dir(at("sub folder")).unwrap();
    std::fs::write(at("sub folder/ü.png"), PNG).unwrap();
    std::fs::write(at("images.bin"), &bin).unwrap();
    let none = json!({});
    let cases = [
        ("file", json!({ "uri": "sub%20folder/%C3%BC.png" }), none.clone()),
        ("raw name", json!({ "uri": "sub folder/ü.png" }), none.clone()),
        ("data URI", json!({ "uri": format!("data:image/png;base64,{PNG_BASE64}") }), none),
        ("buffer", view(json!("images.bin")).0, view(json!("images.bin")).1),
        // Three zero bytes are the four base64 letters AAAA.
        ("data buffer", view(Value::Null).0, view(json!(format!("data:;base64,AAAA{PNG_BASE64}"))).1),
        ("GLB", view(Value::Null).0, view(Value::Null).1),
    ];
    for (what, image, more) in cases {
        let mut root = textured(image, json!({ "roughnessFactor": 0.5, "metallicFactor": 0.5 }));
        merge(&mut root, more);
        let path = if what == "GLB" {
            write(&folder, "x.glb", glb(&root, &bin))
        } else {
            write(&folder, "x.gltf", root.to_string())
        };
        let scene = read(&path).unwrap();
        assert_eq!(scene.warnings, [""; 0], "{what}");
        let expected = Distribution::weighted([(0.1, 1.0), (0.3, 1.0)]).unwrap();
        assert_eq!(ggx(&scene.materials[0]), &expected, "{what}");
        assert_eq!(scene.materials[0].metallic, Some([0.0, 0.4]), "{what}");
    }
}

#[test]
fn deep_grey_and_jpeg_textures_are_read_too() {
    let folder = TempDir::new().unwrap();
    let scene_of = |name: &str| {
        let root = textured(json!({ "uri": name }), json!({}));
        read(&write(&folder, "x.gltf", root.to_string())).unwrap()
    };
    let range = |scene: &Scene| [ggx(&scene.materials[0]).min(), ggx(&scene.materials[0]).max()];

    let deep = image::ImageBuffer::from_fn(4, 4, |x, _| image::Rgba([0_u16, 1 + x as u16, 65535, 0]));
    deep.save(folder.path().join("deep.png")).unwrap();
    let scene = scene_of("deep.png");
    assert_eq!(range(&scene), [1.0 / 65535.0, 4.0 / 65535.0]);
    assert_eq!(scene.materials[0].metallic, Some([1.0, 1.0]));

    let grey = image::GrayImage::from_fn(4, 4, |x, y| image::Luma([51 + (4 * y + x) as u8]));
    grey.save(folder.path().join("grey.png")).unwrap();
    let scene = scene_of("grey.png");
    assert_eq!(range(&scene), [51.0 / 255.0, 66.0 / 255.0]);
    assert_eq!(scene.materials[0].metallic, Some(range(&scene)));

    image::RgbImage::from_pixel(8, 8, image::Rgb([128; 3])).save(folder.path().join("x.jpg")).unwrap();
    let [min, max] = range(&scene_of("x.jpg"));
    assert!((min - 128.0 / 255.0).abs() < 2.0 / 255.0 && max - min < 2.0 / 255.0, "{min} {max}");
}

#[test]
fn a_texture_that_cannot_be_read_widens_the_ranges_and_says_why() {
    let folder = TempDir::new().unwrap();
    write(&folder, "short.png", &PNG[..60]);
    write(&folder, "x.ktx2", b"\xABKTX 20\xBB\r\n\x1A\n and so on");
    write(&folder, "basis.ktx2", ktx2(0, 1, [1, 1], &[0; 8]));
    write(&folder, "srgb.ktx2", ktx2(29, 0, [1, 1], &[1, 2, 3]));
    write(&folder, "zlib.ktx2", ktx2(23, 3, [1, 1], &[1, 2, 3]));
    write(&folder, "short.ktx2", ktx2(23, 0, [2, 2], &[1, 2, 3]));
    write(&folder, "broken.ktx2", ktx2(23, 2, [2, 2], &[1, 2, 3]));
    write(&folder, "bomb.ktx2", ktx2(23, 0, [1 << 31, 1 << 31], &[1, 2, 3]));
    write(&folder, "x.webp", b"RIFF\x24\0\0\0WEBPVP8 ");
    write(&folder, "text.png", "not an image");
    write(&folder, "empty.png", "");
    // 2³¹ × 2³¹ texels, said in 57 bytes.
    let mut bomb = PNG[..57].to_vec();
    bomb[16..24].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff]);
    write(&folder, "bomb.png", bomb);
    for (uri, why) in [
        ("gone.png", "cannot be read"),
        ("short.png", "cannot be decoded"),
        ("x.ktx2", "KTX2 cannot be decoded"),
        ("basis.ktx2", "Basis Universal"),
        ("srgb.ktx2", "R8G8B8_SRGB"),
        ("zlib.ktx2", "ZLIB"),
        ("short.ktx2", "3 bytes of texels in place of 12"),
        ("broken.ktx2", "KTX2 cannot be decoded"),
        ("bomb.ktx2", "a side are the most"),
        ("x.webp", "WebP is not decoded"),
        ("text.png", "cannot be decoded"),
        ("empty.png", "cannot be decoded"),
        ("bomb.png", "cannot be decoded"),
        (".", "not a file"),
        ("%ff.png", "UTF-8"),
        ("https://example.org/x.png", "network"),
        ("data:image/png;base64,@@@@", "data URI"),
        ("data:", "data URI"),
    ] {
        let factors = json!({ "roughnessFactor": 0.8, "metallicFactor": 0.25 });
        let path = write(&folder, "x.gltf", textured(json!({ "uri": uri }), factors).to_string());
        let scene = read(&path).unwrap();
        let material = &scene.materials[0];
        assert_eq!(ggx(material), &Distribution::uniform(0.0, 0.8), "{uri}");
        assert_eq!(material.metallic, Some([0.0, 0.25]), "{uri}");
        let [warning] = &scene.warnings[..] else { panic!("{uri}: {:?}", scene.warnings) };
        let label = if uri.starts_with("data:") { "images[0]" } else { uri };
        for word in ["material M", label, why, "[0, 0.8]", "[0, 0.25]"] {
            assert!(warning.contains(word), "{warning:?} does not say {word:?}");
        }
    }
}

/// Pixels in a KTX2 are read, as they are and in Zstandard: here a frame of one raw block.
#[test]
fn the_pixels_of_a_ktx2_are_read() {
    let folder = TempDir::new().unwrap();
    let texels = [9, 51, 0, 9, 102, 255]; // two texels: roughness 0.2 and 0.4, metalness 0 and 1
    let mut frame = vec![0x28, 0xb5, 0x2f, 0xfd, 0x20, 6, 1 | 6 << 3, 0, 0];
    frame.extend(texels);
    let deep: Vec<u8> =
        [0, 13107, 0, 0, 0, 26214, 65535, 0].iter().flat_map(|x: &u16| x.to_le_bytes()).collect();
    for (name, bytes) in [
        ("plain", ktx2(23, 0, [2, 1], &texels)),
        ("zstandard", ktx2(23, 2, [2, 1], &frame)),
        ("blue first", ktx2(30, 0, [2, 1], &[0, 51, 9, 255, 102, 9])),
        ("16 bit", ktx2(91, 0, [2, 1], &deep)),
    ] {
        write(&folder, "x.ktx2", bytes);
        let root = textured(json!({ "uri": "x.ktx2" }), json!({ "roughnessFactor": 0.5 }));
        let scene = read(&write(&folder, "x.gltf", root.to_string())).unwrap();
        assert_eq!(scene.warnings, [""; 0], "{name}");
        let expected = Distribution::weighted([(0.1, 1.0), (0.2, 1.0)]).unwrap();
        assert_eq!(ggx(&scene.materials[0]), &expected, "{name}");
        assert_eq!(scene.materials[0].metallic, Some([0.0, 1.0]), "{name}");
    }
    // A channel that is not there is 0, as samplers have it, and not a copy of R.
    write(&folder, "x.ktx2", ktx2(9, 0, [1, 1], &[200]));
    let root = textured(json!({ "uri": "x.ktx2" }), json!({}));
    let scene = read(&write(&folder, "x.gltf", root.to_string())).unwrap();
    assert_eq!(ggx(&scene.materials[0]), &Distribution::constant(0.0));
}

#[test]
fn a_png_beside_a_basis_texture_is_used() {
    let folder = TempDir::new().unwrap();
    write(&folder, "x.png", PNG);
    let mut root = textured(json!({ "uri": "gone.ktx2" }), json!({}));
    root["images"] = json!([{ "uri": "gone.ktx2" }, { "uri": "x.png" }]);
    root["textures"][0] = json!({ "extensions": { "KHR_texture_basisu": { "source": 0 } } });
    let scene = read(&write(&folder, "x.gltf", root.to_string())).unwrap();
    assert!(scene.warnings[0].contains("gone.ktx2"));
    assert_eq!(ggx(&scene.materials[0]), &Distribution::uniform(0.0, 1.0));

    root["textures"][0]["source"] = json!(1);
    let scene = read(&write(&folder, "x.gltf", root.to_string())).unwrap();
    assert_eq!(scene.warnings, [""; 0]);
    assert_eq!(ggx(&scene.materials[0]).max(), 0.6);
}

#[test]
fn only_what_meshes_use_is_read() {
    let root = json!({
        "asset": { "version": "2.0" },
        "materials": [{ "name": "used" }, { "name": "unused" }, { "name": "variant" }, {}, { "name": "used" },
                      { "name": "lamp", "extensions": { "KHR_materials_unlit": {} } }],
        "meshes": [{ "primitives": [
            { "attributes": {}, "material": 0, "extensions": { "KHR_materials_variants":
                { "mappings": [{ "material": 2, "variants": [0] }] } } },
            { "attributes": {}, "material": 3 }, { "attributes": {}, "material": 4 },
            { "attributes": {}, "material": 5 }, { "attributes": {} },
        ] }],
    });
    let scene = read_json(&root).unwrap();
    assert_eq!(names(&scene), ["used", "variant", "material_3", "used_4", "default"]);
    let left_out: Vec<_> = scene.left_out.iter().map(|l| (l.what.as_str(), l.why.as_str())).collect();
    assert!(left_out.contains(&("material unused", "no mesh uses it")));
    assert!(left_out.iter().any(|(what, why)| *what == "material lamp" && why.contains("unlit")));
    // glTF's defaults: white, metal, rough.
    let default = &scene.materials[4];
    assert_eq!((models(default), default.metallic), (vec!["ggx"], Some([1.0; 2])));
    assert_eq!(default.lobes[0].weights, Weights::Constant([[1.0; 3], [1.0; 3]]));
    assert_eq!(ggx(default), &Distribution::constant(1.0));

    // Without a mesh, all.
    let mut library = root;
    library["meshes"] = json!([]);
    let scene = read_json(&library).unwrap();
    assert_eq!(names(&scene), ["used", "unused", "variant", "material_3", "used_4"]);
}

#[test]
fn weights_are_numbers_only_where_colour_and_metalness_are_constant() {
    let mut root = json!({
        "asset": { "version": "2.0" },
        "materials": [{ "pbrMetallicRoughness": { "metallicFactor": 0.5, "baseColorFactor": [0.5, 0, 1, 1] } }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "material": 0 }] }],
    });
    let ggx = |root: &Value| read_json(root).unwrap().materials[0].lobes[1].weights.clone();
    assert_eq!(ggx(&root), Weights::Constant([[0.27, 0.02, 0.52], [1.0; 3]]));
    root["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(1);
    assert!(matches!(ggx(&root), Weights::Textured(_)));

    // A black dielectric has no diffuse lobe.
    root["materials"][0]["pbrMetallicRoughness"] =
        json!({ "metallicFactor": 0, "baseColorFactor": [0, 0, 0, 1] });
    let scene = read_json(&root).unwrap();
    assert_eq!(models(&scene.materials[0]), ["ggx"]);
    assert!(scene.left_out[0].why.contains("black"));
}

#[test]
fn extensions_that_change_the_brdf_are_named_and_idle_ones_are_not() {
    let warnings = |extensions: Value| {
        let mut root = plain();
        root["materials"][0]["extensions"] = extensions;
        read_json(&root).unwrap().warnings
    };
    for (name, active) in [
        ("KHR_materials_diffuse_transmission", json!({ "diffuseTransmissionFactor": 0.5 })),
        ("KHR_materials_dispersion", json!({ "dispersion": 0.1 })),
        ("KHR_materials_pbrSpecularGlossiness", json!({})),
        ("KHR_materials_transmission", json!({ "transmissionFactor": 1 })),
        ("KHR_materials_volume", json!({ "thicknessFactor": 1 })),
        ("VENDOR_something_new", json!({})),
    ] {
        let [warning] = &warnings(json!({ name: active }))[..] else { panic!("{name}: no warning") };
        assert!(warning.contains("material M") && warning.contains(name), "{warning}");
    }
    for (name, idle) in [
        ("KHR_materials_clearcoat", json!({})),
        ("KHR_materials_diffuse_roughness", json!({})),
        ("KHR_materials_ior", json!({ "ior": 1.5 })),
        ("KHR_materials_sheen", json!({ "sheenColorFactor": [0, 0, 0] })),
        ("KHR_materials_specular", json!({ "specularFactor": 1, "specularColorFactor": [1, 1, 1] })),
        ("KHR_materials_emissive_strength", json!({ "emissiveStrength": 5 })),
    ] {
        assert_eq!(warnings(json!({ name: idle })), [""; 0], "{name}");
    }
}

// ---- glTF: what is wrong ------------------------------------------------------------------------

#[test]
fn broken_files_give_errors_that_name_the_place() {
    let with = |path: &str, value: Value| {
        let mut root = textured(json!({ "uri": "x.png" }), json!({}));
        merge(&mut root, json!({ "meshes": [{ "primitives": [{ "attributes": {}, "material": 0 }] }] }));
        *root.pointer_mut(path).unwrap_or_else(|| panic!("no {path}")) = value;
        root.to_string().into_bytes()
    };
    let pbr = "/materials/0/pbrMetallicRoughness";
    let cases = [
        (Vec::new(), "EOF"),
        (b"{".to_vec(), "line 1"),
        (b"[]".to_vec(), "line 1"),
        (b"\xff\xfe{}".to_vec(), "line 1"),
        (
            format!("{{\"materials\": [{{\"extensions\": {}", "{\"X\": ".repeat(100_000)).into_bytes(),
            "recursion",
        ),
        (json!({ "asset": { "version": "2.0" } }).to_string().into_bytes(), "neither a material nor a mesh"),
        (with("/asset/version", json!("1.0")), "asset.version"),
        (
            with(&format!("{pbr}/roughnessFactor"), json!("0.5")),
            "materials[0] (M): roughnessFactor is \"0.5\"",
        ),
        (with(&format!("{pbr}/baseColorFactor"), json!([1])), "baseColorFactor is no list"),
        (with("/materials", json!({})), "materials is no list"),
        (
            String::from_utf8(with(&format!("{pbr}/roughnessFactor"), json!("NaN")))
                .unwrap()
                .replace("\"NaN\"", "NaN")
                .into_bytes(),
            "line 1",
        ),
        (with(&format!("{pbr}/roughnessFactor"), Value::Null), "null"),
    ];
    let folder = TempDir::new().unwrap();
    for (bytes, place) in cases {
        let head = String::from_utf8_lossy(&bytes[..bytes.len().min(40)]).into_owned();
        let message = refused(&write(&folder, "hostile.gltf", bytes));
        assert!(message.contains(place), "{head}: {message:?} does not say {place:?}");
    }
}

/// What is wrong in one material, or in what gonio does not need, refuses nothing else.
#[test]
fn a_mistake_refuses_only_what_it_is_in() {
    let good =
        json!({ "name": "good", "pbrMetallicRoughness": { "roughnessFactor": 0.5, "metallicFactor": 0 } });
    let bad = |pbr: Value| json!({ "name": "bad", "pbrMetallicRoughness": pbr });
    let use_both = json!([{ "primitives": [{ "material": 0 }, { "material": 1 }] }]);
    let with = |bad: Value, more: Value| {
        let mut root = json!({
            "asset": { "version": "2.0" }, "materials": [good, bad], "meshes": use_both, "textures": [{ "source": 7 }],
        });
        merge(&mut root, more);
        read_json(&root).unwrap()
    };
    let alone = |bad: Value| with(bad, json!({}));

    // Numbers beyond what glTF allows are warned of and taken as the nearest that it does.
    for (pbr, key, number, taken) in [
        (json!({ "baseColorFactor": [0.5, 1.00016, 0.5, 1] }), "baseColorFactor[1]", "1.00016", "1"),
        (json!({ "roughnessFactor": -0.25 }), "roughnessFactor", "-0.25", "0"),
        (json!({ "metallicFactor": 1e300 }), "metallicFactor", "1", "1"),
    ] {
        let scene = alone(bad(pbr));
        assert_eq!(names(&scene), ["good", "bad"]);
        let [warning] = &scene.warnings[..] else { panic!("{:?}", scene.warnings) };
        let said = format!("material bad: {key} is {number}");
        assert!(warning.starts_with(&said) && warning.ends_with(&format!("taken as {taken}")), "{warning}");
    }
    // What is no number is the author's to say; the other material is baked.
    for pbr in [json!({ "roughnessFactor": "0.5" }), json!({ "baseColorFactor": 1 }), json!(3)] {
        let scene = alone(bad(pbr));
        assert_eq!(names(&scene), ["good"]);
        assert!(
            scene.warnings[0].starts_with("material bad is not baked: materials[1] (bad): "),
            "{:?}",
            scene.warnings
        );
        let why = scene.material("bad").unwrap_err().to_string();
        assert!(why.contains("material bad is not baked: materials[1]"), "{why}");
    }
    assert!(read_json(&json!({ "asset": { "version": "2.0" }, "materials": [3] })).is_err());
    // An index that leads nowhere is a texture of unknown texels.
    let texture =
        |index: Value| bad(json!({ "metallicRoughnessTexture": { "index": index }, "roughnessFactor": 0.5 }));
    for (index, why) in [
        (json!(5), "there is no textures[5], the file has 1"),
        (json!(-1), "there is no textures[-1]"),
        (json!(0), "there is no images[7], the file has 0"),
        (Value::Null, "it has no index"),
    ] {
        let scene = alone(texture(index));
        assert_eq!(ggx(&scene.materials[1]), &Distribution::uniform(0.0, 0.5));
        assert!(
            scene.warnings[0].starts_with("material bad: ") && scene.warnings[0].contains(why),
            "{:?}",
            scene.warnings
        );
    }
    let scene = alone(bad(json!({ "baseColorTexture": { "index": 9 } })));
    assert!(scene.warnings[0].contains("baseColorTexture: there is no textures[9]"), "{:?}", scene.warnings);
    let scene =
        with(bad(json!({})), json!({ "meshes": [{ "primitives": [{ "material": 9 }, { "material": 0 }] }] }));
    assert_eq!(names(&scene), ["good"]);
    assert!(scene.warnings[0].starts_with("meshes[0].primitives[0].material: there is no materials[9]"));

    // What is not needed.
    for unneeded in [
        json!({ "animations": [{ "channels": [{ "sampler": 0, "target": { "path": "scale" } }] }] }),
        json!({ "scenes": [{ "name": "Scene.001" }], "scene": 4 }),
        json!({ "nodes": [{ "children": [0], "mesh": -2 }], "skins": "none", "accessors": [{}], "cameras": 1 }),
        json!({ "extras": "note" }),
        json!({ "extras": [1, { "extras": 2 }] }),
    ] {
        assert_eq!(with(good.clone(), unneeded).warnings, [""; 0]);
    }
    let noted = json!({ "name": "noted", "extras": 42, "pbrMetallicRoughness": { "extras": "x", "roughnessFactor": 0.5 },
        "extensions": { "KHR_materials_ior": { "extras": [null] } } });
    assert_eq!(alone(noted).warnings, [""; 0]);
}

#[test]
fn the_file_says_what_its_readers_must_know() {
    let mut root = plain();
    root["extensionsRequired"] = json!(["FOO_bar", "KHR_texture_transform", "KHR_materials_ior"]);
    root["asset"]["minVersion"] = json!("3.0");
    let warnings = read_json(&root).unwrap().warnings;
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    assert!(warnings[0].contains("asset.minVersion is 3.0") && warnings[1].contains("requires FOO_bar"));
    root["asset"]["minVersion"] = json!("2.0");
    assert_eq!(read_json(&root).unwrap().warnings.len(), 1);

    let mut unlit = plain();
    unlit["materials"][0]["extensions"] = json!({ "KHR_materials_unlit": {} });
    let why = read_json(&unlit).unwrap_err().to_string();
    assert!(why.contains("material M: KHR_materials_unlit"), "{why}");
}

/// Exporters begin with a byte order mark, end a chunk with NUL, and write names in encodings of their own.
#[test]
fn text_is_read_as_exporters_write_it() {
    let folder = TempDir::new().unwrap();
    let text = plain().to_string();
    let marked = [b"\xef\xbb\xbf", text.as_bytes()].concat();
    assert_eq!(names(&read(&write(&folder, "bom.gltf", &marked)).unwrap()), ["M"]);
    let latin = [b"{\"asset\":{\"version\":\"2.0\"},\"materials\":[{\"name\":\"gr".as_slice(), b"\xfcn\"}]}"]
        .concat();
    let scene = read(&write(&folder, "latin.gltf", latin)).unwrap();
    assert_eq!(names(&scene), ["gr\u{fffd}n"]);
    assert!(scene.warnings[0].contains("UTF-8"));

    let mut padded = glb(&plain(), &[]);
    let length = u32::from_le_bytes(padded[12..16].try_into().unwrap()) as usize;
    let end = 20 + padded[20..20 + length].iter().rposition(|&byte| byte != b' ').unwrap() + 1;
    padded[end..20 + length].fill(0);
    let four = padded.splice(20 + length..20 + length, [0; 4]).count();
    assert_eq!(four, 0);
    for at in [8, 12] {
        let length = u32::from_le_bytes(padded[at..at + 4].try_into().unwrap()) + 4;
        padded[at..at + 4].copy_from_slice(&length.to_le_bytes());
    }
    assert_eq!(names(&read(&write(&folder, "padded.glb", padded)).unwrap()), ["M"]);
}

#[test]
fn files_are_found_as_exporters_name_them() {
    let folder = TempDir::new().unwrap();
    std::fs::create_dir(folder.path().join("textures")).unwrap();
    write(&folder, "textures/x.png", PNG);
    write(&folder, "textures/a%20b.png", PNG);
    write(&folder, "textures/c d.png", PNG);
    let path = folder.path().display();
    let uris = [
        "textures\\x.png".into(),
        ".\\textures\\c%20d.png".into(),
        "textures/a%20b.png".into(),
        "textures/c%20d.png".into(),
        format!("file://{path}/textures/x.png"),
        format!("FILE://localhost{path}/textures/c%20d.png"),
        format!("file:{path}/textures/x.png"),
        format!("DATA:image/png;base64,{PNG_BASE64}"),
        format!("  data:image/png;base64,{PNG_BASE64}"),
    ];
    for uri in uris {
        let scene =
            read(&write(&folder, "x.gltf", textured(json!({ "uri": uri }), json!({})).to_string())).unwrap();
        assert_eq!(scene.warnings, [""; 0], "{uri}");
        assert_eq!(ggx(&scene.materials[0]).max(), 0.6, "{uri}");
    }
    let long = "A".repeat(10_000);
    for (uri, why) in [
        (format!("Data:image/png;base64,@{long}"), "data URI"),
        (format!("image/png;base64,{long}"), "cannot be read"),
        ("file://elsewhere/x.png".into(), "the computer elsewhere"),
        ("HTTPS://example.org/x.png".into(), "HTTPS://"),
    ] {
        let scene =
            read(&write(&folder, "x.gltf", textured(json!({ "uri": uri }), json!({})).to_string())).unwrap();
        let [warning] = &scene.warnings[..] else { panic!("{:?}", scene.warnings) };
        assert!(warning.contains(why) && warning.len() < 600, "{warning}");
    }
}

#[test]
fn what_is_not_a_scene_is_refused() {
    let folder = TempDir::new().unwrap();
    refused(&folder.path().join("gone.gltf"));
    let directory = folder.path().join("directory.glb");
    std::fs::create_dir(&directory).unwrap();
    refused(&directory);
    assert!(refused(&write(&folder, "x.obj", "")).contains(".gltf"));
}

#[test]
fn files_cut_short_are_refused_at_every_length() {
    let folder = TempDir::new().unwrap();
    let root = textured(json!({ "bufferView": 0 }), json!({})).to_string();
    for length in 0..root.len() {
        refused(&write(&folder, "cut.gltf", &root[..length]));
    }
    let binary = glb(&serde_json::from_str(&root).unwrap(), &PNG);
    assert!(read(&write(&folder, "whole.glb", &binary)).is_ok());
    for length in 0..binary.len() {
        refused(&write(&folder, "cut.glb", &binary[..length]));
    }
}

#[test]
fn a_glb_whose_chunks_are_wrong_is_refused() {
    let folder = TempDir::new().unwrap();
    let whole = glb(&plain(), &PNG);
    let with = |at: usize, bytes: &[u8]| {
        let mut damaged = whole.clone();
        damaged[at..at + bytes.len()].copy_from_slice(bytes);
        refused(&write(&folder, "x.glb", damaged))
    };
    assert!(with(4, &[1, 0, 0, 0]).contains("version 1"));
    // Lengths: of the file, then of the JSON chunk.
    assert!(with(8, &[0xff; 4]).contains("cut short"));
    assert!(with(12, &[0xff, 0xff, 0xff, 0x7f]).contains("cut short"));
    assert!(with(16, b"BIN\0").contains("JSON chunk"));
}

/// Reading may succeed or not; it must come back.
#[test]
fn damaged_bytes_never_panic() {
    let folder = TempDir::new().unwrap();
    let mut root = textured(json!({ "bufferView": 0 }), json!({}));
    merge(
        &mut root,
        json!({
            "buffers": [{ "byteLength": PNG.len() }],
            "bufferViews": [{ "buffer": 0, "byteOffset": 0, "byteLength": PNG.len() }],
        }),
    );
    let whole = glb(&root, &PNG);
    let recipe = include_bytes!("../../assets/demo/recipe.toml");
    let mut state = 1_u64;
    let mut random = |below: usize| {
        // Knuth's MMIX generator; the high bits are the good ones.
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    let mut outcomes = [0; 2];
    for round in 0..2000 {
        let (name, source) = if round % 2 == 0 { ("x.glb", &whole[..]) } else { ("x.toml", &recipe[..]) };
        let mut bytes = source.to_vec();
        for _ in 0..=random(4) {
            let at = random(bytes.len());
            bytes[at] = [random(256) as u8, b'9', b'-', b'"', 0xff][random(5)];
        }
        outcomes[usize::from(read(&write(&folder, name, bytes)).is_ok())] += 1;
    }
    assert!(outcomes.iter().all(|&n| n > 50), "the damage is not of every kind: {outcomes:?}");
}

// ---- Recipes ------------------------------------------------------------------------------------

#[test]
fn the_commented_recipe_is_read() {
    let scene = read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/demo/recipe.toml")).unwrap();
    assert_eq!(names(&scene), ["gold", "plaster", "mirror", "painted wood"]);
    assert_eq!(scene.tolerance, Some(1e-4));
    let [gold, plaster, mirror, wood] = &scene.materials[..] else { unreachable!() };
    assert_eq!(gold.lobes[0].weights, Weights::Constant([[1.0, 0.78, 0.34], [1.0; 3]]));
    assert_eq!(plaster.lobes[0].weights, Weights::Constant([[0.8, 0.78, 0.74], [0.0; 3]]));
    assert_eq!(mirror.lobes[0].weights, Weights::Constant([[0.9; 3], [1.0; 3]]));
    assert_eq!([ggx(wood).min(), ggx(wood).max()], [0.35, 0.55]);

    let [brdf, dfg, plaster, average] = &scene.tables[..] else { panic!("{:?}", scene.tables) };
    let axes: Vec<_> = brdf.axes.iter().map(|axis| (axis.variable().name(), axis.len())).collect();
    assert_eq!(axes, [("theta_i", 8), ("theta_e", 32), ("delta_phi", 64)]);
    assert_eq!(brdf.subject, SubjectRequest::Material("gold".into()));
    assert_eq!((dfg.name.as_deref(), dfg.tolerance), (Some("dfg"), Some(1e-5)));
    assert_eq!(dfg.axes[0].range(), [1e-3, 1.0]);
    assert_eq!(
        (plaster.rule, plaster.axes[0].values()),
        (Some(Rule::Grid { theta: 256, phi: 512 }), &[0.0, 0.5, 1.0, 1.5][..])
    );
    assert_eq!(
        average.subject,
        SubjectRequest::Basis {
            model: "ggx".into(),
            roughness: Some(0.5),
            parameters: Vec::new(),
            compensation: Compensation::None,
        }
    );
    assert!(brdf.place.contains("recipe.toml: line "));
}

#[test]
fn recipe_errors_name_the_line_and_the_valid_words() {
    const GOLD: &str = "[materials.gold]\nlobes = [{ model = 'ggx', roughness = 0.3 }]\n";
    let material = |lobe: &str| format!("\n[materials.m]\nlobes = [\n{lobe}\n]");
    let table = |rest: &str| format!("{GOLD}[[tables]]\n{rest}\n");
    let cases = [
        ("".into(), "", &["materials", "tables"][..]),
        ("tolerance = 1e-4\nmaterials = [".into(), "line 2", &[]),
        ("tolerence = 1e-4".into(), "line 1", &["tolerence", "tolerance", "materials", "tables"]),
        ("tolerance = 2".into(), "line 1", &["0.000000000001", "1"]),
        ("tolerance = nan".into(), "line 1", &["NaN"]),
        ("\ntolerance = '1'".into(), "line 2", &["number", "string"]),
        ("\n\nmaterials = 3".into(), "line 3", &["table"]),
        ("[materials.m]\n".into(), "line 1", &["lobes"]),
        ("[materials.m]\nlobes = []".into(), "line 2", &["model"]),
        ("[materials.m]\nlobe = []".into(), "line 2", &["lobe:", "lobes"]),
        ("[materials.m]\nlobes=[]\n[materials.m]\n".into(), "line 3", &["duplicate"]),
        ("[materials.'']\nlobes = []".into(), "line 1", &["name"]),
        (material("{ roughness = 1 }"), "line 4", &["model"]),
        (
            material("{ model = 'plastic' }"),
            "line 4",
            &["plastic", "lambert", "ggx", "mirror", "gltf_diffuse"],
        ),
        (
            material("{ model = 'ggx', rougness = 1 }"),
            "line 4",
            &["rougness", "roughness", "alpha", "f0", "f90"],
        ),
        (material("{ model = 'ggx' }"), "line 4", &["roughness", "alpha"]),
        (material("{ model = 'ggx', roughness = 1, alpha = 1 }"), "line 4", &["keep one"]),
        (material("{ model = 'ggx', roughness = 1.1 }"), "line 4", &["1.1", "[0, 1]"]),
        (material("{ model = 'ggx', roughness = [0.6, 0.3] }"), "line 4", &["reversed"]),
        (material("{ model = 'ggx', roughness = [0.6] }"), "line 4", &["[a, b]"]),
        (material("{ model = 'ggx', alpha = -1 }"), "line 4", &["-1", "[0, 1]"]),
        (material("{ model = 'ggx', alpha = 1, f0 = [1, 1] }"), "line 4", &["three"]),
        (material("{ model = 'ggx', alpha = 1, f0 = [1, 1, 3] }"), "line 4", &["3 is outside"]),
        (material("{ model = 'lambert' }"), "line 4", &["albedo"]),
        (material("{ model = 'lambert', albedo = 1.01 }"), "line 4", &["1.01"]),
        (material("{ model = 'lambert', albedo = 1, roughness = 1 }"), "line 4", &["roughness", "albedo"]),
        (material("{ model = 'mirror', alpha = 1 }"), "line 4", &["alpha", "f0", "f90"]),
        (table("material = 'gold'"), "line 3", &["quantity"]),
        (table("quantity = 'rho'"), "line 4", &["brdf", "rho_dh", "rho_hh", "split_sum"]),
        (table("quantity = 'brdf'"), "line 3", &["material", "model"]),
        (table("quantity = 'brdf'\nmaterial = 'gould'"), "line 5", &["gould", "gold"]),
        (table("quantity = 'brdf'\nmaterial = 'gold'\nmodel = 'ggx'"), "line 6", &["keep one"]),
        (table("quantity = 'brdf'\nmaterial = 'gold'\nroughness = 1"), "line 6", &["its own"]),
        (table("quantity = 'brdf'\nmodel = 'lambert'\nroughness = 1"), "line 6", &["no roughness"]),
        (table("quantity = 'brdf'\nmodel = 'ggx'\nroughness = [0, 1]"), "line 6", &["axis"]),
        (table("quantity = 'brdf'\nmodel = 'ggx'\naxis = {}"), "line 6", &["axes", "grid", "tolerance"]),
        (
            table("quantity = 'split_sum'\nmodel = 'ggx'\naxes = { theta_i = 3 }"),
            "line 6",
            &["mu", "roughness"],
        ),
        (
            table("quantity = 'rho_hh'\nmodel = 'lambert'\naxes = { roughness = 3 }"),
            "line 6",
            &["no roughness"],
        ),
        (
            table("quantity = 'rho_hh'\nmodel = 'ggx'\nalpha = 1\naxes = { roughness = 3 }"),
            "line 7",
            &["roughness"],
        ),
        (table("quantity = 'rho_hh'\nmaterial = 'gold'\naxes = { roughness = 3 }"), "line 6", &["range"]),
        (table("quantity = 'rho_dh'\nmodel = 'ggx'\naxes.theta_i = 0"), "line 6", &["count"]),
        (table("quantity = 'rho_dh'\nmodel = 'ggx'\naxes.theta_i = 2.5"), "line 6", &["whole number"]),
        (table("quantity = 'rho_dh'\nmodel = 'ggx'\naxes.theta_i = 9000000000"), "line 6", &["1048576"]),
        (
            table("quantity = 'rho_dh'\nmodel = 'ggx'\naxes.theta_i = { range = [0, 1] }"),
            "line 6",
            &["count"],
        ),
        (
            table("quantity = 'rho_dh'\nmodel = 'ggx'\naxes.theta_i = { count = 3, range = [0, 90] }"),
            "line 6",
            &["90", "rad"],
        ),
        (
            table("quantity = 'rho_dh'\nmodel = 'ggx'\naxes.theta_i = { count = 3, step = 1 }"),
            "line 6",
            &["step", "range", "positions", "mapping", "values"],
        ),
        (
            table("quantity = 'rho_dh'\nmodel = 'ggx'\naxes.theta_i = { count = 3, positions = 'edges' }"),
            "line 6",
            &["centers", "nodes"],
        ),
        (
            table("quantity = 'rho_dh'\nmodel = 'ggx'\naxes.theta_i = { count = 3, mapping = 'log' }"),
            "line 6",
            &["linear", "sqrt"],
        ),
        (
            table("quantity = 'rho_dh'\nmodel = 'ggx'\naxes.theta_i = { count = 3, values = [0] }"),
            "line 6",
            &["count"],
        ),
        (
            table("quantity = 'rho_dh'\nmodel = 'ggx'\naxes.theta_i = { values = [1, 0] }"),
            "line 6",
            &["increase"],
        ),
        (table("quantity = 'rho_dh'\nmodel = 'ggx'\ngrid = [0, 5]"), "line 6", &["0"]),
        (table("quantity = 'rho_dh'\nmodel = 'ggx'\ngrid = 64"), "line 6", &["list"]),
        (table("quantity = 'rho_dh'\nmodel = 'ggx'\nname = '../x'"), "line 6", &["files"]),
        (
            table(
                "quantity = 'rho_dh'\nmodel = 'ggx'\nname = 'x'\n[[tables]]\nname = 'X'\nquantity = 'rho_hh'\nmodel = 'ggx'",
            ),
            "line 7",
            &["another"],
        ),
    ];
    let folder = TempDir::new().unwrap();
    for (text, line, words) in cases {
        let message = refused(&write(&folder, "hostile.toml", &text));
        for word in [line].iter().chain(words) {
            assert!(message.contains(word), "{text}\n{message:?} does not say {word:?}");
        }
        let after = message.split(line).nth(1).unwrap_or_default();
        assert!(line.is_empty() || after.starts_with(':'), "{text}\n{message:?} is not at {line}");
    }
    let message = refused(&write(&folder, "hostile.toml", b"tolerance = 1e-4\n# \xff"));
    assert!(message.contains("line 2") && message.contains("UTF-8"), "{message}");
}

#[test]
fn roughness_and_alpha_say_the_same() {
    let folder = TempDir::new().unwrap();
    let lobe = |words: &str| {
        let text = format!("[materials.m]\nlobes = [{{ model = 'ggx', {words} }}]");
        read(&write(&folder, "x.toml", text)).unwrap().materials
    };
    assert_eq!(lobe("roughness = 0.5"), lobe("alpha = 0.25"));
    assert_eq!(lobe("roughness = 0.5"), lobe("roughness = 0.5, f0 = [0.04, 0.04, 0.04], f90 = 1"));
}

// ---- Real scenes --------------------------------------------------------------------------------

/// Khronos sample models: ranges and quartiles as Pillow and NumPy count them.
#[test]
#[ignore = "needs the sample data: set GONIO_DATA, see CONTRIBUTING.md"]
fn sample_data_give_the_ranges_of_their_textures() {
    let helmet = sample_data("gltf/FlightHelmet/FlightHelmet.gltf");
    let expected: [(&str, [u8; 5], [u8; 2]); 6] = [
        ("HoseMat", [58, 88, 124, 158, 216], [0, 178]),
        ("RubberWoodMat", [58, 88, 124, 158, 216], [0, 178]),
        ("GlassPlasticMat", [16, 92, 108, 141, 233], [0, 0]),
        ("MetalPartsMat", [41, 117, 147, 160, 218], [0, 255]),
        ("LeatherPartsMat", [65, 92, 112, 145, 255], [0, 215]),
        ("LensesMat", [28, 37, 64, 76, 123], [0, 0]),
    ];
    let scene = read(&helmet).unwrap();
    assert_eq!(scene.warnings, [""; 0]);
    assert_eq!(scene.materials.len(), expected.len());
    for (material, (name, levels, metallic)) in scene.materials.iter().zip(expected) {
        let r = ggx(material);
        let found = [r.min(), r.quantile(0.25), r.quantile(0.5), r.quantile(0.75), r.max()];
        assert_eq!(material.name, name);
        assert_eq!(found, levels.map(|level| f64::from(level) / 255.0), "{name}");
        assert_eq!(material.metallic, Some(metallic.map(|level| f64::from(level) / 255.0)), "{name}");
    }

    let lamp = read(&sample_data("gltf/AnisotropyBarnLamp/AnisotropyBarnLamp.gltf")).unwrap();
    assert_eq!(names(&lamp), ["Lamp Metal", "Lamp Filament", "Lamp Glass"]);
    let [metal, filament, glass] = &lamp.materials[..] else { unreachable!() };
    assert_eq!(models(metal), ["gltf_diffuse", "ggx-anisotropic", "ggx-smith-correlated-none"]);
    // Its texture is a KTX2 of pixels in Zstandard, whose levels another decoder gives too.
    let r = metal.lobes[1].roughness.as_ref().unwrap();
    let found = [r.min(), r.quantile(0.25), r.quantile(0.5), r.quantile(0.75), r.max()];
    assert_eq!(found, [0, 73, 82, 95, 255].map(|level| f64::from(level) / 255.0));
    assert_eq!(metal.metallic, Some([0.0, 1.0]));
    assert_eq!(metal.lobes[2].roughness, Some(Distribution::constant(0.15)));
    assert_eq!((models(filament), models(glass)), (vec!["gltf_diffuse", "ggx"], vec!["ggx"]));
    assert_eq!(lamp.warnings.len(), 3, "{:?}", lamp.warnings);
    for word in ["KHR_materials_anisotropy", "KHR_materials_transmission", "KHR_materials_volume"] {
        assert!(lamp.warnings.iter().any(|warning| warning.contains(word)), "{word}: {:?}", lamp.warnings);
    }
}

// ---- Helpers ------------------------------------------------------------------------------------

fn demo() -> TempDir {
    let folder = TempDir::new().unwrap();
    make_demo_scene::write(folder.path()).unwrap();
    folder
}

fn names(scene: &Scene) -> Vec<&str> {
    scene.materials.iter().map(|material| material.name.as_str()).collect()
}

fn models(material: &Material) -> Vec<&str> {
    material.lobes.iter().map(|lobe| lobe.model.as_str()).collect()
}

/// The formulas of a lobe's weights.
fn words(material: &Material, lobe: usize) -> [String; 2] {
    let Weights::Textured(formulas) = &material.lobes[lobe].weights else { panic!("they are numbers") };
    formulas.each_ref().map(ToString::to_string)
}

/// The roughness of a material's ggx lobe.
fn ggx(material: &Material) -> &Distribution {
    material.lobes.iter().find(|lobe| lobe.model == "ggx").unwrap().roughness.as_ref().unwrap()
}

/// A KTX2 of one level and one picture: a VkFormat, and how its bytes are compressed.
fn ktx2(format: u32, scheme: u32, [width, height]: [u32; 2], level: &[u8]) -> Vec<u8> {
    // A basic data format descriptor without samples: RGBSDA, BT.709, linear.
    let dfd: Vec<u8> = [28_u32, 0, 2 | 24 << 16, 1 | 1 << 8 | 1 << 16, 0, 3, 0]
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    let at = 80 + 24 + dfd.len() as u64;
    let mut bytes = b"\xABKTX 20\xBB\r\n\x1A\n".to_vec();
    for word in [format, 1, width, height, 0, 0, 1, 1, scheme, 80 + 24, dfd.len() as u32, 0, 0] {
        bytes.extend(word.to_le_bytes());
    }
    let length = level.len() as u64;
    let uncompressed = if scheme == 1 { 0 } else { length };
    for long in [0, 0, at, length, uncompressed] {
        bytes.extend(long.to_le_bytes());
    }
    bytes.extend(dfd);
    bytes.extend(level);
    bytes
}

fn write(folder: &TempDir, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

fn read_json(root: &Value) -> gonio::base::error::Result<Scene> {
    let folder = TempDir::new().unwrap();
    read(&write(&folder, "x.gltf", root.to_string()))
}

/// The message with which a file is refused; it begins with the file.
fn refused(path: &Path) -> String {
    let message = match read(path) {
        Ok(scene) => panic!("{} was read: {scene:?}", path.display()),
        Err(error) => error.to_string(),
    };
    let file = path.display().to_string();
    assert!(message.starts_with(&file), "{message:?} does not begin with the file");
    message
}

/// One material M, no mesh.
fn plain() -> Value {
    json!({ "asset": { "version": "2.0" }, "materials": [{ "name": "M" }] })
}

/// One material M with a texture of this image, and these factors.
fn textured(image: Value, factors: Value) -> Value {
    let mut root = plain();
    let mut pbr = json!({
        "baseColorTexture": { "index": 0 }, "metallicRoughnessTexture": { "index": 0 },
        "baseColorFactor": [1, 1, 1, 1], "roughnessFactor": 1, "metallicFactor": 1,
    });
    merge(&mut pbr, factors);
    root["materials"][0]["pbrMetallicRoughness"] = pbr;
    merge(&mut root, json!({ "images": [image], "textures": [{ "source": 0 }] }));
    root
}

fn merge(into: &mut Value, from: Value) {
    let (Value::Object(into), Value::Object(from)) = (into, from) else { panic!("two objects, please") };
    into.extend(from);
}

/// A GLB of this JSON and this binary chunk.
fn glb(root: &Value, bin: &[u8]) -> Vec<u8> {
    let pad = |mut bytes: Vec<u8>, with: u8| {
        bytes.resize(bytes.len().next_multiple_of(4), with);
        bytes
    };
    let chunks = [(pad(root.to_string().into_bytes(), b' '), b"JSON"), (pad(bin.to_vec(), 0), b"BIN\0")];
    let total: usize = 12 + chunks.iter().map(|(bytes, _)| 8 + bytes.len()).sum::<usize>();
    let mut out = [&b"glTF"[..], &2_u32.to_le_bytes(), &(total as u32).to_le_bytes()].concat();
    for (bytes, kind) in chunks {
        out.extend([&(bytes.len() as u32).to_le_bytes(), &kind[..], &bytes].concat());
    }
    out
}

#[test]
fn recipes_name_their_rule() {
    let table = |rule: &str| {
        let text = format!("[[tables]]\nquantity = 'rho_hh'\nmodel = 'ggx'\nroughness = 0.5\n{rule}\n");
        gonio::scene::parse_recipe(Path::new("r.toml"), text.as_bytes())
    };
    let rule = |text: &str| table(text).unwrap().tables[0].rule;
    assert_eq!(rule(""), None);
    assert_eq!(rule("rule = 'warped'"), Some(Rule::Warped));
    assert_eq!(rule("grid = [8, 16]"), Some(Rule::Grid { theta: 8, phi: 16 }));
    assert_eq!(rule("rule = { grid = [8, 16] }"), Some(Rule::Grid { theta: 8, phi: 16 }));
    assert_eq!(rule("rule = { gauss = [32, 64] }"), Some(Rule::Gauss { theta: 32, phi: 64 }));
    assert_eq!(rule("rule = { hammersley = 1024 }"), Some(Rule::Hammersley { samples: 1024 }));
    assert_eq!(rule("rule = { vndf = 64 }"), Some(Rule::Vndf { samples: 64 }));
    assert_eq!(rule("rule = { random = 64 }"), Some(Rule::Random { samples: 64 }));
    for (bad, word) in [
        ("rule = 'grid'", "warped"),
        ("rule = { simpson = 8 }", "hammersley"),
        ("rule = { vndf = 0 }", "count"),
        ("rule = { vndf = 64, random = 64 }", "one rule"),
        ("rule = { vndf = 64 }\ngrid = [8, 16]", "keep one"),
    ] {
        let why = table(bad).unwrap_err().to_string();
        assert!(why.contains("line 5") && why.contains(word), "{bad}: {why}");
    }
}
