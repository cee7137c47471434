//! Promises of `gonio check`: each planted fault is caught and its input named, clean models pass, and a file
//! that cannot be checked is refused where it is wrong.

use crate::common::device;
use gonio::backend::gpu::Device;
use gonio::bake::{Evaluator, Unobserved};
use gonio::base::angles::Angles;
use gonio::verify::user_shader::{UserFunction, UserShader, directions};
use gonio::verify::{
    Declared, Finding, ParameterRange, Report, Subject, Symmetry, Verdict, VerifyOptions, check,
};
use std::f64::consts::{FRAC_PI_2, PI};

const SYMMETRIC: Symmetry = Symmetry { isotropic: true, bilateral: true };
/// A fifth of the default: enough for every fault here.
const OPTIONS: VerifyOptions = VerifyOptions { budget: 4_000_000, search: true };

fn gpu() -> &'static Device {
    match device() {
        Evaluator::Device(device) => device,
        Evaluator::Cpu => unreachable!("common::device asserts it"),
    }
}

fn path(file: &str) -> String {
    format!("{}/tests/shaders/{file}.wgsl", env!("CARGO_MANIFEST_DIR"))
}

fn shader(file: &str, entry: &str, parameters: &[(&str, f64, f64)], cosine: bool) -> UserShader<'static> {
    let source = std::fs::read_to_string(path(file)).unwrap();
    let function = UserFunction::parse(format!("{file}.wgsl"), source, entry).unwrap();
    let parameters =
        parameters.iter().map(|&(name, a, b)| ParameterRange::new(name, a, b).unwrap()).collect();
    UserShader::new(gpu(), function, parameters, cosine, SYMMETRIC).unwrap()
}

fn report(subject: &mut dyn Subject) -> Report {
    let report = check(subject, &OPTIONS, &Unobserved).unwrap();
    for Finding { property, verdict, said, .. } in &report.findings {
        println!("{}: {property} {verdict:?}: {said}", report.subject);
    }
    report
}

fn broken(report: &Report) -> Vec<&str> {
    report.findings.iter().filter(|f| f.verdict == Verdict::Broken).map(|f| f.property).collect()
}

// ---- Clean models ----------------------------------------------------------------------------------

/// Promises hold to f32 rounding, and a white surface neither gains nor loses: 3 parts in 10⁸ for 1/π in
/// f32, 1e-12 for the integral.
#[test]
fn a_lambertian_surface_keeps_every_promise() {
    let report = report(&mut shader("lambert", "brdf", &[], false));
    assert_eq!(broken(&report), [""; 0]);
    let energy = report.find("energy").unwrap().deviation.unwrap();
    assert!((energy - 1.0).abs() < 5e-8, "{energy}");
    assert!(report.evaluated > 2_000_000, "{}", report.evaluated);
}

/// Over two decades of α and all reflectances.
#[test]
fn ggx_in_good_form_keeps_every_promise() {
    let ranges = [("alpha", 0.01, 1.0), ("f0", 0.0, 1.0)];
    assert_eq!(broken(&report(&mut shader("ggx", "brdf", &ranges, false))), [""; 0]);
}

/// The generic integral of an unknown f, GGX without Fresnel at normal incidence and α = 1: 1 − ln 2.
#[test]
fn the_integral_agrees_with_a_closed_form() {
    let mut subject = shader("ggx", "brdf", &[("alpha", 1.0, 1.0), ("f0", 1.0, 1.0)], false);
    let report = report(&mut subject);
    let said = &report.find("energy").unwrap().said;
    let exact = format!("ρ_dh from {:.6}", 1.0 - 2f64.ln());
    assert!(said.starts_with(&exact), "{said} is not {exact}");
}

/// f cos θi is checked as f: a Lambertian surface that comes with the cosine is reciprocal.
#[test]
fn a_cosine_is_divided_out() {
    let albedo = [("albedo", 0.0, 1.0)];
    assert_eq!(broken(&report(&mut shader("cosine", "shade", &albedo, true))), [""; 0]);
    let wrong = report(&mut shader("cosine", "shade", &albedo, false));
    assert_eq!(broken(&wrong), ["reciprocity"], "without --cosine it is not");
}

// ---- Planted faults --------------------------------------------------------------------------------

/// The fault is found, nothing else is blamed, and the input that is named shows it when evaluated alone.
fn caught(
    file: &str,
    property: &str,
    shows: impl Fn(&mut dyn FnMut(Angles) -> Vec<f32>, Angles) -> bool,
) -> Finding {
    let mut subject = shader(file, "brdf", &[], false);
    let report = report(&mut subject);
    // What depends on the azimuth is not mirrored in every plane of incidence either.
    let all = if property == "isotropy" { vec![property, "bilateral"] } else { vec![property] };
    assert_eq!(broken(&report), all);
    let finding = report.find(property).unwrap().clone();
    let angles = finding.input.as_ref().unwrap().angles;
    let mut evaluate = |angles: Angles| {
        let mut out = Vec::new();
        subject.evaluate(&[], &[angles], &mut out).unwrap();
        out
    };
    assert!(shows(&mut evaluate, angles), "{file}: {angles:?} does not show it");
    finding
}

fn swapped(a: Angles) -> Angles {
    Angles { theta_i: a.theta_e, phi_i: a.phi_e, theta_e: a.theta_i, phi_e: a.phi_i }
}

#[test]
fn nan_at_grazing_is_caught() {
    let finding = caught("nan_at_grazing", "finite", |f, a| f(a)[0].is_nan());
    let Angles { theta_i, theta_e, .. } = finding.input.unwrap().angles;
    assert!(theta_i == FRAC_PI_2 || theta_e == FRAC_PI_2);
}

#[test]
fn infinity_at_normal_incidence_is_caught() {
    let finding = caught("infinite_at_normal", "finite", |f, a| f(a)[0] == f32::INFINITY);
    // cos θ rounds to 1 below 3.5e-4 rad.
    assert!(finding.input.unwrap().angles.theta_i < 3.5e-4);
}

/// The lowest value, −1e-4, is at the horizon.
#[test]
fn a_negative_lobe_is_caught() {
    let finding = caught("negative", "non-negative", |f, a| f(a)[1] < 0.0);
    assert!((finding.deviation.unwrap() - 1e-4).abs() < 1e-9, "{finding:?}");
}

/// 1 − 0.9 between the normal and the horizon: the search ends at both.
#[test]
fn what_is_not_reciprocal_is_caught() {
    let finding = caught("not_reciprocal", "reciprocity", |f, a| f(a) != f(swapped(a)));
    assert!((finding.deviation.unwrap() - 0.1).abs() < 1e-6, "{finding:?}");
}

#[test]
fn a_thousandth_of_energy_too_much_is_caught() {
    let finding = caught("gains_energy", "energy", |f, a| f(a)[0] > 1.0 / PI as f32);
    assert!((finding.deviation.unwrap() - 1.001).abs() < 1e-6, "{finding:?}");
}

#[test]
fn anisotropy_is_caught_where_none_is_expected() {
    let finding = caught("anisotropic", "isotropy", |f, a| {
        let turned = Angles { phi_i: 0.7, phi_e: a.phi_e - a.phi_i + 0.7, ..a };
        (f(a)[0] - f(turned)[0]).abs() > 1e-3
    });
    assert!(finding.deviation.unwrap() > 0.05, "{finding:?}");
}

/// A fault in 10⁻⁹ of the angles: the scan alone does not meet it, the search climbs to it.
#[test]
fn a_small_fault_is_searched_for() {
    let scan = VerifyOptions { search: false, ..OPTIONS };
    let met = check(&mut shader("basin", "brdf", &[], false), &scan, &Unobserved).unwrap();
    assert!(met.is_kept(), "{:?}", met.find("reciprocity"));
    let finding = caught("basin", "reciprocity", |f, a| (f(a)[0] - f(swapped(a))[0]).abs() > 1e-4);
    println!("{} found, {:e} met", finding.said, met.find("reciprocity").unwrap().deviation.unwrap());
}

/// Each input is printed with the digits that give it back.
#[test]
fn the_worst_input_can_be_pasted() {
    let finding = caught("not_reciprocal", "reciprocity", |_, _| true);
    let input = finding.input.unwrap();
    let text = input.to_string();
    let words: Vec<_> = text.split(' ').collect();
    let read = |option: &str| -> f64 {
        words[words.iter().position(|word| *word == option).unwrap() + 1].parse().unwrap()
    };
    let Angles { theta_i, phi_i, theta_e, phi_e } = input.angles;
    assert_eq!([theta_i, phi_i, theta_e, phi_e], ["--theta-i", "--phi-i", "--theta-e", "--phi-e"].map(read));
}

/// No result depends on the clock, which sizes the dispatches.
#[test]
fn a_check_is_reproducible() {
    let run = || check(&mut shader("basin", "brdf", &[], false), &OPTIONS, &Unobserved).unwrap().findings;
    assert_eq!(format!("{:?}", run()), format!("{:?}", run()));
}

/// The horizon is z = 0; where both directions are there, a half vector remains.
#[test]
fn directions_at_the_horizon() {
    let at = |theta_i, theta_e| Angles { theta_i, phi_i: 0.0, theta_e, phi_e: PI };
    let z = |angles: Angles, cosine| directions(&angles, cosine).map(|d| d[2]);
    let least = 1.0 / (1 << 24) as f32;
    assert_eq!(z(at(FRAC_PI_2, 0.0), false), [0.0, 1.0]);
    assert_eq!(z(at(FRAC_PI_2, 0.0), true), [least, 1.0]);
    assert_eq!(z(at(FRAC_PI_2, FRAC_PI_2), false), [least, least]);
}

// ---- Declared violations ---------------------------------------------------------------------------

/// A shader that declares that it gains energy.
struct Declaring {
    inner: UserShader<'static>,
    declared: Vec<Declared>,
}

impl Subject for Declaring {
    fn name(&self) -> String {
        self.inner.name()
    }
    fn parameters(&self) -> &[ParameterRange] {
        self.inner.parameters()
    }
    fn channels(&self) -> usize {
        self.inner.channels()
    }
    fn evaluate(&mut self, setting: &[f64], angles: &[Angles], out: &mut Vec<f32>) -> gonio::Result<()> {
        self.inner.evaluate(setting, angles, out)
    }
    fn declared(&self) -> &[Declared] {
        &self.declared
    }
}

/// Within its bound it is reported; beyond it, and where the promise is kept after all, it fails.
#[test]
fn a_declared_violation_is_held_to_its_bound() {
    let verdict = |file: &str, bound| {
        let declared = vec![Declared { property: "energy", bound, citation: "a test".into() }];
        let mut subject = Declaring { inner: shader(file, "brdf", &[], false), declared };
        report(&mut subject).find("energy").unwrap().verdict
    };
    assert_eq!(verdict("gains_energy", 1.002), Verdict::Declared);
    assert_eq!(verdict("gains_energy", 1.0005), Verdict::Broken);
    assert_eq!(verdict("lambert", 1.002), Verdict::Broken);
}

// ---- Agreement with a reference --------------------------------------------------------------------

/// A Lambertian surface in f32 whose reference is 1 + `off` of it at one corner of the angles.
struct Referenced {
    off: f64,
}

impl Subject for Referenced {
    fn name(&self) -> String {
        "referenced".into()
    }
    fn parameters(&self) -> &[ParameterRange] {
        &[]
    }
    fn channels(&self) -> usize {
        1
    }
    fn evaluate(&mut self, _: &[f64], angles: &[Angles], out: &mut Vec<f32>) -> gonio::Result<()> {
        out.extend(angles.iter().map(|_| (1.0 / PI) as f32));
        Ok(())
    }
    fn reference(&self, _: &[f64], angles: &Angles) -> Option<Vec<f64>> {
        let wrong = angles.theta_i > 1.5 && angles.theta_e > 1.5;
        Some(vec![(1.0 + if wrong { self.off } else { 0.0 }) / PI])
    }
}

/// Half an ULP is agreement, 1e-4 in a corner is not, and the worst input is in that corner.
#[test]
fn a_wrong_corner_disagrees_with_the_reference() {
    let right = report(&mut Referenced { off: 0.0 });
    assert!(right.is_kept() && right.find("agreement").unwrap().deviation.unwrap() < 6e-8);
    let wrong = report(&mut Referenced { off: 1e-4 });
    assert_eq!(broken(&wrong), ["agreement"]);
    assert!(wrong.find("agreement").unwrap().input.as_ref().unwrap().angles.theta_i > 1.5);
}

// ---- Files that cannot be checked ------------------------------------------------------------------

fn refusal(file: &str, entry: &str) -> String {
    let source = std::fs::read_to_string(path(file)).unwrap();
    UserFunction::parse(format!("{file}.wgsl"), source, entry).unwrap_err().to_string()
}

#[test]
fn broken_files_point_at_their_line() {
    let text = refusal("broken", "brdf");
    assert!(text.contains("broken.wgsl:4:"), "{text}");
    let text = refusal("ill_typed", "brdf");
    assert!(text.contains("ill_typed.wgsl:") && text.contains("return wi * wo"), "{text}");
}

#[test]
fn functions_that_do_not_fit_are_refused() {
    for (entry, words) in [
        ("sade", vec!["there is no function sade", "shade, shade_bound, tint"]),
        ("fragment", vec!["entry point of a pipeline"]),
        ("tint", vec!["color: vec3<f32>) -> i32"]),
    ] {
        let text = refusal("cosine", entry);
        assert!(text.starts_with("cosine.wgsl: "), "{text}");
        words.iter().for_each(|words| assert!(text.contains(words), "{words} in {text}"));
    }
}

#[cfg(feature = "cli")]
mod command {
    use super::path;
    use std::process::{Command, Output};

    fn gonio(file: &str, arguments: &[&str]) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_gonio"));
        command
            .args(["check", "--entry", "brdf", "--budget", "1000000", "--wgsl", &path(file)])
            .args(arguments);
        command.output().unwrap()
    }

    fn text(bytes: &[u8]) -> String {
        String::from_utf8_lossy(bytes).into_owned()
    }

    #[test]
    fn exit_codes_follow_the_table() {
        for (file, arguments, code) in [
            ("lambert", vec![], 0),
            ("gains_energy", vec![], 1),
            ("anisotropic", vec!["--anisotropic"], 0),
            ("broken", vec![], 2),
            ("missing", vec![], 2),
            ("ggx", vec![], 2),
            ("ggx", vec!["--set", "alpha=0.1..1"], 2),
            ("ggx", vec!["--set", "alpha=1..0.1", "--set", "f0=1"], 2),
            ("ggx", vec!["--set", "alpha=0.1", "--set", "f0=1", "--set", "f90=1"], 2),
            ("lambert", vec!["--device", "cpu"], 3),
        ] {
            let run = gonio(file, &arguments);
            assert_eq!(run.status.code(), Some(code), "{file} {arguments:?}: {}", text(&run.stderr));
        }
    }

    #[test]
    fn json_has_the_input() {
        let run = gonio("not_reciprocal", &["--json"]);
        let json: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
        assert_eq!(json["kept"], false);
        let findings = json["findings"].as_array().unwrap();
        let names: Vec<_> = findings.iter().map(|f| f["property"].as_str().unwrap()).collect();
        assert_eq!(names, ["finite", "non-negative", "reciprocity", "isotropy", "bilateral", "energy"]);
        let found = &findings[2];
        assert_eq!(found["verdict"], "broken");
        assert!(found["input"]["theta_i"].is_f64() && found["input"]["wi"].is_array(), "{found}");
        assert!(found["input"]["eval"].as_str().unwrap().contains("--theta-i "), "{found}");
    }

    /// XML whose tags match and whose text is escaped, with a failure for what is broken.
    #[test]
    fn junit_is_well_formed() {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("check.xml");
        gonio("gains_energy", &["--junit", file.to_str().unwrap()]);
        let xml = std::fs::read_to_string(&file).unwrap();
        assert!(xml.starts_with("<?xml") && xml.contains("tests=\"6\" failures=\"1\""), "{xml}");
        let mut open = Vec::new();
        for tag in xml.split('<').skip(2) {
            let (tag, text) = tag.split_once('>').unwrap();
            assert!(!text.contains('>'), "{text}");
            match tag.strip_prefix('/') {
                Some(name) => assert_eq!(open.pop(), Some(name)),
                None if tag.ends_with('/') => {}
                None => open.push(tag.split(' ').next().unwrap()),
            }
        }
        assert!(open.is_empty() && xml.matches("<failure").count() == 1, "{xml}");
    }
}
