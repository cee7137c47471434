//! Disney's principled BRDF: a recipe's material is the formula of BRDF Explorer's `disney.brdf` (Burley 2012), evaluated here in
//! f64 from unit vectors, with nothing of the crate's.

use crate::common::*;
use crate::promises::value_f32;

use gonio::bake::Unobserved;
use gonio::base::angles::Angles;
use gonio::check::Check;
use gonio::plan::TablePlan;
use gonio::scene::{Material, Scene, parse_recipe};
use gonio::table::axis::Variable;
use gonio::table::quantity::RHO_DH;
use gonio::verify::{Subject, Sum, Verdict, VerifyOptions, check};
use std::f64::consts::PI;
use std::path::Path;

type Vector = [f64; 3];

/// The parameters, by their names there.
#[derive(Clone, Copy)]
struct Disney {
    base_color: [f64; 3],
    metallic: f64,
    subsurface: f64,
    specular: f64,
    roughness: f64,
    specular_tint: f64,
    anisotropic: f64,
    sheen: f64,
    sheen_tint: f64,
    clearcoat: f64,
    clearcoat_gloss: f64,
}

const DEFAULT: Disney = Disney {
    base_color: [0.6, 0.4, 0.1],
    metallic: 0.0,
    subsurface: 0.0,
    specular: 0.5,
    roughness: 0.5,
    specular_tint: 0.0,
    anisotropic: 0.0,
    sheen: 0.0,
    sheen_tint: 0.5,
    clearcoat: 0.0,
    clearcoat_gloss: 1.0,
};

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn mix(a: f64, b: f64, t: f64) -> f64 {
    a + (b - a) * t
}

fn schlick_fresnel(u: f64) -> f64 {
    (1.0 - u).clamp(0.0, 1.0).powi(5)
}

impl Disney {
    /// `BRDF(L, V, N, X, Y)` with N = z, X = x and Y = y. GTR1's 1 + (a² − 1) NdotH², which loses its digits at the peak, is
    /// sin²θm + a² NdotH² here.
    fn brdf(&self, l: Vector, v: Vector) -> [f64; 3] {
        let sum: Vector = std::array::from_fn(|k| l[k] + v[k]);
        let h = sum.map(|x| x / dot(sum, sum).sqrt());
        let [n_l, n_v, l_h] = [l[2], v[2], dot(l, h)];
        let c = self.base_color;
        let luminance = 0.3 * c[0] + 0.6 * c[1] + 0.1 * c[2];
        let (fl, fv, fh) = (schlick_fresnel(n_l), schlick_fresnel(n_v), schlick_fresnel(l_h));
        let fd90 = 0.5 + 2.0 * l_h * l_h * self.roughness;
        let fd = mix(1.0, fd90, fl) * mix(1.0, fd90, fv);
        let fss90 = l_h * l_h * self.roughness;
        let fss = mix(1.0, fss90, fl) * mix(1.0, fss90, fv);
        let ss = 1.25 * (fss * (1.0 / (n_l + n_v) - 0.5) + 0.5);
        let aspect = (1.0 - self.anisotropic * 0.9).sqrt();
        let ax = (self.roughness.powi(2) / aspect).max(0.001);
        let ay = (self.roughness.powi(2) * aspect).max(0.001);
        let d = 1.0 / (PI * ax * ay * ((h[0] / ax).powi(2) + (h[1] / ay).powi(2) + h[2] * h[2]).powi(2));
        let smith =
            |w: Vector| 1.0 / (w[2] + ((w[0] * ax).powi(2) + (w[1] * ay).powi(2) + w[2] * w[2]).sqrt());
        let g = smith(l) * smith(v);
        let a2 = mix(0.1, 0.001, self.clearcoat_gloss).powi(2);
        let dr = (a2 - 1.0) / (PI * a2.ln() * (h[0] * h[0] + h[1] * h[1] + a2 * h[2] * h[2]));
        let fr = mix(0.04, 1.0, fh);
        let smith = |n_v: f64| {
            let (a, b) = (0.25 * 0.25, n_v * n_v);
            1.0 / (n_v + (a + b - a * b).sqrt())
        };
        let gr = smith(n_l) * smith(n_v);
        std::array::from_fn(|k| {
            let tint = if luminance > 0.0 { c[k] / luminance } else { 1.0 };
            let c_spec0 = mix(self.specular * 0.08 * mix(1.0, tint, self.specular_tint), c[k], self.metallic);
            let c_sheen = mix(1.0, tint, self.sheen_tint);
            let f_sheen = fh * self.sheen * c_sheen;
            (mix(fd, ss, self.subsurface) * c[k] / PI + f_sheen) * (1.0 - self.metallic)
                + g * mix(c_spec0, 1.0, fh) * d
                + 0.25 * self.clearcoat * gr * fr * dr
        })
    }

    fn recipe(&self) -> String {
        let Self { base_color: [r, g, b], metallic, subsurface, specular, roughness, .. } = self;
        let Self { specular_tint, anisotropic, sheen, sheen_tint, clearcoat, clearcoat_gloss, .. } = self;
        format!(
            "[materials.paint]\ndisney = {{ base_color = [{r:?}, {g:?}, {b:?}], metallic = {metallic:?}, subsurface = \
             {subsurface:?}, specular = {specular:?}, roughness = {roughness:?}, specular_tint = {specular_tint:?}, \
             anisotropic = {anisotropic:?}, sheen = {sheen:?}, sheen_tint = {sheen_tint:?}, clearcoat = {clearcoat:?}, \
             clearcoat_gloss = {clearcoat_gloss:?} }}"
        )
    }
}

fn scene(text: &str) -> gonio::Result<Scene> {
    parse_recipe(Path::new("x.toml"), text.as_bytes())
}

fn lobes(material: &Material) -> Vec<&str> {
    material.lobes.iter().map(|lobe| lobe.model.as_str()).collect()
}

/// Values are the formula's, at any setting, to what f32 has of the least exact lobe.
#[test]
fn materials_are_what_the_formula_says() {
    const GGX: &str = "ggx-smith-separable-schlick";
    const STRETCHED: &str = "ggx-anisotropic-smith-separable-schlick";
    const CLEARCOAT: &str = "gtr-disney-clearcoat-schlick";
    let cases = [
        (DEFAULT, vec!["burley", GGX]),
        (Disney { metallic: 1.0, roughness: 0.3, ..DEFAULT }, vec![GGX]),
        (Disney { metallic: 0.4, subsurface: 0.3, ..DEFAULT }, vec!["burley", "disney-subsurface", GGX]),
        (Disney { subsurface: 1.0, roughness: 0.9, ..DEFAULT }, vec!["disney-subsurface", GGX]),
        (
            Disney { sheen: 0.8, sheen_tint: 1.0, specular_tint: 0.7, ..DEFAULT },
            vec!["burley", "disney-sheen", GGX],
        ),
        (Disney { anisotropic: 0.9, roughness: 0.6, specular: 1.0, ..DEFAULT }, vec!["burley", STRETCHED]),
        (Disney { roughness: 0.0, base_color: [0.0; 3], sheen: 1.0, ..DEFAULT }, vec!["disney-sheen", GGX]),
        (Disney { clearcoat: 1.0, ..DEFAULT }, vec!["burley", GGX, CLEARCOAT]),
        (Disney { clearcoat: 0.3, clearcoat_gloss: 0.0, metallic: 1.0, ..DEFAULT }, vec![GGX, CLEARCOAT]),
        (
            Disney { clearcoat: 0.7, clearcoat_gloss: 0.5, anisotropic: 0.5, ..DEFAULT },
            vec!["burley", STRETCHED, CLEARCOAT],
        ),
    ];
    for (disney, models) in cases {
        let scene = scene(&disney.recipe()).unwrap();
        let material = &scene.materials[0];
        assert_eq!(lobes(material), models);
        let budget = models.iter().map(|name| value_f32(model(name))).fold(0.0, f64::max) + STORED;
        let mut worst = 0.0_f64;
        for evaluator in evaluators() {
            let mut subject = Sum::material(evaluator, material).unwrap();
            for &(theta_i, phi_i, theta_e, phi_e) in &[
                (0.0, 0.0, 0.5, 1.0),
                (0.3, 0.2, 0.9, 2.5),
                (1.2, 0.7, 1.3, 3.6),
                (1.5, 2.0, 0.4, 5.5),
                (0.7, 1.0, 0.7, 1.0 + PI),
                (1.5, 0.0, 1.5, 3.0),
            ] {
                let mut f = Vec::new();
                subject.evaluate(&[], &[Angles { theta_i, phi_i, theta_e, phi_e }], &mut f).unwrap();
                let direction =
                    |theta: f64, phi: f64| [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()];
                let expected = disney.brdf(direction(theta_i, phi_i), direction(theta_e, phi_e));
                for (f, expected) in f.iter().zip(expected) {
                    worst = worst.max((f64::from(*f) / expected - 1.0).abs());
                }
            }
        }
        println!("{models:?}: {worst:.1e} of {budget:.1e}");
        assert!(worst <= budget, "{models:?}: {worst:e}");
    }
}

/// Values are stored in f32; sums of three lobes round twice more.
const STORED: f64 = 3.0 / (1 << 24) as f64;

/// The reference integrates the same sum; f32 meets what a table may be off by.
#[test]
fn integrals_meet_their_tolerance() {
    let cloth = Disney { subsurface: 0.5, sheen: 0.5, ..DEFAULT };
    let coated = Disney { clearcoat: 1.0, clearcoat_gloss: 0.9, ..DEFAULT };
    for disney in [cloth, coated] {
        let scene = scene(&disney.recipe()).unwrap();
        for tolerance in [1e-2, 1e-4, 3e-6] {
            let axes = vec![listed(Variable::ThetaI, &[0.0, 0.6, 1.2, 1.5, 1.57, PI / 2.0])];
            let plan = TablePlan::material("t", &RHO_DH, &scene, "paint", axes)
                .unwrap()
                .with_tolerance(tolerance)
                .unwrap();
            let table = bake(device(), &plan, Check::All);
            println!("to {tolerance}: {:?}", table.error.measured_max);
            assert!(table.error.measured_max.unwrap() <= tolerance, "{:?}", table.error);
        }
    }
}

/// Reciprocal, and of the energy that its diffuse lobe is declared to gain.
#[test]
fn promises_are_kept_or_declared() {
    let white = Disney { base_color: [1.0; 3], roughness: 1.0, subsurface: 0.3, sheen: 1.0, ..DEFAULT };
    let gold = Disney { metallic: 1.0, anisotropic: 0.5, ..DEFAULT };
    let coated = Disney { clearcoat: 1.0, ..white };
    for (disney, gains) in [(white, true), (gold, false), (coated, true)] {
        let scene = scene(&disney.recipe()).unwrap();
        let mut subject = Sum::material(device(), &scene.materials[0]).unwrap();
        let report =
            check(&mut subject, &VerifyOptions { budget: 20_000, search: true }, &Unobserved).unwrap();
        for finding in &report.findings {
            println!("{}: {:?} {}", finding.property, finding.verdict, finding.said);
            let declared = gains && finding.property == "energy";
            let expected = if declared { Verdict::Declared } else { Verdict::Kept };
            assert_eq!(finding.verdict, expected, "{finding:?}");
        }
    }
}

#[test]
fn what_is_wrong_is_refused_by_name() {
    for (disney, why) in [
        ("{}", "base_color"),
        ("{ base_color = 2 }", "[0, 1]"),
        ("{ base_color = 0.5, sheenTint = 1 }", "sheen_tint"),
        ("{ base_color = 0.5, clearcoat = 1.5 }", "[0, 1]"),
        ("{ base_color = 0.5, clearcoatGloss = 1 }", "clearcoat_gloss"),
    ] {
        let error = scene(&format!("[materials.m]\ndisney = {disney}")).unwrap_err().to_string();
        assert!(error.contains("line 2") && error.contains(why), "{error}");
    }
    let both =
        "[materials.m]\ndisney = { base_color = 0.5 }\nlobes = [{ model = \"lambert\", albedo = 0.5 }]";
    assert!(scene(both).unwrap_err().to_string().contains("keep one of them"));
}
