//! Promises of our own models: kept over their whole ranges, what a format declares is there and bounded, and
//! each worst input can be pasted into `gonio eval`.

use crate::common::{device, model, some_of};
use crate::promises::{energy, value_f32};
use gonio::bake::Unobserved;
use gonio::base::angles::Angles;
use gonio::model::MODELS;
use gonio::model::compensation::Compensation;
use gonio::model::lobe::Lobe;
use gonio::scene::{Distribution, Formula, FormulaInput, Material, MaterialLobe, Weights};
use gonio::verify::{
    Declared, ParameterRange, Report, Subject, Sum, Symmetry, Tolerances, Verdict, VerifyOptions, check,
};

const OPTIONS: VerifyOptions = VerifyOptions { budget: 2_000_000, search: true };

fn report(subject: &mut dyn Subject) -> Report {
    let report = check(subject, &OPTIONS, &Unobserved).unwrap();
    for finding in &report.findings {
        println!("{}: {} {:?}: {}", report.subject, finding.property, finding.verdict, finding.said);
    }
    report
}

fn verdict(report: &Report, property: &str) -> Verdict {
    report.find(property).unwrap().verdict
}

/// As the scene reader makes them: textured weights, over these ranges.
fn gltf(roughness: [f64; 2], metallic: [f64; 2], base_color: [f64; 2]) -> Material {
    let input = |name, [least, most]: [f64; 2]| FormulaInput { name, value: [most; 3], least: Some(least) };
    let (m, c) = (input("metallic", metallic), input("base_color", base_color));
    let diffuse = [Formula::number(0.96).times(&m.rest()).times(&c.all()), Formula::default()];
    let f0 = Formula::number(0.04).times(&m.rest()).plus(m.all().times(&c.all()));
    let specular = [f0, Formula::number(1.0)];
    let [min, max] = roughness;
    Material {
        name: "gltf".into(),
        lobes: vec![
            MaterialLobe {
                model: "gltf_diffuse".into(),
                roughness: None,
                parameters: Vec::new(),
                weights: Weights::Textured(diffuse),
                compensation: Compensation::None,
                factors: Vec::new(),
            },
            MaterialLobe {
                model: "ggx".into(),
                roughness: Some(Distribution::uniform(min, max)),
                parameters: Vec::new(),
                weights: Weights::Textured(specular),
                compensation: Compensation::None,
                factors: Vec::new(),
            },
        ],
        metallic: Some(metallic),
        base_color: Some(base_color),
    }
}

// ---- Models ------------------------------------------------------------------------------------------

/// Over the whole range of the shape, of the other parameters and of the weights; those that gain energy do so as they
/// declare. A delta has no values, and says so.
#[test]
fn every_model_keeps_its_promises_over_its_whole_range() {
    for model in some_of(&MODELS, 2) {
        let mut parameters = Vec::new();
        if let Some(shape) = model.shape {
            parameters.push(ParameterRange::new(shape.name, shape.least, shape.most).unwrap());
        }
        parameters.extend(
            model.parameters.iter().map(|p| ParameterRange::new(p.name, p.range[0], p.range[1]).unwrap()),
        );
        let weights = model.components.iter().map(|c| ParameterRange::new(c.weight, 0.0, 1.0).unwrap());
        parameters.extend(weights);
        let lobe = Lobe::new(model, Some(0.5), vec![[0.0; 2]; 3]).unwrap();
        let report = report(&mut Sum::model(device(), lobe, parameters).unwrap());
        for finding in &report.findings {
            let declared = finding.property == "energy" && model.violation().is_some();
            let expected = if declared { Verdict::Declared } else { Verdict::Kept };
            assert_eq!(finding.verdict, expected, "{}: {finding:?}", model.name);
        }
        // What has no bound is not judged by it.
        let is_bounded = energy(model).is_finite();
        assert_eq!(report.find("energy").is_some(), is_bounded, "{}", model.name);
        match model.is_delta() {
            true => assert!(report.findings.len() == 1 && report.notes[0].contains("delta")),
            false => {
                assert!(report.notes.is_empty() == is_bounded && report.evaluated > 2_000_000);
                let limit = |property| report.find(property).unwrap().limit;
                assert_eq!([limit("agreement"), limit("reciprocity")], [value_f32(model), 1e-6]);
            }
        }
    }
}

/// Below α = 1e-6 there are integrals alone, down to the mirror.
#[test]
fn a_range_that_reaches_the_mirror_is_integrated_to_it() {
    let model = gonio::model::find("ggx").unwrap();
    let lobe = Lobe::new(model, None, vec![[1.0, 1.0]; 3]).unwrap();
    let range = ParameterRange::new("roughness", 0.0, 0.5).unwrap();
    let report = report(&mut Sum::model(device(), lobe, vec![range]).unwrap());
    assert!(report.is_kept() && report.notes[0].contains("0.001"), "{:?}", report.notes);
    let finite = report.find("finite").unwrap().input.as_ref().unwrap();
    assert!(finite.setting[0].1 >= 1e-3);
}

// ---- Declared violations -------------------------------------------------------------------------------

/// White plastic sends back up to 1.84 of the light at α = 1e-3, 1.38 at 0.09 and 1.06 at 0.5: the largest
/// over θi, measured when the format was first looked at, to their last digit.
#[test]
fn gltf_gains_energy_as_it_declares() {
    for (alpha, most) in [(1e-3f64, 1.84), (0.09, 1.38), (0.5, 1.06)] {
        let material = gltf([alpha.sqrt(); 2], [0.0; 2], [1.0; 2]);
        let report = report(&mut Sum::material(device(), &material).unwrap());
        let energy = report.find("energy").unwrap();
        println!("α = {alpha}: {} at {:?}", energy.deviation.unwrap(), energy.input);
        assert_eq!(energy.verdict, Verdict::Declared);
        assert!(energy.deviation.unwrap() > most - 0.005, "{alpha}: {}", energy.said);
        assert!(energy.note.as_ref().unwrap().contains("glTF 2.0"));
    }
}

/// The bound is the supremum: it is all but reached at the mirror's end of the range, and not passed.
#[test]
fn the_declared_bound_is_tight() {
    let material = gltf([0.0, 1.0], [0.0, 1.0], [0.0, 1.0]);
    let report = report(&mut Sum::material(device(), &material).unwrap());
    assert_eq!(verdict(&report, "energy"), Verdict::Declared);
    let most = report.find("energy").unwrap().deviation.unwrap();
    assert!(most > 1.932 && most < 1.932_98, "{most}");
}

/// A metal has no diffuse lobe to gain by, and black nothing to add: absence is no fault there.
#[test]
fn a_material_that_cannot_gain_need_not() {
    for material in [gltf([0.1, 1.0], [1.0; 2], [0.0, 1.0]), gltf([0.1, 1.0], [0.0, 1.0], [0.0; 2])] {
        let report = report(&mut Sum::material(device(), &material).unwrap());
        let energy = report.find("energy").unwrap();
        assert_eq!(energy.verdict, Verdict::Kept);
        assert!(energy.note.as_ref().unwrap().contains("do not show"));
    }
}

/// A subject whose integrals are scaled, and whose values.
struct Scaled<'a> {
    inner: Sum<'a>,
    scale: f64,
    values: f32,
}

impl Subject for Scaled<'_> {
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
        let first = out.len();
        self.inner.evaluate(setting, angles, out)?;
        out[first..].iter_mut().for_each(|f| *f *= self.values);
        Ok(())
    }
    fn reference(&self, setting: &[f64], angles: &Angles) -> Option<Vec<f64>> {
        self.inner.reference(setting, angles)
    }
    fn symmetry(&self) -> Symmetry {
        self.inner.symmetry()
    }
    fn tolerances(&self) -> Tolerances {
        self.inner.tolerances()
    }
    fn agreement_at(&self, setting: &[f64]) -> Option<f64> {
        self.inner.agreement_at(setting)
    }
    fn rho_dh(&mut self, settings: &[Vec<f64>], thetas: &[f64]) -> gonio::Result<Option<Vec<f64>>> {
        if self.scale == 0.0 {
            return Ok(Some(vec![0.0; settings.len() * thetas.len() * self.channels()]));
        }
        let rho = self.inner.rho_dh(settings, thetas)?;
        Ok(rho.map(|rho| rho.into_iter().map(|rho| rho * self.scale).collect()))
    }
    fn declared(&self) -> &[Declared] {
        self.inner.declared()
    }
    fn shows(&self, property: &str) -> bool {
        self.inner.shows(property)
    }
}

/// White plastic: what it declares is missing, or beyond its bound.
#[test]
fn a_declared_gain_that_is_missing_or_too_large_fails() {
    let material = gltf([0.1, 1.0], [0.0; 2], [1.0; 2]);
    for (scale, expected) in [(1.0, Verdict::Declared), (0.5, Verdict::Broken), (1.2, Verdict::Broken)] {
        let mut subject = Scaled { inner: Sum::material(device(), &material).unwrap(), scale, values: 1.0 };
        assert_eq!(verdict(&report(&mut subject), "energy"), expected, "{scale}");
    }
}

/// Where α differ by 100, f32 may lose 7e-5 of a value; what is wrong by less where they do not is found all the same.
#[test]
fn agreement_is_asked_for_at_every_setting() {
    for (values, expected) in [(1.0, Verdict::Kept), (1.0 + 3e-5, Verdict::Broken)] {
        let lobe = Lobe::new(model("ggx-anisotropic"), Some(0.5), vec![[1.0; 2]; 3]).unwrap();
        let inner =
            Sum::model(device(), lobe, vec![ParameterRange::new("aspect", 0.01, 100.0).unwrap()]).unwrap();
        let options = VerifyOptions { budget: 200_000, search: false };
        let report = check(&mut Scaled { inner, scale: 0.0, values }, &options, &Unobserved).unwrap();
        let agreement = report.find("agreement").unwrap();
        assert!(agreement.limit > 6e-5);
        assert_eq!(agreement.verdict, expected, "{agreement:?}");
    }
}

// ---- The command ---------------------------------------------------------------------------------------

#[cfg(feature = "cli")]
mod command {
    use serde_json::Value;
    use std::process::{Command, Output};

    const DEMO: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/demo/demo.gltf");
    const RECIPE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/demo/recipe.toml");

    fn gonio(arguments: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_gonio")).args(arguments).output().unwrap()
    }

    fn check(arguments: &[&str]) -> Output {
        gonio(&[&["check", "--budget", "2e5"], arguments].concat())
    }

    fn json(run: &Output) -> Value {
        let error = String::from_utf8_lossy(&run.stderr);
        serde_json::from_slice(&run.stdout).unwrap_or_else(|e| panic!("{e}: {error}"))
    }

    /// Every combination of terms is checked; what ρ without masking gains has no bound, and is not judged.
    #[test]
    fn terms_are_chosen_by_name() {
        for masking in ["smith-correlated", "smith-separable", "none"] {
            for fresnel in ["schlick", "none"] {
                let sets = [format!("masking={masking}"), format!("fresnel={fresnel}")];
                let run = check(&["--model=ggx", "--set", &sets[0], "--set", &sets[1]]);
                let said = String::from_utf8_lossy(&run.stdout).into_owned();
                assert_eq!(run.status.code(), Some(0), "{sets:?}: {said}");
                assert_eq!(said.contains("energy is not judged"), masking == "none", "{said}");
            }
        }
    }

    /// The words of a command as a shell has them; here names are quoted by single quotes alone.
    fn words(command: &str) -> Vec<String> {
        let mut words = vec![String::new()];
        let mut quoted = false;
        for c in command.chars() {
            match c {
                '\'' => quoted = !quoted,
                ' ' if !quoted => words.push(String::new()),
                c => words.last_mut().unwrap().push(c),
            }
        }
        words
    }

    /// Every command that a check prints is run, and has the value that the check saw, bit for bit.
    fn pasted(run: &Output) -> usize {
        let mut count = 0;
        for subject in json(run)["subjects"].as_array().unwrap() {
            for finding in subject["findings"].as_array().unwrap() {
                let Some(eval) = finding["input"]["eval"].as_str() else { continue };
                let words = words(eval);
                assert_eq!(words[0], "gonio");
                let mut arguments: Vec<_> = words[1..].iter().map(String::as_str).collect();
                arguments.push("--json");
                let run = gonio(&arguments);
                assert_eq!(run.status.code(), Some(0), "{eval}: {}", String::from_utf8_lossy(&run.stderr));
                assert_eq!(json(&run)["value"], finding["values"], "{eval}");
                count += 1;
            }
        }
        count
    }

    #[test]
    fn the_worst_inputs_of_a_model_can_be_pasted() {
        let run = check(&["--model", "ggx", "--set", "alpha=1e-6..1", "--set", "f0=[1, 0.7, 0.3]", "--json"]);
        assert_eq!(run.status.code(), Some(0));
        assert_eq!(pasted(&run), 7);
    }

    /// Textured materials too, at one value of each texture.
    #[test]
    fn a_scene_is_checked_material_by_material_and_basis_by_basis() {
        let dir = tempfile::tempdir().unwrap();
        let xml = dir.path().join("check.xml");
        let out = dir.path().join("pictures");
        let run = check(&[DEMO, "--json", "--junit", xml.to_str().unwrap(), "--out", out.to_str().unwrap()]);
        assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
        let report = json(&run);
        let subjects = report["subjects"].as_array().unwrap();
        assert!(report["kept"] == true && subjects.iter().any(|s| s["subject"] == "worn paint"));
        let energy = |s: &Value| s["findings"].as_array().unwrap().last().unwrap()["verdict"].clone();
        assert!(subjects.iter().any(|s| energy(s) == "declared") && subjects.len() > 2);
        assert!(pasted(&run) > 12);
        let xml = std::fs::read_to_string(&xml).unwrap();
        assert_eq!(xml.matches("<testsuite ").count(), subjects.len());
        let pictures = std::fs::read_dir(&out).unwrap().count();
        assert!(pictures > subjects.len() && pictures <= 2 * subjects.len(), "{pictures}");
    }

    #[test]
    fn a_recipe_is_checked_with_its_mirror() {
        let run = check(&[RECIPE, "--json"]);
        let report = json(&run);
        let subjects = report["subjects"].as_array().unwrap();
        let mirror = subjects.iter().find(|s| s["subject"] == "mirror").unwrap();
        assert!(mirror["notes"][0].as_str().unwrap().contains("integrals alone"));
        assert!(subjects.iter().any(|s| s["subject"] == "painted wood"));
        assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
        let one = json(&check(&[RECIPE, "--material", "painted wood", "--json"]));
        assert_eq!(one["subjects"].as_array().unwrap().len(), 1);
    }

    #[test]
    fn bad_targets_are_refused_with_a_remedy() {
        for (arguments, said) in [
            (vec![], "--model"),
            (vec!["nowhere.gltf"], "nowhere.gltf"),
            (vec!["scene.obj"], ".gltf"),
            (vec![RECIPE, "--material", "nope"], "painted wood"),
            (vec!["--model", "nope"], "lambert"),
            (vec!["--model", "ggx", "--set", "alpha"], "KEY=VALUE"),
            (vec!["--model", "ggx", "--set", "alpha=1..x"], "not a number"),
            (vec!["--model", "ggx", "--set", "alpha=1..0.1"], "lower first"),
            (vec!["--model", "ggx", "--set", "alpha=0.5..2"], "[0, 1]"),
            (vec!["--model", "ggx", "--set", "beta=0..1"], "f90"),
            (vec!["--model", "ggx", "--set", "alpha=1", "--set", "alpha=0..1"], "twice"),
            (vec!["--model", "ggx", "--set", "alpha=0..1", "--set", "roughness=1"], "keep one"),
            (vec!["--model", "ggx", "--entry", "f"], "FILE#FUNCTION"),
            (vec!["--model", "ggx", "--budget", "0"], "1 to 1e12"),
        ] {
            let run = gonio(&[&["check"], &arguments[..]].concat());
            let text = String::from_utf8_lossy(&run.stderr);
            assert_eq!(run.status.code(), Some(2), "{arguments:?}: {text}");
            assert!(text.contains(said), "{arguments:?}: {text}");
        }
    }

    /// What varies in a material needs a value to be evaluated, in its range.
    #[test]
    fn eval_says_what_varies() {
        let eval = |sets: &[&str]| {
            let pair = ["--material", "painted wood", "--theta-i", "0.5", "--theta-e", "0.5"];
            let run = gonio(&[&["eval", RECIPE], &pair[..], sets].concat());
            (run.status.code(), String::from_utf8_lossy(&run.stderr).into_owned())
        };
        assert_eq!(eval(&["--set", "roughness=0.4"]).0, Some(0));
        for (sets, said) in [
            (vec![], "roughness varies from 0.35 to 0.55"),
            (vec!["--set", "roughness=0.9"], "outside the [0.35, 0.55]"),
            (vec!["--set", "metallic=0.9"], "does not vary"),
        ] {
            let (code, text) = eval(&sets);
            assert!(code == Some(2) && text.contains(said), "{sets:?}: {text}");
        }
    }
}
