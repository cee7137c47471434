//! Promises of `gonio plot` and `gonio gallery`: pictures that decode and say what they show, pixels that are
//! the physics they stand for, and files all or none.

use crate::common::*;
use data_url::DataUrl;
use gonio::bake::Evaluator;
use gonio::check::Check;
use gonio::model::MODELS;
use gonio::plan::TablePlan;
use gonio::table::axis::{Axis, Variable};
use gonio::table::quantity::RHO_DH;
use image::RgbImage;
use quick_xml::Reader;
use quick_xml::events::Event;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

fn run(dir: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_gonio")).current_dir(dir).args(args).output().unwrap()
}

fn succeed(dir: &Path, args: &[&str]) -> Output {
    let output = run(dir, args);
    assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    output
}

fn names(dir: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(dir).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// What an SVG file holds.
#[derive(Default)]
struct Svg {
    size: [f64; 2],
    /// Position and text.
    texts: Vec<([f64; 2], String)>,
    /// Title, frame and pixels.
    images: Vec<(String, [f64; 4], RgbImage)>,
}

impl Svg {
    /// Every element must be closed, every attribute well formed: the reader refuses what is not.
    fn read(path: &Path) -> Self {
        let text = fs::read_to_string(path).unwrap();
        let mut reader = Reader::from_str(&text);
        let (mut svg, mut open) = (Self::default(), Vec::new());
        let mut said = String::new();
        loop {
            match reader.read_event().unwrap() {
                Event::Start(e) => {
                    said.clear();
                    open.push((e.name().as_ref().to_owned(), attributes(&e)));
                }
                Event::Empty(e) => drop(attributes(&e)),
                Event::Text(text) => said += &text,
                Event::GeneralRef(name) => {
                    said += match &*name {
                        "amp" => "&",
                        "lt" => "<",
                        "gt" => ">",
                        "quot" => "\"",
                        other => panic!("&{other};"),
                    }
                }
                Event::End(_) => svg.close(open.pop().unwrap(), &said, open.last()),
                Event::Eof => break,
                other => panic!("{other:?}"),
            }
        }
        assert!(open.is_empty());
        svg
    }

    fn close(&mut self, element: (String, Attributes), said: &str, parent: Option<&(String, Attributes)>) {
        let (name, attributes) = element;
        let number = |of: &Attributes, key: &str| of[key].parse::<f64>().unwrap();
        match &name[..] {
            "svg" => self.size = ["width", "height"].map(|key| number(&attributes, key)),
            "text" => self.texts.push((["x", "y"].map(|key| number(&attributes, key)), said.into())),
            "title" => {
                let of = &parent.unwrap().1;
                let (png, _) = DataUrl::process(&of["href"]).unwrap().decode_to_vec().unwrap();
                let pixels = image::load_from_memory(&png).unwrap().to_rgb8();
                let frame = ["x", "y", "width", "height"].map(|key| number(of, key));
                self.images.push((said.into(), frame, pixels));
            }
            _ => {}
        }
    }

    fn says(&self, text: &str) -> bool {
        self.texts.iter().any(|(_, said)| said.contains(text))
    }

    fn image(&self, title: &str) -> &(String, [f64; 4], RgbImage) {
        self.images
            .iter()
            .find(|(said, ..)| said.contains(title))
            .unwrap_or_else(|| panic!("no image {title}"))
    }
}

type Attributes = BTreeMap<String, String>;

fn attributes(e: &quick_xml::events::BytesStart) -> Attributes {
    e.attributes().map(Result::unwrap).map(|a| (a.key.as_ref().to_owned(), a.value.into_owned())).collect()
}

/// IEC 61966-2-1, of linear light, in steps of 8 bits.
fn srgb(linear: f64) -> f64 {
    255.0 * if linear <= 0.0031308 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// A pixel's middle, as a sphere's (x, y).
fn middle(pixels: &RgbImage, column: u32, row: u32) -> [f64; 2] {
    let side = f64::from(pixels.width());
    [(f64::from(column) + 0.5) * 2.0 / side - 1.0, 1.0 - (f64::from(row) + 0.5) * 2.0 / side]
}

#[test]
fn a_picture_decodes_and_says_what_it_shows() {
    let dir = tempfile::tempdir().unwrap();
    let args = ["plot", "ggx", "--set", "roughness=0.1,0.3,0.6", "--set", "f0=0.04", "--theta", "30,60"];
    succeed(dir.path(), &[&args[..], &["--out", "a.png", "--out", "a.svg"]].concat());
    assert_eq!(names(dir.path()), ["a.png", "a.svg"]);

    let svg = Svg::read(&dir.path().join("a.svg"));
    let [width, height] = svg.size;
    for label in
        ["ggx", "f0 = 0.04", "roughness =", "0.1", "0.3", "0.6", "θi = 30°", "θi = 60°", "sr⁻¹", "ρ_dh"]
    {
        assert!(svg.says(label), "no \"{label}\"");
    }
    for ([x, y], text) in &svg.texts {
        assert!((0.0..=width).contains(x) && (0.0..=height).contains(y), "\"{text}\" is off the page");
    }
    // Over the hemisphere for two θi, and two spheres, for each setting; and the colour bar.
    assert_eq!(svg.images.len(), 3 * 4 + 1);

    // Two pixels to a unit.
    let png = image::open(dir.path().join("a.png")).unwrap().to_rgb8();
    assert_eq!([f64::from(png.width()), f64::from(png.height())], [2.0 * width, 2.0 * height]);
    let dark = png.pixels().filter(|pixel| pixel.0.iter().all(|&c| c < 128)).count();
    let white = png.pixels().filter(|pixel| pixel.0 == [255; 3]).count();
    let all = (png.width() * png.height()) as usize;
    assert!(dark > all / 100 && white > all / 4, "{dark} dark and {white} white of {all}");

    // An image in the PNG has the pixels that the SVG embeds, but for its border and the marks upon it.
    let (_, [x, y, ..], pixels) = svg.image("roughness = 0.3: a sphere in uniform light");
    let (left, top) = ((2.0 * x).round() as u32, (2.0 * y).round() as u32);
    for (column, row) in (100..260).flat_map(|column| (100..260).map(move |row| (column, row))) {
        assert_eq!(png.get_pixel(left + column, top + row), pixels.get_pixel(column, row));
    }
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    let dir = tempfile::tempdir().unwrap();
    for name in ["a", "b"] {
        let [png, svg] = ["png", "svg"].map(|extension| format!("{name}.{extension}"));
        succeed(dir.path(), &["plot", "lambert", "--device", "cpu", "--out", &png, "--out", &svg]);
    }
    for extension in ["png", "svg"] {
        let [a, b] = ["a", "b"].map(|name| fs::read(dir.path().join(format!("{name}.{extension}"))).unwrap());
        assert!(a == b, "{extension}");
    }
}

/// Under radiance 1 from everywhere a pixel has ρ_dh(θe) with sin θe its distance from the middle. A tolerance
/// of 1e-4 on both sides, and lines of 0.09° between samples, are worth 0.3 of a step where sRGB is steepest
/// here (ρ = 0.03), and rounding ½: within 1.
#[test]
fn the_uniform_sphere_is_rho_dh() {
    let dir = tempfile::tempdir().unwrap();
    let args = ["plot", "ggx", "--set", "roughness=0.15,0.4,0.9", "--out", "a.svg"];
    succeed(dir.path(), &args);
    let svg = Svg::read(&dir.path().join("a.svg"));
    let largest = |roughness: f64, shown: &str| -> f64 {
        let (_, _, pixels) = svg.image(&format!("roughness = {shown}: a sphere in uniform light"));
        let row = pixels.height() / 2;
        let columns: Vec<_> = (pixels.width() / 2..pixels.width()).collect();
        let theta = |&column: &u32| {
            let [x, y] = middle(pixels, column, row);
            x.hypot(y).asin()
        };
        let axis = Axis::listed(Variable::ThetaI, columns.iter().map(theta).collect()).unwrap();
        let plan = TablePlan::basis("rho", &RHO_DH, model("ggx"), Some(roughness), vec![axis]).unwrap();
        let table = bake(device(), &plan, Check::Sample(0));
        let off = |(k, &column): (usize, &u32)| {
            let rho = 0.04 * table.value(k, 0) + table.value(k, 1);
            (f64::from(pixels.get_pixel(column, row).0[0]) - srgb(rho)).abs()
        };
        columns.iter().enumerate().map(off).fold(0.0, f64::max)
    };
    for (roughness, shown) in [(0.15, "0.15"), (0.4, "0.4"), (0.9, "0.9")] {
        let off = largest(roughness, shown);
        println!("roughness {shown}: {off} steps");
        assert!(off <= 1.0, "roughness {shown}: off by {off} steps");
    }
    // The comparer can fail.
    assert!(largest(0.5, "0.4") > 1.0);
}

/// A white Lambert sphere has π f cos θi = n·l. A pixel is the mean of four samples of it: their spread around
/// its middle is less than a step where n·l > 0.1 and its gradient over a pixel below 1/100.
#[test]
fn the_lit_lambert_sphere_is_the_cosine() {
    let dir = tempfile::tempdir().unwrap();
    succeed(dir.path(), &["plot", "lambert", "--set", "albedo=1", "--out", "a.svg"]);
    let svg = Svg::read(&dir.path().join("a.svg"));
    assert!(svg.says("white: π f cos θi = 1 and more"));
    let (_, _, pixels) = svg.image("a sphere under a point light");
    let mut compared = 0;
    for (column, row, pixel) in pixels.enumerate_pixels() {
        let [x, y] = middle(pixels, column, row);
        let r2 = x * x + y * y;
        let cosine = -0.5 * x + 0.5 * y + (1.0 - r2).max(0.0).sqrt() * 0.5f64.sqrt();
        if r2 < 0.9 && cosine > 0.1 {
            let off = (f64::from(pixel.0[0]) - srgb(cosine)).abs();
            assert!(off <= 1.0, "at ({x}, {y}): {} for {}", pixel.0[0], srgb(cosine));
            compared += 1;
        } else if r2 < 0.9 && cosine < -0.1 {
            assert_eq!(pixel.0, [0; 3]);
        }
    }
    assert!(compared > 10_000);
}

/// Two white diffuse lobes reflect twice what comes in: no shade of grey says so.
#[test]
fn more_light_than_came_in_is_marked() {
    let dir = tempfile::tempdir().unwrap();
    let lobe = "{ model = \"lambert\", albedo = 1 }";
    fs::write(dir.path().join("r.toml"), format!("[materials.twice]\nlobes = [{lobe}, {lobe}]\n")).unwrap();
    succeed(dir.path(), &["plot", "r.toml", "--material", "twice", "--out", "a.svg"]);
    let svg = Svg::read(&dir.path().join("a.svg"));
    assert!(svg.says("twice of r.toml"));
    assert_eq!(svg.image("uniform light").2.get_pixel(180, 180).0, [214, 0, 90]);
}

#[test]
fn what_is_not_there_is_said() {
    let dir = tempfile::tempdir().unwrap();
    succeed(dir.path(), &["plot", "mirror", "--out", "mirror.svg"]);
    let svg = Svg::read(&dir.path().join("mirror.svg"));
    assert!(svg.says("a delta, which has no values"));
    assert!(svg.says("0.5: a delta, ρ_dh(45°) = 0.50"));
    assert_eq!(svg.images.iter().filter(|(title, ..)| title.contains("hemisphere")).count(), 0);

    let args = ["plot", "ggx", "--set", "roughness=0.5", "--set", "masking=smith-correlated,none", "--out"];
    succeed(dir.path(), &[&args[..], &["none.svg"]].concat());
    let svg = Svg::read(&dir.path().join("none.svg"));
    assert!(svg.says("masking = none: ρ_dh has no bound"));
    assert_eq!(svg.images.iter().filter(|(title, ..)| title.contains("uniform light")).count(), 1);
    assert_eq!(svg.images.iter().filter(|(title, ..)| title.contains("hemisphere")).count(), 2);

    // The limit α = 0 is a delta among the others.
    succeed(dir.path(), &["plot", "ggx", "--set", "alpha=0,1e-6,1", "--theta", "90", "--out", "alpha.svg"]);
    assert!(Svg::read(&dir.path().join("alpha.svg")).says("alpha = 0: a delta"));
}

#[test]
fn json_has_the_numbers() {
    let dir = tempfile::tempdir().unwrap();
    let args =
        ["plot", "lambert", "--set", "albedo=0.25,0.75", "--theta", "0,60", "--json", "--out", "a.png"];
    let json: Value = serde_json::from_slice(&succeed(dir.path(), &args).stdout).unwrap();
    assert_eq!(json["files"][0], "a.png");
    for (k, albedo) in [0.25, 0.75].into_iter().enumerate() {
        for direction in json["settings"][k]["directions"].as_array().unwrap() {
            assert!((direction["rho_dh"][1].as_f64().unwrap() - albedo).abs() < 1e-4);
            // albedo/π at θe = 0, in f32.
            let peak = direction["peak"]["f_cos_theta_e"].as_f64().unwrap();
            assert!((peak * std::f64::consts::PI / albedo - 1.0).abs() < 1e-6);
        }
    }
}

#[test]
fn bad_settings_are_refused_with_a_remedy_and_nothing_is_left() {
    let dir = tempfile::tempdir().unwrap();
    let cases: [(&[&str], &str); 14] = [
        (&["ggy"], "there are lambert"),
        (&["scene.gltf"], "give --material NAME"),
        (&["ggx", "--set", "roughness=0.1,0.2,0.3,0.4,0.5,0.6"], "up to 5"),
        (&["ggx", "--set", "roughness=0.1,0.2", "--set", "f0=0.04,1"], "several to one of them"),
        (&["ggx", "--set", "roughness=2"], "[0, 1]"),
        (&["ggx", "--set", "roughness=0.1,,0.2"], "a value is missing"),
        (&["ggx", "--set", "f0"], "KEY=VALUE"),
        (&["ggx", "--set", "f0=0.04"], "give its roughness or its alpha"),
        (&["ggx", "--set", "roughness=0.3", "--set", "masking=smith"], "smith-correlated"),
        (&["ggx", "--theta", "95"], "[0°, 90°]"),
        (&["ggx", "--theta", "10,20,30,40"], "up to 3"),
        (&["ggx", "--radius", "square"], "auto, linear or log"),
        (&["ggx", "--out", "a.jpg"], ".png or .svg"),
        (&["ggx", "--material", "gold"], "give a .gltf, a .glb or a recipe"),
    ];
    for (args, remedy) in cases {
        let output = run(dir.path(), &[&["plot"], args].concat());
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{args:?}: {stderr}");
        assert!(stderr.contains(remedy), "{args:?}: {stderr}");
        assert_eq!(names(dir.path()), [""; 0], "{args:?}");
    }
}

#[test]
fn files_come_together_or_not_at_all() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("a.png"), "old").unwrap();
    let args = ["plot", "lambert", "--device", "cpu", "--out", "a.png", "--out", "nowhere/a.svg"];
    let output = run(dir.path(), &args);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("nowhere/a.svg"));
    assert_eq!(names(dir.path()), ["a.png"]);
    assert_eq!(fs::read(dir.path().join("a.png")).unwrap(), b"old");
}

/// The folder in which `gallery` is, made once.
fn gallery() -> &'static Path {
    static DIR: LazyLock<PathBuf> = LazyLock::new(|| {
        let dir = Path::new(env!("CARGO_TARGET_TMPDIR")).join("plot");
        // What an earlier run left, if there was one.
        let _ = fs::remove_dir_all(&dir);
        fs::create_dir_all(&dir).unwrap();
        succeed(&dir, &["gallery", "--out", "gallery"]);
        dir
    });
    &DIR
}

#[test]
fn the_gallery_has_every_model_and_is_whole() {
    let gallery = gallery().join("gallery");
    let [html, markdown] =
        ["index.html", "gallery.md"].map(|name| fs::read_to_string(gallery.join(name)).unwrap());
    for model in MODELS {
        assert!(html.contains(&format!("<h2>{}</h2>", model.name)), "{}", model.name);
        assert!(markdown.contains(&format!("## {}\n", model.name)) && markdown.contains(model.source));
        assert!(html.contains(&format!("gonio plot {} --set ", model.name)));
        let svg = Svg::read(&gallery.join(format!("{}.svg", model.name)));
        assert!(svg.says(model.name));
        image::open(gallery.join(format!("{}.png", model.name))).unwrap();
    }
    assert!(html.contains("ggx by masking") && html.contains("smith-separable"));
    // One file: nothing in it is fetched. Pictures in base64 may spell "http" by chance, but not its colon.
    let html_but_names = html.replace("http://www.w3.org/2000/svg", "");
    assert!(!html.contains("src="));
    assert!(!html_but_names.contains("http:") && !html_but_names.contains("https:"));
    assert_eq!(gonio::io::verify(&gallery).unwrap(), Vec::<String>::new());

    // A stranger's file is not overwritten, and what was there stays.
    let before = names(&gallery);
    let strange = tempfile::tempdir().unwrap();
    fs::write(strange.path().join("mirror.svg"), "mine").unwrap();
    let output = run(strange.path(), &["gallery", "--out", "."]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("mirror.svg"));
    assert!(names(strange.path()).iter().all(|name| name == "mirror.svg" || name == ".gonio.lock"));
    assert_eq!(fs::read(strange.path().join("mirror.svg")).unwrap(), b"mine");
    assert_eq!(names(&gallery), before);
}

/// The command that stands beside a picture makes it.
#[test]
fn the_gallerys_commands_make_its_pictures() {
    let manifest = gonio::io::read_manifest(&gallery().join("gallery")).unwrap();
    let pictures = manifest["pictures"].as_array().unwrap();
    assert!(pictures.len() > MODELS.len());
    let lambert = pictures.iter().find(|picture| picture["name"] == "lambert").unwrap();
    let words: Vec<_> = lambert["command"].as_str().unwrap().split(' ').skip(1).collect();
    let dir = tempfile::tempdir().unwrap();
    succeed(dir.path(), &words);
    let made = fs::read(dir.path().join("lambert.png")).unwrap();
    assert!(made == fs::read(gallery().join("gallery/lambert.png")).unwrap());
}

/// Both evaluators draw the same picture, but for their names: values differ by roundings of f32.
#[test]
fn the_cpu_draws_what_the_device_draws() {
    assert!(matches!(device(), Evaluator::Device(_)));
    let dir = tempfile::tempdir().unwrap();
    for (name, choice) in [("device.svg", "auto"), ("cpu.svg", "cpu")] {
        succeed(dir.path(), &["plot", "ggx", "--set", "roughness=0.3", "--device", choice, "--out", name]);
    }
    let [a, b] = ["device.svg", "cpu.svg"].map(|name| Svg::read(&dir.path().join(name)));
    for (title, _, pixels) in &a.images {
        let other = &b.image(title).2;
        let off = pixels.as_raw().iter().zip(other.as_raw()).map(|(x, y)| x.abs_diff(*y)).max().unwrap();
        assert!(off <= 1, "{title}: off by {off} steps");
    }
}
