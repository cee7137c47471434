//! Foreign truth: values and integrals that an arbitrary-precision program of its own computed from the papers
//! (tests/truth, mpmath: values to 50 digits, integrals to 20 and more). It shares no line with the shaders, their f64
//! twins or the f64 reference, and holds all three.

use crate::common::{bake, device, evaluators, listed, model, reference_model};
use crate::promises::{
    FLOOR, REFERENCE_INTEGRAL, REFERENCE_VALUE, STORED_F32, floor, integral_f32, reference_floor,
    value_f32_at, value_f64,
};
use gonio::bake::Evaluator;
use gonio::bake::points::Points;
use gonio::base::angles::Angles;
use gonio::base::half_angle::{Azimuth, Pair};
use gonio::check::Check;
use gonio::model::Model;
use gonio::model::lobe::Lobe;
use gonio::model::parameters::Setting;
use gonio::plan::TablePlan;
use gonio::reference::{self, Reference};
use gonio::table::axis::Variable::ThetaI;
use gonio::table::quantity::{RHO_DH, RHO_HH};
use rayon::prelude::*;
use std::fs;

// ---- The subjects: what each call of the code under test is --------------------------------------

/// (A, B) by the f64 reference.
fn reference_value(row: &Row, angles: &Angles) -> [f64; 2] {
    let &Angles { theta_i, phi_i, theta_e, .. } = angles;
    let angles = gonio::reference::Angles { theta_i, theta_e, delta_phi: angles.delta_phi(), phi_i };
    let (reference, setting) = reference_of(row);
    reference.brdf(&angles, &setting).unwrap()
}

/// ρ_dh at θi, or ρ_hh, by the f64 reference.
fn reference_integral(row: &Row) -> [f64; 2] {
    let (reference, setting) = reference_of(row);
    row.theta_i().map_or_else(|| reference.rho_hh(&setting), |theta| reference.rho_dh(theta.cos(), &setting))
}

/// The reference of a row's model, at its setting.
fn reference_of(row: &Row) -> (&'static dyn Reference, reference::Setting) {
    let reference = reference_model(row.lobe.model().name);
    let mut parameters = reference::Parameters::DEFAULT;
    let model = row.lobe.model();
    for parameter in model.parameters {
        parameters.set(parameter.name, row.lobe.parameters()[parameter.place]).unwrap();
    }
    (reference, reference::Setting::measured(reference.measure(), row.alpha, &parameters).unwrap())
}

/// (A, B) by the f64 twin of the shaders, before anything is stored in f32.
fn twin_value(model: &Model, angles: &Angles, setting: &Setting) -> [f64; 2] {
    let pair = Pair::new(angles.theta_i, angles.theta_e);
    (model.lobe)(&pair, &Azimuth::at(angles.phi_i, angles.delta_phi()), setting)
}

// ---- The files -------------------------------------------------------------------------------------

const HEADERS: [&str; 2] =
    ["model,parameters,theta_i,phi_i,theta_e,phi_e,A,B", "model,parameters,quantity,theta_i,A,B"];

/// A row: a lobe of a model with unit weights, where it is asked for, and the truth.
struct Row {
    /// The row without its numbers.
    name: String,
    lobe: Lobe,
    /// The model's own measure of its shape, which √α as a roughness would round.
    alpha: f64,
    place: Place,
    truth: Vec<f64>,
}

#[derive(Clone, Copy)]
enum Place {
    Value(Angles),
    /// ρ_dh at θi.
    Directional(f64),
    /// ρ_hh.
    Hemispherical,
}

impl Row {
    fn new(line: &str) -> Self {
        let words: Vec<_> = line.split(',').collect();
        let number = |word: &str| -> f64 { word.parse().unwrap_or_else(|_| panic!("{word} in {line}")) };
        let (place, truth) = match words[2..] {
            [theta_i, phi_i, theta_e, phi_e, ref truth @ ..] if truth.len() == 2 => {
                let [theta_i, phi_i, theta_e, phi_e] = [theta_i, phi_i, theta_e, phi_e].map(number);
                (Place::Value(Angles { theta_i, phi_i, theta_e, phi_e }), truth)
            }
            ["rho_dh", theta_i, ref truth @ ..] => (Place::Directional(number(theta_i)), truth),
            ["rho_hh", "", ref truth @ ..] => (Place::Hemispherical, truth),
            _ => panic!("{line}"),
        };
        let model = model(words[0]);
        let weights = [[1.0, 0.0], [0.0, 1.0]][..model.components.len()].to_vec();
        let mut row = Self {
            name: words[..words.len() - 2].join(","),
            lobe: Lobe::new(model, None, weights).unwrap(),
            alpha: 0.0,
            place,
            truth: truth.iter().filter(|word| !word.is_empty()).map(|word| number(word)).collect(),
        };
        for parameter in words[1].split(';').filter(|word| !word.is_empty()) {
            let (name, value) = parameter.split_once('=').unwrap();
            match model.shape.filter(|shape| shape.name == name) {
                Some(shape) => {
                    row.alpha = number(value);
                    row.lobe.set("roughness", shape.roughness(row.alpha)).unwrap();
                }
                None => row.lobe.set(name, number(value)).unwrap(),
            }
        }
        assert_eq!(row.truth.len(), model.components.len(), "{line}");
        row
    }

    fn setting(&self) -> Setting {
        self.lobe.setting(self.alpha)
    }

    fn angles(&self) -> Angles {
        let Place::Value(angles) = self.place else { panic!("{}", self.name) };
        angles
    }

    fn theta_i(&self) -> Option<f64> {
        if let Place::Directional(theta) = self.place { Some(theta) } else { None }
    }
}

fn text(file: &str) -> String {
    let path = format!("{}/tests/truth/{file}", env!("CARGO_MANIFEST_DIR"));
    fs::read_to_string(&path).unwrap_or_else(|why| panic!("{path}: {why}"))
}

fn rows(text: &str) -> Vec<Row> {
    let (header, lines) = text.split_once('\n').unwrap();
    assert!(HEADERS.contains(&header), "{header}");
    lines.lines().map(Row::new).collect()
}

// ---- The comparers ---------------------------------------------------------------------------------

/// The rows of which a component is off by more than allowed, which depends on the truth. NaN is no number that is small
/// enough.
fn beyond(rows: &[Row], values: &[Vec<f64>], allowed: impl Fn(&Row, f64) -> f64) -> Vec<String> {
    assert_eq!(rows.len(), values.len());
    let (mut failures, mut worst) = (Vec::new(), (0.0, ""));
    for (row, values) in rows.iter().zip(values) {
        for (value, &truth) in values.iter().zip(&row.truth) {
            let (error, allowed) = ((value - truth).abs(), allowed(row, truth));
            if error / allowed > worst.0 {
                worst = (error / allowed, &row.name);
            }
            if error.is_nan() || error > allowed {
                failures
                    .push(format!("{}: {value:e}, not {truth:e}: {error:.1e} of {allowed:.1e}", row.name));
            }
        }
    }
    println!("{} rows, at most {:.2} of what is allowed: {}", rows.len(), worst.0, worst.1);
    failures
}

/// Of errors that are relative, but to no less than a floor.
fn relative(error: f64, floor: f64, truth: f64) -> f64 {
    error * truth.abs().max(floor)
}

fn assert_none(failures: &[String]) {
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

/// The values of a row by each path.
fn by_reference(rows: &[Row]) -> Vec<Vec<f64>> {
    let value = |row: &Row| match row.place {
        Place::Value(angles) => reference_value(row, &angles),
        _ => reference_integral(row),
    };
    rows.par_iter().map(|row| value(row).to_vec()).collect()
}

fn by_twin(rows: &[Row]) -> Vec<Vec<f64>> {
    rows.iter().map(|row| twin_value(row.lobe.model(), &row.angles(), &row.setting()).to_vec()).collect()
}

/// Values in f32; what one model's rows share is made once.
fn by_points(evaluator: &Evaluator, rows: &[Row]) -> Vec<Vec<f64>> {
    let of_model = |rows: &[Row]| {
        let mut points = Points::new(evaluator, std::slice::from_ref(&rows[0].lobe)).unwrap();
        let mut value = |row: &Row| {
            let mut values = Vec::new();
            points.set(std::slice::from_ref(&row.lobe)).unwrap();
            points.sweep(&[row.alpha], &[row.angles()], &mut values).unwrap();
            values.into_iter().map(f64::from).collect()
        };
        rows.iter().map(&mut value).collect::<Vec<_>>()
    };
    rows.chunk_by(|a, b| a.lobe.model() == b.lobe.model()).flat_map(of_model).collect()
}

/// Integrals, by tables over the θi of the rows that share all else.
fn by_tables(evaluator: &Evaluator, rows: &[Row], tolerance: impl Fn(&Row) -> f64) -> Vec<Vec<f64>> {
    let table = |rows: &[Row]| {
        let lobe = &rows[0].lobe;
        let thetas: Vec<_> = rows.iter().filter_map(Row::theta_i).collect();
        let (quantity, axes) =
            if thetas.is_empty() { (&RHO_HH, vec![]) } else { (&RHO_DH, vec![listed(ThetaI, &thetas)]) };
        let plan = TablePlan::basis("truth", quantity, lobe.model(), lobe.roughness(), axes).unwrap();
        let plan = plan.with_lobes(vec![lobe.clone()]).unwrap().with_tolerance(tolerance(&rows[0])).unwrap();
        let table = bake(evaluator, &plan, Check::Sample(0));
        let texel = |row: &Row| match row.theta_i() {
            Some(theta) => table.axes[0].values().iter().position(|&x| x == theta).unwrap(),
            None => 0,
        };
        rows.iter().map(|row| table.texel(texel(row))).collect::<Vec<_>>()
    };
    let alike = |a: &Row, b: &Row| a.lobe == b.lobe && a.theta_i().is_some() == b.theta_i().is_some();
    rows.chunk_by(alike).flat_map(table).collect()
}

// ---- The rows --------------------------------------------------------------------------------------

/// Twelve places of each model, the extremes among them, and every part on GGX.
#[test]
fn every_part_has_its_rows() {
    let rows = rows(&text("values.csv"));
    for of_model in rows.chunk_by(|a, b| a.lobe.model() == b.lobe.model()) {
        assert_eq!(of_model.len(), 12, "{}", of_model[0].lobe.model().name);
    }
    let has = |name: &str| rows.iter().any(|row| row.lobe.model().name == name);
    let models = gonio::model::MODELS.into_iter().filter(|model| !model.is_delta());
    for model in models {
        assert!(has(model.name), "{} has no rows in tests/truth/values.csv", model.name);
    }
    for normals in gonio::model::MICROFACETS.iter().map(|model| model.microfacet.unwrap().ndf.name) {
        assert!(has(normals), "{normals} has no rows in tests/truth/values.csv");
    }
    let ggx = model("ggx");
    for (kind, terms, _) in ggx.terms() {
        for term in terms {
            let [masking, fresnel] =
                if kind == "masking" { [Some(term.name), None] } else { [None, Some(term.name)] };
            let name = ggx.with_terms(masking, fresnel).unwrap().name;
            assert!(has(name), "{name} has no rows in tests/truth/values.csv");
        }
    }
}

// ---- What is held ----------------------------------------------------------------------------------

fn reference_misses(rows: &[Row]) -> Vec<String> {
    beyond(rows, &by_reference(rows), |row, truth| match row.place {
        Place::Value(_) => relative(REFERENCE_VALUE, reference_floor(row.lobe.model()), truth),
        _ => REFERENCE_INTEGRAL,
    })
}

fn twins_miss(rows: &[Row]) -> Vec<String> {
    beyond(rows, &by_twin(rows), |row, truth| relative(value_f64(row.lobe.model()), FLOOR, truth))
}

fn device_misses(rows: &[Row]) -> Vec<String> {
    let model = |row: &Row| row.lobe.model();
    beyond(rows, &by_points(device(), rows), |row, truth| {
        relative(value_f32_at(model(row), &row.setting()), floor(model(row)), truth)
    })
}

fn tables_miss(evaluator: &Evaluator, rows: &[Row], tolerance: impl Fn(&Row) -> f64) -> Vec<String> {
    beyond(rows, &by_tables(evaluator, rows, &tolerance), |row, _| tolerance(row))
}

#[test]
fn the_reference_has_the_values() {
    assert_none(&reference_misses(&rows(&text("values.csv"))));
}

#[test]
fn the_reference_has_the_integrals() {
    assert_none(&reference_misses(&rows(&text("integrals.csv"))));
}

/// Values of the shaders' twins, in f64 and as the CPU path stores them.
#[test]
fn the_cpu_path_has_the_values() {
    let rows = rows(&text("values.csv"));
    assert_none(&twins_miss(&rows));
    let stored = by_points(&Evaluator::Cpu, &rows);
    assert_none(&beyond(&rows, &stored, |row, truth| {
        relative(STORED_F32 + value_f64(row.lobe.model()), FLOOR, truth)
    }));
}

#[test]
fn the_device_has_the_values() {
    assert_none(&device_misses(&rows(&text("values.csv"))));
}

/// Integrals of both evaluators: to a billionth, which is f64, and to what f32 meets. Parts without node counts take the CPU
/// path for a billionth: where a driver stops loops, a device refuses them below 1e-6.
#[test]
fn tables_have_the_integrals() {
    let rows = rows(&text("integrals.csv"));
    let (counted, uncounted): (Vec<_>, Vec<_>) = rows
        .into_iter()
        .partition(|row| !["student-t", "ggx-smith-joint-approx-schlick"].contains(&row.lobe.model().name));
    assert!(!uncounted.is_empty());
    assert_none(&tables_miss(&Evaluator::Cpu, &uncounted, |_| 1e-9));
    for evaluator in evaluators() {
        assert_none(&tables_miss(evaluator, &counted, |_| 1e-9));
    }
    let rows: Vec<_> = counted.into_iter().chain(uncounted).collect();
    for evaluator in evaluators() {
        assert_none(&tables_miss(evaluator, &rows, |row| integral_f32(row.lobe.model())));
    }
}

/// A wrong digit of a number in the files is seen by each comparer, in its row and in no other.
#[test]
fn a_wrong_digit_is_seen() {
    /// The rows of GGX, in the third of which a digit of A is another one.
    fn planted(file: &str, digit: usize) -> Vec<Row> {
        let text = text(file);
        let mut lines = text.lines();
        let header = lines.next().unwrap();
        let mut lines: Vec<_> = lines.filter(|line| line.starts_with("ggx,")).map(String::from).collect();
        let comma = lines[2].rfind(',').unwrap();
        let start = lines[2][..comma].rfind(',').unwrap() + 1;
        // A digit and a point stand before the second digit.
        let at = start + digit;
        let was = lines[2].as_bytes()[at] - b'0';
        lines[2].replace_range(at..=at, &((was + 1) % 10).to_string());
        rows(&format!("{header}\n{}", lines.join("\n")))
    }
    let assert_third = |rows: &[Row], failures: Vec<String>| {
        assert!(rows.len() > 3 && failures.len() == 1, "{failures:?}");
        assert!(failures[0].starts_with(&rows[2].name), "{failures:?}");
    };
    let rows = planted("values.csv", 11);
    assert_third(&rows, reference_misses(&rows));
    let rows = planted("values.csv", 7);
    assert_third(&rows, twins_miss(&rows));
    let rows = planted("values.csv", 5);
    assert_third(&rows, device_misses(&rows));
    let rows = planted("integrals.csv", 8);
    assert_third(&rows, reference_misses(&rows));
    assert_third(&rows, tables_miss(&Evaluator::Cpu, &rows, |_| 1e-9));
    let rows = planted("integrals.csv", 5);
    assert_third(&rows, tables_miss(device(), &rows, |row| integral_f32(row.lobe.model())));
}
