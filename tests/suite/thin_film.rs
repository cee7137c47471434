//! Promises of the thin film: the specification's numbers, a spectral integral done by force, limits, and what every
//! Fresnel term promises.

use crate::common::*;
use crate::promises::{energy, value_f32};
use gonio::bake::Evaluator;
use gonio::base::precision::Precision;
use gonio::check::Check;
use gonio::model::Model;
use gonio::plan::TablePlan;
use gonio::shader::{Kernel, compose, validate};
use gonio::table::axis::Variable::Mu;
use gonio::table::quantity::{BRDF, SPLIT_SUM};
use std::f64::consts::{PI, TAU};

/// thickness nm, η of the film, F0 of the base, channel.
type Film = [f64; 4];

/// None, a soap bubble, oil on water, coated glass, and on metals what swings and dips the most.
const FILMS: [Film; 9] = [
    [400.0, 1.3, 0.04, 1.0],
    [0.0, 1.3, 0.04, 0.0],
    [250.0, 1.05, 0.3, 0.0],
    [300.0, 1.33, 0.0, 0.0],
    [120.0, 1.47, 0.02, 2.0],
    [350.0, 1.3, 0.4, 0.0],
    [1000.0, 1.38, 0.04, 0.0],
    [700.0, 1.5, 1.0, 0.5],
    [2000.0, 3.0, 0.5, 0.0],
];

fn with(plan: TablePlan, film: Film) -> TablePlan {
    let names = ["thickness", "film_eta", "f0", "channel"].map(String::from);
    plan.with_parameters(&names.into_iter().zip(film).collect::<Vec<_>>()).unwrap()
}

fn under(name: &str) -> &'static Model {
    model(name).with_terms(None, Some("thin-film")).unwrap()
}

/// F(μ), as the mirror's integrals have it, at each of `mus`, which ascend.
fn f(evaluator: &Evaluator, film: Film, mus: &[f64]) -> Vec<f64> {
    let plan = with(basis(&SPLIT_SUM, under("mirror"), &[], vec![listed(Mu, mus)]), film);
    bake(evaluator, &plan, Check::All).values.iter().collect()
}

/// F in f32 is off by so much: a value's relative error is that over ε = 1/256, where F is the least.
fn budget() -> f64 {
    value_f32(under("mirror")) / 256.0
}

// ---- The specification -----------------------------------------------------------------------------

const XYZ_TO_REC709: [[f64; 3]; 3] = [
    [3.2404542, -1.5371385, -0.4985314],
    [-0.9692660, 1.8760108, 0.0415560],
    [0.0556434, -0.2040259, 1.0572252],
];

/// KHR_materials_iridescence as its text has it, R, G and B; and whether its guards do anything.
fn specified([thickness, film_eta, f0, _]: Film, mu: f64) -> ([f64; 3], bool) {
    let t = (thickness / 0.03).clamp(0.0, 1.0);
    let eta = 1.0 + (film_eta - 1.0) * t * t * (3.0 - 2.0 * t);
    let schlick = |f0: f64, mu: f64| f0 + (1.0 - f0) * (1.0 - mu).powi(5);
    let step = |to: f64, from: f64| ((to - from) / (to + from)).powi(2);
    let cos2 = (1.0 - (1.0 - mu * mu) / (eta * eta)).sqrt();
    let base = (1.0 + (f0 + 1e-4).sqrt()) / (1.0 - (f0 + 1e-4).sqrt());
    let (r12, r23) = (schlick(step(eta, 1.0), mu), schlick(step(base, eta), cos2));
    let phi = PI + if base < eta { PI } else { 0.0 };
    let guarded = (r12 * r23).clamp(1e-5, 0.9999);
    let rs = (1.0 - r12).powi(2) * r23 / (1.0 - guarded);
    let mut rgb = [r12 + rs; 3];
    let mut cm = rs - (1.0 - r12);
    for m in [1.0, 2.0] {
        cm *= guarded.sqrt();
        let phase = TAU * 2.0 * eta * thickness * cos2 * m * 1e-9;
        let lobe = |value: f64, place: f64, variance: f64| {
            value
                * (TAU * variance).sqrt()
                * (place * phase + m * phi).cos()
                * (-phase * phase * variance).exp()
        };
        let xyz = [
            lobe(5.4856e-13, 1.6810e6, 4.3278e9) + lobe(9.7470e-14, 2.2399e6, 4.5282e9),
            lobe(4.4201e-13, 1.7953e6, 9.3046e9),
            lobe(5.2481e-13, 2.2084e6, 6.6121e9),
        ]
        .map(|s| 2.0 * s / 1.0685e-7);
        for (i, row) in rgb.iter_mut().zip(XYZ_TO_REC709) {
            *i += cm * row.iter().zip(xyz).map(|(a, b)| a * b).sum::<f64>();
        }
    }
    (rgb.map(|i| i.max(0.0)), guarded != r12 * r23)
}

/// Off by ε/2 where the specification clamps at 0, by ε²/4F and what f32 loses elsewhere; and where its guard of R12 R23
/// works, by what that weighs: 2 · 1.25 √1e-5 and a half more.
#[test]
fn f_is_the_specifications() {
    let mus: Vec<_> = (1..=100).map(|k| f64::from(k) / 100.0).collect();
    for evaluator in evaluators() {
        for film in FILMS.into_iter().filter(|film| film[3].fract() == 0.0 && film[2] < 1.0) {
            for (mu, value) in mus.iter().zip(f(evaluator, film, &mus)) {
                let (rgb, guarded) = specified(film, *mu);
                let exact = rgb[film[3] as usize];
                let smooth = (1.0_f64 / 512.0).min(1.0 / (4.0 * 65_536.0 * exact));
                let allowed = budget() + smooth + if guarded { 0.0115 } else { 1e-9 };
                assert!((value - exact).abs() <= allowed, "{film:?} at {mu}: {value}, not {exact}");
            }
        }
    }
}

/// By force: Airy's reflectance of complex amplitudes at each wave number, under the eye's four Gaussians. That has all
/// turns within the film, of which the specification has two: the third is within √(R12 R23)³ of it.
#[test]
fn normal_incidence_is_the_spectral_integral() {
    for film in
        [[400.0, 1.3, 0.04, 0.0], [250.0, 1.33, 0.02, 1.0], [550.0, 1.8, 0.2, 2.0], [150.0, 1.4, 0.5, 1.0]]
    {
        let [thickness, eta, f0, channel] = film;
        let root = (f0 + 1e-4_f64).sqrt();
        let base = (1.0 + root) / (1.0 - root);
        let (a, b) = ((1.0 - eta) / (1.0 + eta), (eta - base) / (eta + base));
        // |a + b z|²/|1 + a b z|² for z = e^(iφ).
        let airy = |phi: f64| {
            let c = 2.0 * a * b * phi.cos();
            (a * a + b * b + c) / (1.0 + a * a * b * b + c)
        };
        let mean = (0..256).map(|k| airy(TAU * f64::from(k) / 256.0)).sum::<f64>() / 256.0;
        // The fit's exponent is the transform of a Gaussian of twice its variance.
        let lobe = |value: f64, place: f64, variance: f64| {
            let (sigma, area) = ((2.0 * variance).sqrt(), value * (TAU * variance).sqrt() / 1.0685e-7);
            let sum =
                |g: &dyn Fn(f64) -> f64| (-4000..=4000).map(|k| g(f64::from(k) / 500.0)).sum::<f64>() / 500.0;
            let swing = |u: f64| airy(TAU * 2.0 * eta * thickness * 1e-9 * (place + sigma * u)) - mean;
            area * sum(&|u| (-0.5 * u * u).exp() / TAU.sqrt() * swing(u))
        };
        let xyz = [
            lobe(5.4856e-13, 1.6810e6, 4.3278e9) + lobe(9.7470e-14, 2.2399e6, 4.5282e9),
            lobe(4.4201e-13, 1.7953e6, 9.3046e9),
            lobe(5.2481e-13, 2.2084e6, 6.6121e9),
        ];
        let i: f64 = mean + XYZ_TO_REC709[channel as usize].iter().zip(xyz).map(|(a, b)| a * b).sum::<f64>();
        let exact = 0.5 * (i + i.hypot(1.0 / 256.0));
        let third = 2.0 * 1.25 * (a * b).abs().powi(3) / (1.0 - (a * b).abs());
        for evaluator in evaluators() {
            let value = f(evaluator, film, &[1.0])[0];
            println!("{film:?}: {value} against {exact}, the third turn {third:.1e}");
            assert!((value - exact).abs() <= third + budget(), "{film:?}: {value}, not {exact}");
        }
    }
}

// ---- Limits ----------------------------------------------------------------------------------------

/// No film is the base, continuously: F0 and the specification's 1e-4 at normal incidence, whether it has no thickness or
/// the index of what is outside.
#[test]
fn no_film_is_the_base_at_normal_incidence() {
    for evaluator in evaluators() {
        for f0 in [0.0, 0.04, 0.5, 0.99] {
            let i: f64 = f0 + 1e-4;
            let exact = 0.5 * (i + i.hypot(1.0 / 256.0));
            for film in
                [[0.0, 1.3, f0, 0.0], [0.0, 3.0, f0, 2.0], [200.0, 1.0, f0, 1.0], [1e-4, 1.3, f0, 1.0]]
            {
                let value = f(evaluator, film, &[1.0])[0];
                assert!((value - exact).abs() <= budget() + 1e-5, "{film:?}: {value}, not {exact}");
            }
        }
    }
}

/// Without a step below it, or in white light of all phases, a film has no colour.
#[test]
fn colours_fade() {
    for evaluator in evaluators() {
        let of = |thickness: f64, eta: f64, f0: f64| {
            [0.0, 1.0, 2.0].map(|channel| f(evaluator, [thickness, eta, f0, channel], &[0.7, 1.0]))
        };
        let spread = |[r, g, b]: &[Vec<f64>; 3], k: usize| {
            f64::max((r[k] - g[k]).abs(), f64::max((g[k] - b[k]).abs(), (r[k] - b[k]).abs()))
        };
        // The base of index 1.5 but for the specification's 1e-4, and what the smooth clamp makes of F = 0.04.
        let root = (0.04_f64).sqrt();
        assert!(((1.0 + root) / (1.0 - root) - 1.5).abs() < 1e-12);
        assert!(spread(&of(400.0, 1.5, 0.04 - 1e-4), 1) < 1e-6 + 2.0 * budget());
        let (thin, thick) = (of(300.0, 2.0, 0.5), of(2000.0, 2.0, 0.5));
        assert!(spread(&thin, 1) > 0.1 && spread(&thick, 1) < 1e-3, "{thin:?}, {thick:?}");
    }
}

/// All is reflected at grazing, but for ε²/4.
#[test]
fn grazing_reflects_all() {
    for evaluator in evaluators() {
        for film in FILMS {
            let value = f(evaluator, film, &[0.0])[0];
            assert!((value - 1.0).abs() <= budget() + 4e-6, "{film:?}: {value}");
        }
    }
}

/// F is above 0 and within the bound that it declares, which it needs.
#[test]
fn f_is_positive_and_bounded() {
    let mus: Vec<_> = (0..=200).map(|k| f64::from(k) / 200.0).collect();
    let (mut least, mut most) = ([f64::INFINITY; 3], [0.0_f64; 3]);
    let bound = energy(under("mirror"));
    // Where a search over millions of films found the most.
    let mut films =
        vec![[375.1, 1.398, 0.7605, 0.0], [441.5, 1.2334, 0.836, 1.0], [172.7, 1.4435, 0.8586, 2.0]];
    for (k, u) in golden(300, 0.3).into_iter().enumerate() {
        let fraction = |step: f64| (step * k as f64).fract();
        let eta = 1.1 + 0.9 * fraction(0.754_877_666);
        let f0 = fraction(0.569_840_291).powi(2);
        films.extend([0.0, 1.0, 2.0].map(|channel| [40.0 + 900.0 * u * u, eta, f0, channel]));
    }
    for film in films {
        let (least, most) = (&mut least[film[3] as usize], &mut most[film[3] as usize]);
        for value in f(&Evaluator::Cpu, film, &mus) {
            (*least, *most) = (least.min(value), most.max(value));
        }
    }
    println!("F from {least:?} to {most:?}");
    assert!(least.iter().all(|&f| f > 1e-6) && most.iter().all(|&f| f <= bound), "{least:?}, {most:?}");
    assert!(most[0] > 1.28 && most[1] > 1.05 && most[2] > 1.05, "{most:?}: the bound is too wide");
}

// ---- Values and integrals --------------------------------------------------------------------------

/// Values at the extremes: of the angles, of α and of the film, within the model's own budget.
#[test]
fn values_agree_with_the_reference() {
    for film in FILMS {
        let plan = with(basis(&BRDF, under("ggx"), &EXTREME_ROUGHNESS, extreme_angles()), film);
        for (evaluator, budget) in evaluators().into_iter().zip(value_budgets(under("ggx"))) {
            let table = bake(evaluator, &plan, Check::All);
            let worst = table.error.measured_max.unwrap();
            println!("{film:?} {}: {worst:.2e}", table.precision);
            assert!(worst <= budget, "{film:?}: {:?}", table.error);
        }
    }
}

/// Integrals meet the tolerance that is asked for, on both evaluators, with and without a lobe.
#[test]
fn integrals_meet_every_tolerance() {
    for film in some_of(&FILMS, 2) {
        assert_term_meets_every_tolerance([under("ggx"), under("mirror")], |plan| with(plan, film));
    }
}

/// A module has one copy of what its parts share, in both arithmetics.
#[test]
fn shaders_are_valid() {
    for name in ["ggx", "beckmann", "mirror"] {
        let model = under(name);
        let kernels = match name {
            "mirror" => &[Kernel::Product, Kernel::Analytic][..],
            _ => &[Kernel::Values, Kernel::Slopes, Kernel::FineSlopes],
        };
        for &kernel in kernels {
            for precision in [Precision::F32, Precision::F64] {
                let source = compose(kernel, Some(model), 1, precision);
                validate(&source, precision).unwrap();
                assert_eq!(source.matches("fn exp_neg").count(), 1, "{name}");
            }
        }
    }
}

#[cfg(feature = "cli")]
mod command {
    use std::process::{Command, Output};

    fn gonio(arguments: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_gonio")).args(arguments).output().unwrap()
    }

    const MIRRORED: [&str; 7] =
        ["eval", "--theta-i=0", "--theta-e=0", "--device=cpu", "--json", "--model=ggx", "--set=alpha=0.1"];

    fn eval(sets: &[&str]) -> Output {
        gonio(&[&MIRRORED[..], &["--set=fresnel=thin-film"], sets].concat())
    }

    /// R, G and B have their own channel unless a recipe says otherwise.
    #[test]
    fn a_material_is_coloured() {
        let f = |sets: &[&str]| {
            let output = eval(sets);
            let error = String::from_utf8_lossy(&output.stderr).into_owned();
            let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect(&error);
            let lobes = json["factors"].as_array().unwrap().clone();
            [0, 1, 2].map(|c| lobes.iter().map(|lobe| lobe["F"][c].as_f64().unwrap()).sum::<f64>())
        };
        let own = f(&[]);
        assert_eq!(own, f(&["--set=channel=[0,1,2]"]));
        let grey = f(&["--set=channel=1"]);
        assert!(
            grey.iter().all(|&f| f == own[1]) && own[0] != own[1] && own[1] != own[2],
            "{own:?}, {grey:?}"
        );
    }

    /// What is wrong is said, with the remedy.
    #[test]
    fn bad_films_are_refused() {
        for (sets, said) in [
            (&["--set=thickness=-1"][..], "outside [0, 2000]"),
            (&["--set=film_eta=0.9"], "outside [1, 3]"),
            (&["--set=film_eta=1.05", "--set=thickness=500"], "give a film_eta of 1.1 or more"),
            (&["--set=channel=3"], "outside [0, 2]"),
        ] {
            let output = eval(sets);
            let error = String::from_utf8_lossy(&output.stderr).into_owned();
            assert_eq!(output.status.code(), Some(2), "{sets:?}: {error}");
            assert!(error.contains(said), "{sets:?}: {error}");
        }
    }

    /// The promises over the whole range, and the one that it is known to break.
    #[test]
    fn promises_are_kept() {
        for (model, budget) in [("ggx", "3e5"), ("mirror", "1e5")] {
            let run = gonio(&["check", "--model", model, "--set", "fresnel=thin-film", "--budget", budget]);
            let said = String::from_utf8_lossy(&run.stdout).into_owned();
            println!("{said}");
            assert_eq!(run.status.code(), Some(0), "{model}: {said}");
        }
    }
}
