//! glTF's material extensions: the material's f is the formula of each extension's text, evaluated here in f64 from unit
//! vectors, with nothing of the crate's.

use crate::common::*;

use gonio::bake::Unobserved;
use gonio::base::angles::Angles;
use gonio::check::Check;
use gonio::plan::TablePlan;
use gonio::scene::planner::{Plan, Selection};
use gonio::scene::{Material, Scene, Weights, parse_recipe, read};
use gonio::table::axis::Variable;
use gonio::table::quantity::RHO_DH;
use gonio::verify::{Subject, Sum, Verdict, VerifyOptions, check};
use serde_json::{Value, json};
use std::f64::consts::PI;
use std::path::Path;
use tempfile::TempDir;

// ---- The texts ----------------------------------------------------------------------------------

/// A material as the texts have it.
struct Text {
    base_color: [f64; 3],
    metallic: f64,
    roughness: f64,
    f0: [f64; 3],
    specular: f64,
    strength: f64,
    transmission: f64,
    coat: [f64; 2],
    sheen: [f64; 3],
    sheen_roughness: f64,
    diffuse_roughness: f64,
}

const PLAIN: Text = Text {
    base_color: [0.8, 0.5, 0.2],
    metallic: 0.3,
    roughness: 0.6,
    f0: [0.04; 3],
    specular: 1.0,
    strength: 0.0,
    transmission: 0.0,
    coat: [0.0, 0.0],
    sheen: [0.0; 3],
    sheen_roughness: 0.5,
    diffuse_roughness: 0.0,
};

type Vector = [f64; 3];

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn direction(theta: f64, phi: f64) -> Vector {
    [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()]
}

/// D · V of GGX, αt along the tangent and αb along the bitangent.
fn specular_brdf(l: Vector, v: Vector, h: Vector, [at, ab]: [f64; 2]) -> f64 {
    let d = 1.0 / (PI * at * ab * ((h[0] / at).powi(2) + (h[1] / ab).powi(2) + h[2].powi(2)).powi(2));
    let length = |w: Vector| (at * at * w[0] * w[0] + ab * ab * w[1] * w[1] + w[2] * w[2]).sqrt();
    d * 0.5 / (l[2] * length(v) + v[2] * length(l))
}

/// KHR_materials_sheen: `sheenDistribution · sheenVisibility`.
fn sheen_brdf(l: Vector, v: Vector, h: Vector, roughness: f64) -> f64 {
    let alpha = roughness * roughness;
    let d = (2.0 + 1.0 / alpha) * (h[0] * h[0] + h[1] * h[1]).powf(0.5 / alpha) / (2.0 * PI);
    let mix = |a: f64, b: f64| a + (b - a) * (1.0 - alpha).powi(2);
    let fit = |x: f64| {
        let (b, c) = (mix(3.82987, 3.32435), mix(0.19823, 0.16801));
        mix(21.5473, 25.3245) / (1.0 + b * x.powf(c)) + mix(-1.97760, -1.27393) * x + mix(-4.32054, -4.85967)
    };
    let lambda = |x: f64| if x < 0.5 { fit(x).exp() } else { (2.0 * fit(0.5) - fit(1.0 - x)).exp() };
    d / ((1.0 + lambda(v[2]) + lambda(l[2])) * 4.0 * v[2] * l[2])
}

fn halfway(l: Vector, v: Vector) -> Vector {
    let sum: Vector = std::array::from_fn(|k| l[k] + v[k]);
    sum.map(|x| x / dot(sum, sum).sqrt())
}

/// Its E(cos θ), at most 1: the double exponential rule in θ, on both sides of the fit's seam at 60°, and the mean over φ.
/// For 1/α an even number f is smooth where h is n.
fn sheen_albedo(cos: f64, roughness: f64) -> f64 {
    const AZIMUTHS: usize = 200;
    let v = direction(cos.acos(), 0.0);
    let mut sum = 0.0;
    for [from, to] in [[0.0, PI / 3.0], [PI / 3.0, PI / 2.0]] {
        for k in -40..=40 {
            let t = 0.08 * f64::from(k);
            let s = PI * t.sinh();
            let x = 1.0 / (1.0 + (-s).exp());
            let theta = from + (to - from) * x;
            let weight = (to - from) * 0.08 * PI * t.cosh() * x * (1.0 - x) * theta.sin() * theta.cos();
            if weight < 1e-14 {
                continue;
            }
            let f = |j: usize| {
                let l = direction(theta, 2.0 * PI * (j as f64 + 0.5) / AZIMUTHS as f64);
                sheen_brdf(l, v, halfway(l, v), roughness)
            };
            sum += weight * 2.0 * PI / AZIMUTHS as f64 * (0..AZIMUTHS).map(f).sum::<f64>();
        }
    }
    sum.min(1.0)
}

/// KHR_materials_diffuse_roughness: V-cavities of Lambertian facets, whose slope angle has the deviation σ = π/2 · roughness.
fn rough_diffuse(l: Vector, v: Vector, roughness: f64) -> f64 {
    let s2 = (PI / 2.0 * roughness).powi(2);
    let (theta_l, theta_v) = (l[2].acos(), v[2].acos());
    let cos_phi = (l[0] * v[0] + l[1] * v[1]) / (theta_l.sin() * theta_v.sin()).max(1e-300);
    let b =
        0.45 * s2 / (s2 + 0.09) * cos_phi.max(0.0) * theta_l.max(theta_v).sin() * theta_l.min(theta_v).tan();
    (1.0 - 0.5 * s2 / (s2 + 0.33) + b) / PI
}

impl Text {
    /// f(L, V).
    fn brdf(&self, l: Vector, v: Vector) -> [f64; 3] {
        let h = halfway(l, v);
        let weight = (1.0 - dot(v, h).abs()).powi(5);
        let mix = |a: f64, b: f64, t: f64| a * (1.0 - t) + b * t;
        let alpha = self.roughness.powi(2);
        let specular_brdf_base =
            specular_brdf(l, v, h, [mix(alpha, 1.0, self.strength * self.strength), alpha]);
        let fresnel = self.f0.map(|f0| mix(f0.min(1.0) * self.specular, self.specular, weight));
        let max = fresnel.into_iter().fold(0.0, f64::max);
        let material: [f64; 3] = std::array::from_fn(|k| {
            let rough = rough_diffuse(l, v, self.diffuse_roughness);
            let diffuse = self.base_color[k] * rough * (1.0 - self.transmission);
            let dielectric = fresnel[k] * specular_brdf_base + (1.0 - max) * diffuse;
            let metal = mix(self.base_color[k], 1.0, weight) * specular_brdf_base;
            mix(dielectric, metal, self.metallic)
        });
        let most = self.sheen.into_iter().fold(0.0, f64::max);
        let scaling = match most {
            0.0 => 1.0,
            most => {
                let e = |w: Vector| 1.0 - most * sheen_albedo(w[2], self.sheen_roughness);
                f64::min(e(v), e(l))
            }
        };
        let sheen = sheen_brdf(l, v, h, self.sheen_roughness);
        let material: [f64; 3] = std::array::from_fn(|k| self.sheen[k] * sheen + material[k] * scaling);
        let [clearcoat, coat_roughness] = self.coat;
        let coat_fresnel = 0.04 + 0.96 * (1.0 - v[2].abs()).powi(5);
        let coat = specular_brdf(l, v, h, [coat_roughness.powi(2).max(1e-9); 2]);
        material.map(|f| mix(f, coat, clearcoat * coat_fresnel))
    }
}

// ---- Files --------------------------------------------------------------------------------------

fn scene(text: &Text, extensions: Value) -> Scene {
    try_scene(text, extensions).unwrap()
}

fn try_scene(text: &Text, extensions: Value) -> gonio::Result<Scene> {
    let [r, g, b] = text.base_color;
    let root = json!({
        "asset": { "version": "2.0" },
        "materials": [{
            "name": "M",
            "pbrMetallicRoughness": {
                "baseColorFactor": [r, g, b, 1], "metallicFactor": text.metallic, "roughnessFactor": text.roughness
            },
            "extensions": extensions,
        }],
        "images": [{ "uri": "gone.png" }],
        "textures": [{ "source": 0 }],
    });
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("x.gltf");
    std::fs::write(&path, root.to_string()).unwrap();
    read(&path)
}

fn models(material: &Material) -> Vec<&str> {
    material.lobes.iter().map(|lobe| lobe.model.as_str()).collect()
}

const CHARLIE: &str = "charlie-smith-correlated-none";

/// Away from grazing: some ten roundings of f32 for each lobe; of Charlie's 266 for Λ and nine for the exponent, 10 at most
/// for these directions, of D (src/model/ndf/charlie.rs).
fn tolerance(text: &Text) -> f64 {
    if text.sheen == [0.0; 3] { 1e-6 } else { (40.0 + 266.0 + 90.0) / f64::from(1 << 24) }
}

/// The largest relative difference between the material and its text. Factors come as f32's shortest decimals.
fn difference(text: &Text, material: &Material) -> f64 {
    let mut worst = 0.0_f64;
    for evaluator in evaluators() {
        let mut subject = Sum::material(evaluator, material).unwrap();
        for &(theta_i, phi_i, theta_e, phi_e) in &[
            (0.0, 0.0, 0.5, 1.0),
            (0.3, 0.2, 0.9, 2.5),
            (1.2, 0.7, 1.3, 3.6),
            (1.5, 2.0, 0.4, 5.5),
            (0.7, 1.0, 0.7, 1.0),
        ] {
            let angles = Angles { theta_i, phi_i, theta_e, phi_e };
            let mut f = Vec::new();
            subject.evaluate(&[], &[angles], &mut f).unwrap();
            let expected = text.brdf(direction(theta_i, phi_i), direction(theta_e, phi_e));
            for (f, expected) in f.iter().zip(expected) {
                worst = worst.max((f64::from(*f) / expected - 1.0).abs());
            }
        }
    }
    worst
}

#[test]
fn materials_are_what_the_texts_say() {
    let f0 = |ior: f64| ((ior - 1.0) / (ior + 1.0)).powi(2);
    let cases = [
        ("plain", PLAIN, json!({}), vec!["gltf_diffuse", "ggx"]),
        (
            "ior",
            Text { f0: [f0(1.8); 3], ..PLAIN },
            json!({ "KHR_materials_ior": { "ior": 1.8 } }),
            vec!["gltf_diffuse", "ggx"],
        ),
        (
            "ior 0 is a mirror's F",
            Text { f0: [1.0; 3], ..PLAIN },
            json!({ "KHR_materials_ior": { "ior": 0 } }),
            vec!["ggx"],
        ),
        (
            "specular",
            Text { f0: [0.08, 0.02, 0.012], specular: 0.4, ..PLAIN },
            json!({ "KHR_materials_specular": { "specularFactor": 0.4, "specularColorFactor": [2, 0.5, 0.3] } }),
            vec!["gltf_diffuse", "lambert", "ggx"],
        ),
        (
            "ior and specular, clamped",
            Text { f0: [1.0, 0.5 * f0(3.0), 0.0], specular: 0.7, ..PLAIN },
            json!({
                "KHR_materials_specular": { "specularFactor": 0.7, "specularColorFactor": [9, 0.5, 0] },
                "KHR_materials_ior": { "ior": 3 },
            }),
            vec!["lambert", "ggx"],
        ),
        (
            "clearcoat",
            Text { coat: [0.8, 0.3], ..PLAIN },
            json!({ "KHR_materials_clearcoat": { "clearcoatFactor": 0.8, "clearcoatRoughnessFactor": 0.3 } }),
            vec!["gltf_diffuse", "ggx", "ggx-smith-correlated-none"],
        ),
        (
            "anisotropy",
            Text { strength: 0.7, ..PLAIN },
            json!({ "KHR_materials_anisotropy": { "anisotropyStrength": 0.7 } }),
            vec!["gltf_diffuse", "ggx-anisotropic"],
        ),
        (
            "transmission takes its share",
            Text { transmission: 0.75, ..PLAIN },
            json!({ "KHR_materials_transmission": { "transmissionFactor": 0.75 } }),
            vec!["gltf_diffuse", "ggx"],
        ),
        (
            "diffuse roughness",
            Text { diffuse_roughness: 0.7, ..PLAIN },
            json!({ "KHR_materials_diffuse_roughness": { "diffuseRoughnessFactor": 0.7 } }),
            vec!["gltf_oren_nayar", "ggx"],
        ),
        (
            "diffuse roughness below a weak specular lobe",
            Text { diffuse_roughness: 0.25, specular: 0.5, ..PLAIN },
            json!({
                "KHR_materials_diffuse_roughness": { "diffuseRoughnessFactor": 0.25 },
                "KHR_materials_specular": { "specularFactor": 0.5 },
            }),
            vec!["gltf_oren_nayar", "oren-nayar", "ggx"],
        ),
        (
            "sheen",
            Text { sheen: [0.8, 0.3, 0.0], ..PLAIN },
            json!({ "KHR_materials_sheen": { "sheenColorFactor": [0.8, 0.3, 0], "sheenRoughnessFactor": 0.5 } }),
            vec!["gltf_diffuse", "ggx", CHARLIE],
        ),
        (
            "sheen below a coat, upon a rough one",
            Text { sheen: [0.2, 0.3, 0.9], coat: [0.6, 0.3], diffuse_roughness: 1.0, ..PLAIN },
            json!({
                "KHR_materials_sheen": { "sheenColorFactor": [0.2, 0.3, 0.9], "sheenRoughnessFactor": 0.5 },
                "KHR_materials_clearcoat": { "clearcoatFactor": 0.6, "clearcoatRoughnessFactor": 0.3 },
                "KHR_materials_diffuse_roughness": { "diffuseRoughnessFactor": 1 },
            }),
            vec!["gltf_oren_nayar", "ggx", CHARLIE, "ggx-smith-correlated-none"],
        ),
        (
            "all",
            Text { f0: [0.5 * f0(1.7); 3], specular: 0.6, strength: 0.5, coat: [0.5, 0.4], ..PLAIN },
            json!({
                "KHR_materials_ior": { "ior": 1.7 },
                "KHR_materials_specular": { "specularFactor": 0.6, "specularColorFactor": [0.5, 0.5, 0.5] },
                "KHR_materials_anisotropy": { "anisotropyStrength": 0.5 },
                "KHR_materials_clearcoat": { "clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 0.4 },
            }),
            vec!["gltf_diffuse", "lambert", "ggx-anisotropic", "ggx-smith-correlated-none"],
        ),
    ];
    for (what, text, extensions, lobes) in cases {
        let scene = scene(&text, extensions);
        let material = &scene.materials[0];
        assert_eq!(models(material), lobes, "{what}");
        let difference = difference(&text, material);
        println!("{what}: {difference:.1e}");
        assert!(difference < tolerance(&text), "{what}: {difference:e}");
        Plan::new(&scene, &Selection::default()).unwrap();
    }
}

/// A film's F is the model's (tests/suite/thin_film.rs has its formula); here: what it is of, and its share.
#[test]
fn a_film_is_mixed_by_its_factor() {
    let film =
        json!({ "iridescenceFactor": 0.25, "iridescenceIor": 1.4, "iridescenceThicknessMaximum": 500 });
    let made = scene(&PLAIN, json!({ "KHR_materials_iridescence": film }));
    let material = &made.materials[0];
    let film = "ggx-smith-correlated-thin-film";
    assert_eq!(models(material), ["gltf_diffuse", film, film, "ggx"]);
    let of = |lobe: usize, name: &str| {
        let given = &material.lobes[lobe].parameters;
        given.iter().find(|(known, _)| known == name).unwrap().1
    };
    assert_eq!((of(1, "f0"), of(2, "f0")), ([0.04; 3], PLAIN.base_color));
    assert_eq!((of(1, "thickness"), of(1, "film_eta")), ([500.0; 3], [1.4; 3]));
    let shares: Vec<_> = [1, 2]
        .map(|lobe: usize| match &material.lobes[lobe].weights {
            Weights::Constant([[r, ..], _]) => *r,
            Weights::Textured(_) => f64::NAN,
        })
        .into();
    assert!((shares[0] - 0.25 * 0.7).abs() < 1e-12 && (shares[1] - 0.25 * 0.3).abs() < 1e-12, "{shares:?}");
    assert!(made.warnings.iter().any(|warning| warning.contains("diffuse lobe below the film")));
    Plan::new(&made, &Selection::default()).unwrap();

    // Where it is metal all of it is the film's.
    let full = json!({ "KHR_materials_iridescence": { "iridescenceFactor": 1 } });
    let metal = scene(&Text { metallic: 1.0, ..PLAIN }, full);
    assert_eq!(models(&metal.materials[0]), [film]);
    assert_eq!(metal.warnings, [""; 0]);
    let thin = json!({ "KHR_materials_iridescence": { "iridescenceFactor": 1, "iridescenceIor": 1.05 } });
    let refused = scene(&PLAIN, thin);
    assert!(refused.warnings[0].contains("left out"), "{:?}", refused.warnings);
}

/// Textures make formulas of weights; a coat whose strength varies is with and without, by formulas.
#[test]
fn what_varies_is_said_in_formulas() {
    let made = scene(
        &PLAIN,
        json!({
            "KHR_materials_specular": { "specularFactor": 0.5, "specularTexture": { "index": 0 } },
            "KHR_materials_clearcoat": { "clearcoatFactor": 0.8, "clearcoatTexture": { "index": 0 },
                "clearcoatRoughnessFactor": 0.5 },
        }),
    );
    let material = &made.materials[0];
    let words: Vec<_> = material
        .lobes
        .iter()
        .map(|lobe| match &lobe.weights {
            Weights::Textured([a, b]) => format!("{} {}: {a}; {b}", lobe.model, lobe.factors.len()),
            Weights::Constant(_) => lobe.model.clone(),
        })
        .collect();
    println!("{words:#?}");
    assert_eq!(words.len(), 7);
    assert_eq!(words[0], "gltf_diffuse 0: 0.96 specular (1 − metallic) base_color (1 − clearcoat); 0");
    assert_eq!(words[3], "lambert 1: (1 − specular) (1 − metallic) base_color clearcoat; 0");
    assert_eq!(words[6], "ggx-smith-correlated-none 1: clearcoat; 0");
    let names: Vec<_> = material.varying().into_iter().map(|(name, _)| name).collect();
    for name in ["specular", "clearcoat"] {
        assert!(names.iter().any(|known| known == name), "{names:?}");
    }
    // At one setting it is the text's.
    let value = |name: &str| match name {
        "specular" => 0.3,
        "clearcoat" => 0.6,
        "metallic" => PLAIN.metallic,
        _ => 0.5,
    };
    let setting: Vec<_> = names.iter().map(|name| (name.clone(), value(name))).collect();
    let text = Text { base_color: [0.5; 3], specular: 0.3, coat: [0.6, 0.5], ..PLAIN };
    let difference = difference(&text, &material.at(&setting).unwrap());
    assert!(difference < 1e-6, "{difference:e}");
    Plan::new(&made, &Selection::default()).unwrap();
}

/// A sheen whose colour and roughness vary: what lies below it stands twice, with formulas, and E is of the roughness that
/// the sheen has at a place.
#[test]
fn a_sheen_that_varies_is_said_in_formulas() {
    let sheen = json!({
        "sheenColorFactor": [0.9, 0.9, 0.9], "sheenColorTexture": { "index": 0 },
        "sheenRoughnessFactor": 0.8, "sheenRoughnessTexture": { "index": 0 },
    });
    let made = scene(&PLAIN, json!({ "KHR_materials_sheen": sheen }));
    let [warning] = &made.warnings[..] else { panic!("{:?}", made.warnings) };
    for word in ["sheenRoughnessTexture", "gone.png", "[0, 0.8]"] {
        assert!(warning.contains(word), "{warning}");
    }
    let material = &made.materials[0];
    assert_eq!(models(material), ["gltf_diffuse", "gltf_diffuse", "ggx", "ggx", CHARLIE]);
    let words = |lobe: usize| match &material.lobes[lobe].weights {
        Weights::Textured([a, _]) => a.to_string(),
        Weights::Constant(_) => String::new(),
    };
    assert_eq!(words(0), "0.96 (1 − metallic) base_color (1 − max(sheen_color))");
    assert_eq!(words(1), "0.96 (1 − metallic) base_color max(sheen_color)");
    assert_eq!(words(4), "sheen_color");
    assert!(material.lobes[0].factors.is_empty());
    assert!(material.lobes[1].factors[0].describe().contains("at its roughness"));
    let setting: Vec<_> = [("lobes[4].roughness", 0.5), ("base_color", 0.7), ("sheen_color", 0.6)]
        .map(|(name, value)| (name.to_string(), value))
        .into();
    let text = Text { base_color: [0.7; 3], sheen: [0.6; 3], ..PLAIN };
    let difference = difference(&text, &material.at(&setting).unwrap());
    assert!(difference < tolerance(&text), "{difference:e}");
    Plan::new(&made, &Selection::default()).unwrap();
}

/// Recipes say the same as glTF.
#[test]
fn a_recipe_has_a_sheen_too() {
    let recipe = |sheen: &str| {
        let lobes =
            r#"lobes = [{ model = "lambert", albedo = 0.5 }, { model = "ggx", roughness = 0.4, f0 = 0.04 }]"#;
        parse_recipe(Path::new("x.toml"), format!("[materials.M]\n{lobes}\nsheen = {sheen}").as_bytes())
    };
    let made = recipe("{ color = [0.8, 0.3, 0.0], roughness = 0.5 }").unwrap();
    let material = &made.materials[0];
    assert_eq!(models(material), ["lambert", "ggx", CHARLIE]);
    let extension = json!({ "sheenColorFactor": [0.8, 0.3, 0], "sheenRoughnessFactor": 0.5 });
    let same = scene(&PLAIN, json!({ "KHR_materials_sheen": extension }));
    let same = &same.materials[0];
    assert_eq!(material.lobes[2], same.lobes[2]);
    assert_eq!(material.lobes[0].factors, same.lobes[0].factors);
    assert_eq!(material.lobes[1].factors, same.lobes[1].factors);
    for (sheen, why) in
        [("{ color = 2, roughness = 0.5 }", "[0, 1]"), ("{ color = 1 }", "roughness"), ("1", "table")]
    {
        let error = recipe(sheen).unwrap_err().to_string();
        assert!(error.contains("line 3") && error.contains(why), "{error}");
    }
}

/// Integrals of what lies below a sheen agree with the reference, which has an E of its own, down to f32's.
#[test]
fn integrals_below_a_sheen_meet_their_tolerance() {
    let sheen = json!({ "sheenColorFactor": [1, 0.6, 0.2], "sheenRoughnessFactor": 0.3 });
    let rough = json!({ "diffuseRoughnessFactor": 0.5 });
    let made =
        scene(&PLAIN, json!({ "KHR_materials_sheen": sheen, "KHR_materials_diffuse_roughness": rough }));
    for tolerance in [1e-2, 1e-5] {
        let thetas = [0.0, 1.04, 1.06, 1.5, PI / 2.0 - 1e-4];
        let axes = vec![listed(Variable::ThetaI, &thetas)];
        let plan =
            TablePlan::material("t", &RHO_DH, &made, "M", axes).unwrap().with_tolerance(tolerance).unwrap();
        let table = bake(device(), &plan, Check::All);
        println!("to {tolerance}: {:?}", table.error.measured_max);
        assert!(table.error.measured_max.unwrap() <= tolerance, "{:?}", table.error);
    }
}

/// What the way to add layers up breaks is declared, and shown.
#[test]
fn promises_are_kept_or_declared() {
    let coated = json!({
        "KHR_materials_ior": { "ior": 1.2 },
        "KHR_materials_clearcoat": { "clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.3 },
    });
    let velvet = json!({
        "KHR_materials_sheen": { "sheenColorFactor": [0.9, 0.5, 0.7], "sheenRoughnessFactor": 0.3 },
    });
    let text = Text { base_color: [1.0, 0.9, 0.5], metallic: 0.0, ..PLAIN };
    for (extensions, budget) in [(coated, 100_000), (velvet, 20_000)] {
        let made = scene(&text, extensions);
        let mut subject = Sum::material(device(), &made.materials[0]).unwrap();
        let report = check(&mut subject, &VerifyOptions { budget, search: true }, &Unobserved).unwrap();
        for finding in &report.findings {
            println!("{}: {:?} {}", finding.property, finding.verdict, finding.said);
            let declared = ["reciprocity", "energy"].contains(&finding.property);
            let fits = finding.verdict == Verdict::Kept || declared && finding.verdict == Verdict::Declared;
            assert!(fits, "{finding:?}");
        }
    }
}

/// A number beyond its range is taken as the nearest in it, a texture that is not there as one of any texels, and what is
/// no number is refused; each by name.
#[test]
fn what_gltf_does_not_allow_is_said_by_name() {
    for (extension, key, value, said) in [
        ("KHR_materials_ior", "ior", json!(0.5), "is 0.5, which glTF does not allow; it is taken as 1"),
        ("KHR_materials_specular", "specularFactor", json!(2), "taken as 1"),
        ("KHR_materials_specular", "specularColorFactor", json!([1, -1, 1]), "[1] is -1"),
        ("KHR_materials_clearcoat", "clearcoatFactor", json!(-1), "taken as 0"),
        ("KHR_materials_clearcoat", "clearcoatTexture", json!({ "index": 9 }), "textures[9]"),
        ("KHR_materials_clearcoat", "clearcoatTexture", json!({}), "no index"),
        ("KHR_materials_anisotropy", "anisotropyStrength", json!(1.1), "is 1.1"),
        ("KHR_materials_sheen", "sheenColorFactor", json!([0, 2, 0]), "[1] is 2"),
        ("KHR_materials_sheen", "sheenRoughnessFactor", json!(-1), "is -1"),
        ("KHR_materials_sheen", "sheenColorTexture", json!({ "index": 9 }), "textures[9]"),
        ("KHR_materials_diffuse_roughness", "diffuseRoughnessFactor", json!(1.5), "taken as 1"),
        ("KHR_materials_iridescence", "iridescenceIor", json!(0.9), "taken as 1"),
    ] {
        let warnings = scene(&PLAIN, json!({ extension: { key: value } })).warnings;
        let [warning] = &warnings[..] else { panic!("{extension} {key}: {warnings:?}") };
        for word in ["material M: ", extension, key, said] {
            assert!(warning.contains(word), "{warning:?} does not say {word:?}");
        }
    }
    for (extension, key, value, place) in [
        ("KHR_materials_ior", "ior", json!("1.5"), "from 1 on"),
        ("KHR_materials_specular", "specularFactor", json!(null), "[0, 1]"),
        ("KHR_materials_specular", "specularColorFactor", json!([1, 1]), "three numbers"),
    ] {
        let error = try_scene(&PLAIN, json!({ extension: { key: value } })).unwrap_err().to_string();
        for word in ["x.gltf", "materials[0] (M)", extension, key, place] {
            assert!(error.contains(word), "{error:?} does not say {word:?}");
        }
    }
    let error = try_scene(&PLAIN, json!({ "KHR_materials_ior": 5 })).unwrap_err().to_string();
    assert!(error.contains("KHR_materials_ior is no object"), "{error}");
}
