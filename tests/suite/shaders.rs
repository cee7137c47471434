//! A user's own shader is taken as it is: parameters of any type, roles by name, WGSL and GLSL, what it includes and
//! imports, what its program would bind. What cannot be a BRDF is refused, with a remedy.
#![cfg(feature = "verify")]

use crate::common::device;
use gonio::backend::gpu::Device;
use gonio::bake::Evaluator;
use gonio::base::angles::Angles;
use gonio::verify::user_shader::{
    ShaderOptions, ShaderResource, ShaderTexture, UpAxis, UserFunction, UserShader, directions,
};
use gonio::verify::{ParameterRange, Subject, Symmetry};
use std::path::Path;
use tempfile::TempDir;

fn gpu() -> &'static Device {
    match device() {
        Evaluator::Device(device) => device,
        Evaluator::Cpu => unreachable!("common::device asserts it"),
    }
}

const PAIR: Angles = Angles { theta_i: 0.5, phi_i: 0.3, theta_e: 1.1, phi_e: 2.5 };

/// A folder with files, the first of which is the shader.
fn folder(files: &[(&str, &str)]) -> TempDir {
    let dir = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = dir.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    dir
}

fn read(name: &str, text: &str, options: &ShaderOptions) -> gonio::base::error::Result<UserFunction> {
    UserFunction::read(&folder(&[(name, text)]).path().join(name), options)
}

fn plain() -> ShaderOptions {
    ShaderOptions::default()
}

fn with(change: impl FnOnce(&mut ShaderOptions)) -> ShaderOptions {
    let mut options = plain();
    change(&mut options);
    options
}

/// f of a pair at a setting, by the device.
fn evaluate(function: UserFunction, setting: &[f64]) -> Vec<f32> {
    let named = function.parameters().iter().zip(setting);
    let ranges = named.map(|(p, &value)| ParameterRange::new(&p.name, value, value).unwrap()).collect();
    let symmetry = Symmetry { isotropic: true, bilateral: true };
    let mut shader = UserShader::new(gpu(), function, ranges, false, symmetry).unwrap();
    let mut values = Vec::new();
    shader.evaluate(setting, &[PAIR], &mut values).unwrap();
    values
}

fn value(name: &str, text: &str, options: &ShaderOptions, setting: &[f64]) -> Vec<f32> {
    evaluate(read(name, text, options).unwrap(), setting)
}

fn refusal(name: &str, text: &str, options: &ShaderOptions) -> String {
    read(name, text, options).unwrap_err().to_string()
}

// ---- Parameters ------------------------------------------------------------------------------------

#[test]
fn parameters_of_every_type_arrive() {
    let text = "
        struct Layer { weight: f32, tint: vec2f }
        struct Material { layers: array<Layer, 2>, mode: u32 }
        fn brdf(wi: vec3f, wo: vec3f, a: f32, b: i32, c: bool, d: vec3f, m: Material, e: mat2x2f) -> vec4f {
            let flag = select(0.0, 1000.0, c);
            let layers = m.layers[0].weight + 2.0 * m.layers[1].tint.y + f32(m.mode);
            return vec4f(a + f32(b) + flag, dot(d, vec3f(1.0, 10.0, 100.0)), layers + e[1].x, 7.0);
        }";
    let function = read("a.wgsl", text, &plain()).unwrap();
    let names: Vec<_> = function.parameters().iter().map(|p| p.name.as_str()).collect();
    let layers = ["m.layers[0].weight", "m.layers[0].tint.x", "m.layers[0].tint.y", "m.layers[1].weight"];
    assert_eq!(names[..6], ["a", "b", "c", "d.x", "d.y", "d.z"]);
    assert_eq!((&names[6..10], names.len()), (&layers[..], 17));
    let integers: Vec<_> = function.parameters().iter().filter(|p| p.is_integer()).map(|p| &p.name).collect();
    assert_eq!(integers, ["b", "c", "m.mode"]);
    let setting = [0.5, -3.0, 1.0, 1.0, 2.0, 3.0, 4.0, 0.0, 0.0, 0.0, 0.0, 5.0, 4e9, 0.0, 0.0, 6.0, 0.0];
    assert_eq!(evaluate(function, &setting), [997.5, 321.0, 4e9_f32 + 20.0]);
}

/// Integers and bools are searched among whole numbers, and have no others.
#[test]
fn whole_numbers_stay_whole() {
    let text = "fn brdf(wi: vec3f, wo: vec3f, flags: u32, on: bool) -> f32 { return 0.1; }";
    let shader = |flags: (f64, f64), on: (f64, f64)| {
        let ranges = [("flags", flags), ("on", on)]
            .map(|(name, (low, high))| ParameterRange::new(name, low, high).unwrap());
        let symmetry = Symmetry { isotropic: true, bilateral: true };
        UserShader::new(gpu(), read("a.wgsl", text, &plain()).unwrap(), ranges.to_vec(), false, symmetry)
    };
    let taken = shader((0.0, 7.0), (0.0, 1.0)).unwrap();
    assert!(taken.parameters().iter().all(|range| range.integer));
    for (flags, on, words) in [
        ((-1.0, 7.0), (0.0, 1.0), "not within u32"),
        ((0.5, 7.0), (0.0, 1.0), "no whole number"),
        ((0.0, 7.0), (0.0, 2.0), "not within bool"),
    ] {
        let error = shader(flags, on).map(|_| ()).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn halves_are_computed_where_the_device_has_them() {
    let text = "enable f16; fn brdf(wi: vec3<f16>, wo: vec3f, r: f16) -> f16 { return r * 256.0h * 512.0h + wi.z * 0.0h; }";
    let function = read("a.wgsl", text, &plain()).unwrap();
    if gpu().wgpu().0.features().contains(wgpu::Features::SHADER_F16) {
        assert_eq!(evaluate(function, &[1.0]), [f32::INFINITY]);
    } else {
        let ranges = vec![ParameterRange::new("r", 1.0, 1.0).unwrap()];
        let symmetry = Symmetry { isotropic: true, bilateral: true };
        let error = UserShader::new(gpu(), function, ranges, false, symmetry).map(|_| ()).unwrap_err();
        assert!(error.to_string().contains("SHADER_F16"), "{error}");
    }
}

// ---- Roles -----------------------------------------------------------------------------------------

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn half_vector() -> [f32; 3] {
    let [i, o] = directions(&PAIR, false);
    let sum = [0, 1, 2].map(|k| i[k] + o[k]);
    sum.map(|x| x / dot(sum, sum).sqrt())
}

fn assert_near(values: &[f32], expected: [f32; 3]) {
    assert!(
        values.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6),
        "{values:?} and not {expected:?}"
    );
}

#[test]
fn vectors_have_their_roles_in_any_order() {
    let text = "struct Surface { N: vec3f, toEye: vec3f, NdotV: f32 }
        fn f(h: vec3f, s: ptr<function, Surface>, t: vec3f, b: vec3f, lightDir: vec3f) -> vec3f {
            return vec3f(dot((*s).N, lightDir) + 10.0 * (*s).NdotV, dot(t, (*s).toEye) + 10.0 * dot(b, lightDir), h.x);
        }";
    let ([i, o], h) = (directions(&PAIR, false), half_vector());
    assert_near(&value("a.wgsl", text, &plain(), &[]), [i[2] + 10.0 * o[2], o[0] + 10.0 * i[1], h[0]]);
}

#[test]
fn cosines_have_their_roles() {
    let text = "vec3 f(float NoL, float n_dot_v, float dotNH, float LdotV, float VdotH, float XdotL) {
        return vec3(NoL + 10.0 * n_dot_v, dotNH + 10.0 * LdotV, VdotH + 10.0 * XdotL); }";
    let ([i, o], h) = (directions(&PAIR, false), half_vector());
    let expected = [i[2] + 10.0 * o[2], h[2] + 10.0 * dot(i, o), dot(i, h) + 10.0 * i[0]];
    assert_near(&value("a.glsl", text, &plain(), &[]), expected);
}

#[test]
fn roles_can_be_given() {
    let text = "fn f(a: vec3f, c: f32, n: vec3f, x: vec3f) -> vec3f { return vec3f(a.x, c, x.y) + 0.0 * n; }";
    let roles = [("a", "-L"), ("c", "NdotV"), ("x", "V")].map(|(name, role)| (name.into(), role.into()));
    let options = with(|options| options.roles = roles.to_vec());
    let [i, o] = directions(&PAIR, false);
    assert_near(&value("a.wgsl", text, &options, &[]), [-i[0], o[2], o[1]]);
    let text = refusal("a.wgsl", text, &with(|options| options.roles = vec![("q".into(), "L".into())]));
    assert!(text.contains("\"q\"") || text.contains("no BRDF"), "{text}");
}

/// A turn and no mirror image: x × y = z in the shader's frame, too.
#[test]
fn another_axis_can_be_the_normal() {
    let text = "fn f(l: vec3f, v: vec3f, n: vec3f, t: vec3f, b: vec3f) -> vec3f {
        return vec3f(l.y, dot(cross(t, b), n), n.y + dot(l, b)); }";
    let [i, _] = directions(&PAIR, false);
    assert_near(
        &value("a.wgsl", text, &with(|options| options.up = UpAxis::Y), &[]),
        [i[2], 1.0, 1.0 + i[1]],
    );
}

#[test]
fn what_was_understood_is_said() {
    let text =
        "fn brdf(n: vec3f, l: vec3f, v: vec3f, color: vec3f, roughness: f32) -> vec3f { return color; }";
    let function = read("a.wgsl", text, &plain()).unwrap();
    let range = |name: &str, low, high| ParameterRange::new(name, low, high).unwrap();
    let ranges =
        [("x", 0.0), ("y", 0.5), ("z", 0.5)].map(|(axis, low)| range(&format!("color.{axis}"), low, 1.0));
    let ranges = [ranges.to_vec(), vec![range("roughness", 0.1, 1.0)]].concat();
    assert_eq!(
        function.describe(&ranges),
        "brdf(n = normal, l = wi, v = wo, color = 0..1, 0.5..1, roughness = 0.1..1) → vec3f"
    );
    assert_eq!(function.settable(), ["color: vec3<f32>", "roughness: f32"]);
    assert!(function.name().ends_with("a.wgsl#brdf"), "{}", function.name());
}

// ---- Results ---------------------------------------------------------------------------------------

#[test]
fn a_member_of_the_result_can_be_the_brdf() {
    let text = "struct R { diffuse: vec3f, specular: f32 } fn f(l: vec3f, v: vec3f) -> R { return R(vec3f(1.0), 2.0); }";
    let text_of = |result: &str| with(|options| options.result = Some(result.into()));
    assert_eq!(value("a.wgsl", text, &text_of("specular"), &[]), [2.0]);
    assert!(refusal("a.wgsl", text, &plain()).contains("diffuse, specular"));
    assert!(refusal("a.wgsl", text, &text_of("coat")).contains("there are diffuse, specular"));
    let out = "void f(vec3 l, vec3 v, inout vec4 color) { color = vec4(1.0, 2.0, 3.0, 4.0); }";
    assert_eq!(value("a.frag", out, &plain(), &[]), [1.0, 2.0, 3.0]);
}

// ---- Entries ---------------------------------------------------------------------------------------

#[test]
fn the_only_function_that_fits_needs_no_name() {
    let text = "fn D_GGX(NdotH: f32, a: f32) -> f32 { return a; }
        fn F_Schlick(f0: vec3f, VdotH: f32) -> vec3f { return f0; }
        fn V_Smith(NdotL: f32, NdotV: f32) -> f32 { return 1.0; }
        fn specular(l: vec3f, v: vec3f) -> f32 { return 0.2; }
        @compute @workgroup_size(1) fn main() { }";
    assert_eq!(read("a.wgsl", text, &plain()).unwrap().entry(), "specular");
    let entry = |name: &str| refusal("a.wgsl", text, &with(|options| options.entry = Some(name.into())));
    assert!(entry("D_GGX").contains("distribution of normals"), "{}", entry("D_GGX"));
    assert!(entry("F_Schlick").contains("Fresnel"), "{}", entry("F_Schlick"));
    assert!(entry("main").contains("entry point"), "{}", entry("main"));
    assert!(entry("none").contains("there are D_GGX"), "{}", entry("none"));
    let two = format!("{text}\nfn diffuse(normal: vec3f, l: vec3f, v: vec3f) -> f32 {{ return 0.3; }}");
    let refused = refusal("a.wgsl", &two, &plain());
    assert!(refused.contains("#specular") && refused.contains("#diffuse   (normal = normal"), "{refused}");
    let refused = refusal("a.wgsl", "fn f(color: vec3f) -> vec3f { return color; }", &plain());
    assert!(refused.contains("no direction"), "{refused}");
}

// ---- Files -----------------------------------------------------------------------------------------

/// What the function does not reach may be anything that parses into declarations.
#[test]
fn only_what_is_reached_must_be_valid() {
    let text = "\u{feff}#import engine::nowhere\nfn other() -> f32 { return missing(1) + nowhere::x(); }
        @group(0) @binding(0) var map: texture_cube<f32>;
        fn f(l: vec3f, v: vec3f) -> f32 { return 0.25; }";
    assert_eq!(value("a.wgsl", text, &plain(), &[]), [0.25]);
}

#[test]
fn glsl_is_taken_as_it_is() {
    let text = "#version 300 es\nprecision highp float;\n#define PI 3.14159265\n#define saturate(x) clamp(x, 0.0, 1.0)
        uniform sampler2D unused; in vec2 uv;
        struct Material { vec3 f0; float roughness; };
        float f(Unknown x) { return 1.0; }
        vec3 f(const in vec3 L, const in vec3 V, Material m) { return saturate(m.f0 * m.roughness * 4.0) / PI; }
        void main() { }";
    let near = value("a.frag", text, &plain(), &[1.0, 0.5, 0.25, 0.5]);
    assert_near(&near, [1.0, 1.0, 0.5].map(|x| x / std::f32::consts::PI));
}

#[test]
fn uniforms_are_parameters() {
    let wgsl = "struct U { a: f32, b: vec3f } @group(0) @binding(3) var<uniform> u: U; override K: f32;
        fn f(l: vec3f, v: vec3f) -> vec3f { return u.b * u.a * K; }";
    assert_eq!(value("a.wgsl", wgsl, &plain(), &[2.0, 1.0, 2.0, 3.0, 10.0]), [20.0, 40.0, 60.0]);
    let glsl = "uniform float gain; layout(std140, binding = 1) uniform Block { vec3 color1; };
        vec3 f(vec3 l, vec3 v) { return gain * color1; }";
    assert_eq!(value("a.frag", glsl, &plain(), &[2.0, 1.0, 2.0, 3.0]), [2.0, 4.0, 6.0]);
}

#[test]
fn textures_are_bound() {
    let text = "@group(0) @binding(0) var lut: texture_2d<f32>; @group(2) @binding(1) var s: sampler;
        fn f(l: vec3f, v: vec3f, r: f32) -> f32 { return textureSampleLevel(lut, s, vec2f(r, 0.5), 0.0).y; }";
    let bound = |linear| {
        let mut function = read("a.wgsl", text, &plain()).unwrap();
        assert_eq!(function.unbound(), Some("lut"));
        let texels = vec![[0.0, 1.0, 0.0, 1.0], [0.0, 3.0, 0.0, 1.0]];
        let texture = ShaderTexture::new(2, 1, texels).unwrap();
        function.bind("lut", ShaderResource::Texture(texture)).unwrap();
        function.bind("s", ShaderResource::Sampler { linear, repeat: false }).unwrap();
        assert!(function.bind("none", ShaderResource::Sampler { linear, repeat: false }).is_err());
        evaluate(function, &[0.5])[0]
    };
    assert_eq!(bound(true), 2.0);
    assert_eq!(bound(false), 3.0);
}

/// A module of naga_oil, one of WESL, and a chunk, each in its own file.
#[test]
fn files_come_together() {
    let main = "#import engine::math::{PI, scale as s}\n#include \"chunk.glsl\"\n#ifdef COAT\nconst COATED = 2.0;\n#else\nconst COATED = 1.0;\n#endif
        fn f(l: vec3f, v: vec3f) -> f32 { return s(PI) * engine::math::PI * chunk() * COATED; }";
    let math =
        "#define_import_path engine::math\nconst PI = 3.0;\nfn scale(x: f32) -> f32 { return x * 2.0; }\n";
    let dir = folder(&[
        ("main.wgsl", main),
        ("inc/math.wgsl", math),
        ("inc/chunk.glsl", "fn chunk() -> f32 { return 0.5; }"),
    ]);
    let options = with(|options| {
        options.includes = vec![dir.path().join("inc")];
        options.defines = vec![("COAT".into(), "1".into())];
    });
    assert_eq!(evaluate(UserFunction::read(&dir.path().join("main.wgsl"), &options).unwrap(), &[]), [18.0]);

    let main = "import package::util::{PI, math};\nimport other::color::tint;\n
        fn f(l: vec3f, v: vec3f) -> f32 { @if(COAT) return 0.0; return PI * math::twice(1.0) * tint(); }";
    let dir = folder(&[
        ("shaders/main.wesl", main),
        ("util.wesl", "const PI = 3.0;"),
        ("util/math.wesl", "import super::helper;\nfn twice(x: f32) -> f32 { return helper::two() * x; }"),
        ("util/helper.wesl", "fn two() -> f32 { return 2.0; }"),
        ("packages/other-1.0.0/src/color.wesl", "fn tint() -> f32 { return 0.5; }"),
    ]);
    let options = with(|options| options.includes = vec![dir.path().join("packages")]);
    assert_eq!(
        evaluate(UserFunction::read(&dir.path().join("shaders/main.wesl"), &options).unwrap(), &[]),
        [3.0]
    );
}

#[test]
fn a_module_that_is_missing_is_named_where_it_is_needed() {
    let text = "#import engine::math::PI\nfn f(l: vec3f, v: vec3f) -> f32 { return PI; }";
    let refused = refusal("a.wgsl", text, &plain());
    assert!(refused.contains("a.wgsl:2") && refused.contains("engine::math::PI"), "{refused}");
}

/// The line of a fault is the one in the user's file, whatever was included and translated before it.
#[test]
fn errors_have_the_lines_of_their_files() {
    let before = "float helper(float x) {\n  return x;\n}\n";
    let main = "#include \"before.glsl\"\n/* a comment\n   of two lines */\n#ifdef NO\nfloat no;\n#endif\nvec3 f(vec3 l, vec3 v) { return vec3(helper(wrong)); }\n";
    for (name, text, place) in [
        ("main.glsl", main.to_owned(), "main.glsl:7:"),
        (
            "main.wgsl",
            "#define X 1\n\nfn f(l: vec3f, v: vec3f) -> f32 {\n  return X + wrong;\n}\n".into(),
            "main.wgsl:4:",
        ),
        (
            "main.wgsl",
            "fn f(l: vec3f, v: vec3f) -> f32 {\n  var a: array<f32, 2>;\n  return vec2f(a[0], 1);\n}\n"
                .into(),
            "main.wgsl:3:",
        ),
    ] {
        let dir = folder(&[(name, text.as_str()), ("before.glsl", before)]);
        let error = UserFunction::read(&dir.path().join(name), &plain()).unwrap_err().to_string();
        assert!(error.contains(place), "{error}");
    }
    let dir = folder(&[("main.glsl", main), ("before.glsl", "\nfloat helper(float x) { return y; }\n")]);
    let error = UserFunction::read(&dir.path().join("main.glsl"), &plain()).unwrap_err().to_string();
    assert!(error.contains("before.glsl:2:"), "{error}");
}

/// Names of ours do not clash with the user's, nor with an argument or function called as a local of ours.
#[test]
fn names_do_not_clash() {
    let text = "const gonio_wi = 0.5; fn k(l: vec3f, v: vec3f, gonio_main: f32) -> f32 { return gonio_wi * gonio_main; }";
    assert_eq!(value("a.wgsl", text, &plain(), &[0.5]), [0.25]);
}

// ---- The command -----------------------------------------------------------------------------------

#[cfg(feature = "cli")]
mod command {
    use super::{Path, folder};
    use std::process::{Command, Output};

    fn gonio(dir: &Path, arguments: &[&str]) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_gonio"));
        command.current_dir(dir).args(["check", "--budget", "20000"]).args(arguments).output().unwrap()
    }

    fn text(bytes: &[u8]) -> String {
        String::from_utf8_lossy(bytes).into_owned()
    }

    const SHADER: &str = "struct Layer { color: vec3f, on: bool }
        fn diffuse(n: vec3f, l: vec3f, v: vec3f, layers: array<Layer, 1>) -> vec3f { return layers[0].color / 3.0; }
        fn other(l: vec3f, v: vec3f) -> f32 { return 0.3; }";

    #[test]
    fn a_shader_is_a_file_and_a_function() {
        let dir = folder(&[("a.wgsl", SHADER)]);
        let set = ["--set", "layers[0].color=0.5,0..0.5,0.1", "--set", "layers[0].on=false"];
        let run = gonio(dir.path(), &[&["a.wgsl#diffuse", "--json"][..], &set].concat());
        let json: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
        assert_eq!(json["subject"], "a.wgsl#diffuse");
        let understood = "diffuse(n = normal, l = wi, v = wo, layers[0].color = 0.5, 0..0.5, 0.1, layers[0].on = 0) → vec3f";
        assert_eq!(json["understood"], understood);
        // What it prints can be given back.
        let eval = json["findings"][2]["input"]["eval"].as_str().unwrap();
        assert!(eval.starts_with("--set 'layers[0].color=0.5,"), "{eval}");
        let sets =
            eval.split("--set ").skip(1).map(|set| set.split_whitespace().next().unwrap().trim_matches('\''));
        let mut arguments = vec!["a.wgsl#diffuse"];
        sets.for_each(|set| arguments.extend(["--set", set]));
        let run = gonio(dir.path(), &arguments);
        assert_eq!(run.status.code(), Some(0), "{}{}", text(&run.stdout), text(&run.stderr));
    }

    /// Exponents are called nu and nv, cosines too.
    #[test]
    fn what_is_set_is_a_parameter() {
        let shader =
            "fn f(wi: vec3f, wo: vec3f, nu: f32, nv: f32) -> f32 { return 0.3 / max(1.0, nu + nv); }";
        let dir = folder(&[("a.wgsl", shader)]);
        let run = gonio(dir.path(), &["a.wgsl", "--set", "nu=1..9", "--set", "nv=1..9"]);
        assert_eq!(run.status.code(), Some(0), "{}{}", text(&run.stdout), text(&run.stderr));
    }

    /// A repository keeps its exceptions beside the shader; a file that cannot be read is not passed over.
    #[test]
    fn exceptions_stand_beside_the_shader() {
        let shader = "fn f(wi: vec3f, wo: vec3f) -> f32 { return 0.5; }";
        let code = |files: &[(&str, &str)]| {
            let dir = folder(files);
            gonio(dir.path(), &["a.wgsl"]).status.code()
        };
        assert_eq!(code(&[("a.wgsl", shader)]), Some(1));
        assert_eq!(code(&[("a.wgsl", shader), ("gonio-check.toml", "[allow]\nenergy = 1.58")]), Some(0));
        assert_eq!(code(&[("a.wgsl", shader), ("gonio-check.toml", "[allow]\nenergy = 1.56")]), Some(1));
        assert_eq!(code(&[("a.wgsl", shader), ("gonio-check.toml/a", "")]), Some(2));
    }

    #[test]
    fn faults_say_what_to_write() {
        let texture = "@group(0) @binding(0) var lut: texture_2d<f32>; fn f(l: vec3f, v: vec3f) -> f32 { return textureLoad(lut, vec2u(0u), 0).x; }";
        let dir = folder(&[("a.wgsl", SHADER), ("t.wgsl", texture)]);
        for (arguments, words) in [
            (vec!["a.wgsl"], "a.wgsl#other"),
            (vec!["a.wgsl#diffuse"], "--set layers[0].color=VALUE"),
            (vec!["a.wgsl#diffuse", "--set", "layers=1,2"], "4 components"),
            (
                vec!["a.wgsl#diffuse", "--set", "roughness=1"],
                "layers[0].color: vec3<f32>, layers[0].on: bool",
            ),
            (vec!["a.wgsl#other", "--role", "l"], "--role x=NdotL"),
            (vec!["a.wgsl#other", "--up", "w"], "--up"),
            (vec!["t.wgsl"], "--bind lut=FILE"),
            (vec!["t.wgsl", "--bind", "lut=none.png"], "none.png"),
            (vec!["recipe.toml", "--up", "y"], "--up is for a shader"),
        ] {
            let run = gonio(dir.path(), &arguments);
            assert_eq!(run.status.code(), Some(2), "{arguments:?}");
            assert!(text(&run.stderr).contains(words), "{arguments:?}: {}", text(&run.stderr));
        }
    }
}
