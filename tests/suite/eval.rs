//! Promises of values at lists of directions: they are those of tables, they keep their digits near the
//! mirror direction, and `gonio eval` carries them from file to file.

use crate::common::readers;
use crate::common::*;
use crate::promises::{FLOOR, STORED_F32, VALUE_F32, value_f32};
use gonio::bake::points::Points;
use gonio::base::angles::{Angles, PHI_MAX};
use gonio::check::Check;
use gonio::model::lobe::Lobe;
use gonio::model::{MICROFACETS, MIRRORS, MODELS};
use gonio::plan::TablePlan;
use gonio::reference::Angles as ReferenceAngles;
use gonio::table::axis::Variable::{DeltaPhi, ThetaE, ThetaI};
use gonio::table::quantity::BRDF;
use std::f64::consts::{FRAC_PI_2, PI};
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// A lobe with unit weights: its components are its channels.
fn unit(name: &str, alpha: f64) -> Lobe {
    let model = model(name);
    let weights = [[1.0, 0.0], [0.0, 1.0]][..model.components.len()].to_vec();
    Lobe::new(model, model.shape.map(|_| alpha.sqrt()), weights).unwrap()
}

fn evaluate(points: &mut Points, angles: &[Angles]) -> Vec<f32> {
    let mut values = vec![1.0; 7]; // what was there goes
    points.evaluate(angles, &mut values).unwrap();
    values
}

/// Directions anywhere, azimuths of several turns among them.
fn anywhere(n: usize) -> Vec<Angles> {
    let [a, b, c, d] = [0.1, 0.3, 0.5, 0.7].map(|seed| golden(n, seed * seed));
    let angles = |k: usize| Angles {
        theta_i: a[k] * FRAC_PI_2,
        phi_i: (b[k * 7 % n] - 0.5) * 20.0,
        theta_e: c[k * 13 % n] * FRAC_PI_2,
        phi_e: (d[k * 29 % n] - 0.5) * 20.0,
    };
    (0..n).map(angles).collect()
}

// ---- Points ----------------------------------------------------------------------------------------

/// The same factors go through the same lobe: on a device bit for bit, unless its driver contracts a·b + c
/// differently in two kernels, which is worth the budget of values; on the CPU always.
#[test]
fn are_those_of_a_table() {
    for model in MODELS.into_iter().filter(|model| !model.is_delta()) {
        let roughness = model.shape.map(|_| 0.4);
        let axes = vec![axis(ThetaI, 7), axis(ThetaE, 13), axis(DeltaPhi, 9)];
        let plan = TablePlan::basis("table", &BRDF, model, roughness, axes).unwrap();
        let mut angles = Vec::new();
        for &theta_i in plan.axes()[0].values() {
            for &theta_e in plan.axes()[1].values() {
                let phi_i = 0.3;
                let pair = |&d: &f64| Angles { theta_i, phi_i, theta_e, phi_e: phi_i + PI + d };
                angles.extend(plan.axes()[2].values().iter().map(pair));
            }
        }
        for (evaluator, budget) in evaluators().into_iter().zip([value_f32(model), STORED_F32]) {
            let table = bake(evaluator, &plan, Check::Sample(0));
            let values = evaluate(&mut Points::new(evaluator, plan.lobes()).unwrap(), &angles);
            assert_eq!(values.len(), table.values.len());
            for (k, &value) in values.iter().enumerate() {
                let (value, of_table) = (f64::from(value), table.values.get(k));
                // φe is rounded to 4e-16, of δφ ≥ 0.4 or of 0.
                let budget = budget + 1e-14;
                let scale = of_table.max(FLOOR);
                assert!((value - of_table).abs() <= budget * scale, "{}: {value}, {of_table}", model.name);
            }
        }
    }
}

/// δφ of the very numbers given, in whole units of 2⁻¹⁰⁰: an azimuth below 8 has no digit beyond 2⁻¹⁰⁰
/// that counts, and π has 30 decimal digits so.
fn exact_delta_phi(angles: &Angles) -> f64 {
    const PI_100: i128 = 0x0032_43F6_A888_5A30_8D31_3198_A2E0;
    let fixed = |x: f64| {
        let (bits, sign) = (x.abs().to_bits(), x.signum() as i128);
        let (exponent, fraction) = ((bits >> 52) as i32, (bits & ((1 << 52) - 1)) as i128);
        let (mantissa, shift) = (fraction | 1 << 52, exponent - 1075 + 100);
        sign * if x == 0.0 {
            0
        } else if shift >= 0 {
            mantissa << shift
        } else {
            mantissa >> -shift.max(-127)
        }
    };
    let delta = fixed(angles.phi_e) - fixed(angles.phi_i) - PI_100;
    let delta = (delta + PI_100 - 1).rem_euclid(2 * PI_100) - PI_100 + 1;
    delta as f64 / 2f64.powi(100)
}

/// δφ is right to two roundings, however near the mirror direction, and lies in (−π, π].
#[test]
fn the_relative_azimuth_keeps_its_digits() {
    let mut angles = anywhere(100_000);
    for phi_i in [0.0, 1e-9, 0.3, 1.0, 3.0, -2.5, 6.0] {
        for delta in [0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3, 1.0, PI] {
            for turns in [-1.0, 0.0, 1.0] {
                let phi_e = phi_i + PI + delta + turns * 2.0 * PI;
                angles.push(Angles { theta_i: 1.0, phi_i, theta_e: 1.0, phi_e });
                angles.push(Angles { theta_i: 1.0, phi_i: phi_e, theta_e: 1.0, phi_e: phi_i });
            }
        }
    }
    for pair in &angles {
        let (delta, exact) = (pair.delta_phi(), exact_delta_phi(pair));
        assert!((-PI..=PI).contains(&delta), "{pair:?}: {delta}");
        // Either end of the circle is the same direction.
        let off = (delta - exact).abs().min(2.0 * PI - (delta - exact).abs());
        assert!(off <= 2.0 * f64::EPSILON * exact.abs() + 1e-30, "{pair:?}: {delta:e}, {exact:e}");
    }
}

/// Pairs a millionth of a radian and less from the mirror direction, in θ, in φ and in both, on lobes that
/// are as narrow: within the budget of values, which knows no angle. There f is not the peak's: with
/// tan θm = 5e-7 and α = 1e-6, D is (1 + 0.5²)⁻² = 0.64 of it.
#[test]
fn a_millionth_of_a_radian_from_the_mirror_is_seen() {
    let mut angles = Vec::new();
    for theta in [1e-3, 0.3, 0.7, 1.2, 1.57] {
        for phi_i in [0.0, 0.3, 1.9, -3.0] {
            for (dt, dp) in [(0.0, 0.0), (1e-6, 0.0), (0.0, 1e-6), (3e-7, -1e-6), (-1e-6, 2e-6), (1e-9, 1e-5)]
            {
                let phi_e = phi_i + PI + dp;
                angles.push(Angles { theta_i: theta, phi_i, theta_e: theta + dt, phi_e });
            }
        }
    }
    for alpha in [1e-6, 1e-5] {
        let lobe = unit("ggx", alpha);
        let alpha = lobe.roughness().unwrap().powi(2);
        for evaluator in evaluators() {
            let mut points = Points::new(evaluator, std::slice::from_ref(&lobe)).unwrap();
            let values = evaluate(&mut points, &angles);
            let beside = values[2] / values[0];
            assert!(alpha > 2e-6 || (beside / 0.64 - 1.0).abs() < 0.01, "a millionth is lost: {beside}");
            for (pair, value) in angles.iter().zip(values.chunks_exact(2)) {
                let delta_phi = exact_delta_phi(pair);
                let at = ReferenceAngles {
                    theta_i: pair.theta_i,
                    theta_e: pair.theta_e,
                    delta_phi,
                    phi_i: pair.phi_i,
                };
                let ggx = reference_model("ggx");
                let truth = ggx.brdf(&at, &with_alpha(ggx, alpha)).unwrap();
                for (value, truth) in value.iter().zip(truth) {
                    let error = (f64::from(*value) - truth).abs() / truth.max(FLOOR);
                    assert!(error <= VALUE_F32, "α = {alpha}, {pair:?}: {value} and {truth}, {error:.2e}");
                }
            }
        }
    }
}

/// Chunks, the order of settings and the sum of lobes: a long list is the list of its points, a sweep is
/// one evaluation after the other, and a sum is a sum.
#[test]
fn do_not_depend_on_how_they_are_asked_for() {
    let angles = anywhere(150_000);
    for evaluator in evaluators() {
        let mut ggx = Points::new(evaluator, &[unit("ggx", 0.1)]).unwrap();
        let whole = evaluate(&mut ggx, &angles);
        assert_eq!(whole.len(), 2 * angles.len());
        for first in [0, 70_000, 131_071, 149_990] {
            let part = evaluate(&mut ggx, &angles[first..first + 10]);
            assert_eq!(part, whole[2 * first..2 * (first + 10)], "{first}");
        }

        let few = &angles[..3000];
        let alphas: Vec<_> = golden(70, 0.2).iter().map(|u| 1e-6 + 0.9 * u).collect();
        let mut swept = Vec::new();
        ggx.sweep(&alphas, few, &mut swept).unwrap();
        for (&alpha, swept) in alphas.iter().zip(swept.chunks_exact(2 * few.len())) {
            let mut alone = Vec::new();
            ggx.sweep(&[alpha], few, &mut alone).unwrap();
            assert_eq!(swept, alone, "{alpha}");
        }

        // glTF's white dielectric; the sum is rounded once, and each part before it.
        let lobe = |name, roughness, weights| Lobe::new(model(name), roughness, vec![weights; 3]).unwrap();
        let parts = [lobe("gltf_diffuse", None, [0.96, 0.0]), lobe("ggx", Some(0.5), [0.04, 1.0])];
        let of = |lobes: &[Lobe]| evaluate(&mut Points::new(evaluator, lobes).unwrap(), few);
        let [sum, diffuse, specular] = [of(&parts), of(&parts[..1]), of(&parts[1..])];
        for (k, &sum) in sum.iter().enumerate() {
            let apart = diffuse[k] + specular[k];
            assert!((sum - apart).abs() <= 2.0 * f32::EPSILON * apart, "{sum} and {apart}");
        }
        assert!(evaluate(&mut ggx, &[]).is_empty());
    }
}

#[test]
fn refuse_what_is_no_direction() {
    let good = Angles { theta_i: 0.0, phi_i: -PHI_MAX, theta_e: FRAC_PI_2, phi_e: PHI_MAX };
    let bad = [
        (Angles { theta_i: -1e-300, ..good }, "theta_i"),
        (Angles { theta_e: FRAC_PI_2 + 1e-15, ..good }, "theta_e"),
        (Angles { theta_i: f64::NAN, ..good }, "theta_i = NaN"),
        (Angles { phi_i: f64::INFINITY, ..good }, "phi_i = inf"),
        (Angles { phi_e: 2.0 * PHI_MAX, ..good }, "phi_e"),
    ];
    for evaluator in evaluators() {
        let mut points = Points::new(evaluator, &[unit("ggx", 0.5)]).unwrap();
        assert!(evaluate(&mut points, &[good])[0].is_finite());
        for (pair, word) in &bad {
            let error = points.evaluate(&[good, *pair], &mut Vec::new()).unwrap_err().to_string();
            assert!(error.contains(word) && error.contains("point 1"), "{error}");
        }
        for alpha in [0.0, 9e-7, 1.1, f64::NAN] {
            assert!(points.sweep(&[alpha], &[good], &mut Vec::new()).is_err(), "{alpha}");
        }
        let nothing: &[Lobe] = &[];
        let delta = unit("mirror", 0.5).with_weights(vec![[1.0; 2]]).unwrap();
        let unlike = [unit("ggx", 0.5), unit("lambert", 0.5)];
        assert!(Points::new(evaluator, nothing).is_err());
        assert!(Points::new(evaluator, &[delta]).is_err());
        assert!(Points::new(evaluator, &unlike).is_err());
        let rough = Lobe::new(model("ggx"), None, unit("ggx", 0.5).weights().to_vec()).unwrap();
        let mut rough = Points::new(evaluator, &[rough]).unwrap();
        assert!(rough.evaluate(&[good], &mut Vec::new()).unwrap_err().to_string().contains("roughness"));
        rough.sweep(&[0.5], &[good], &mut Vec::new()).unwrap();
    }
}

// ---- From file to file -----------------------------------------------------------------------------

const GGX: [&str; 3] = ["--model=ggx", "--set=alpha=0.1", "--set=f0=[1.0,0.5,0.2]"];

fn gonio(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_gonio")).arg("eval").args(arguments).output().unwrap()
}

fn list(pairs: &Path, out: &Path, more: &[&str]) -> Output {
    let [pairs, out] = [pairs, out].map(|path| path.to_str().unwrap());
    gonio(&[&GGX[..], &["--pairs", pairs, "--out", out], more].concat())
}

fn error(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// An NPY file by the format's specification.
fn npy(descr: &str, fortran: bool, shape: &str, data: &[u8]) -> Vec<u8> {
    let fortran = if fortran { "True" } else { "False" };
    let mut header = format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, }}");
    while (header.len() + 11) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    let length = (header.len() as u16).to_le_bytes();
    [b"\x93NUMPY\x01\x00", &length[..], header.as_bytes(), data].concat()
}

fn columns(angles: &[Angles]) -> impl Iterator<Item = f64> {
    angles.iter().flat_map(|a| [a.theta_i, a.phi_i, a.theta_e, a.phi_e])
}

/// Rows of a CSV file with a header.
fn csv(path: &Path) -> (String, Vec<f32>) {
    let text = fs::read_to_string(path).unwrap();
    let (header, rows) = text.split_once('\n').unwrap();
    let values = rows.lines().flat_map(|row| row.split(',').map(|word| word.parse().unwrap())).collect();
    (header.into(), values)
}

/// The same pairs in every form give the same bits in every form: nine digits tell every f32.
#[test]
fn every_format_carries_the_same_values() {
    let dir = tempfile::tempdir().unwrap();
    let file = |name: &str| dir.path().join(name);
    let mut angles = anywhere(1000);
    angles[17].theta_i = FRAC_PI_2;
    let shape = "(1000, 4)";
    let little: Vec<_> = columns(&angles).flat_map(f64::to_le_bytes).collect();
    let big: Vec<_> = columns(&angles).flat_map(f64::to_be_bytes).collect();
    fs::write(file("little.npy"), npy("<f8", false, shape, &little)).unwrap();
    fs::write(file("big.npy"), npy(">f8", false, shape, &big)).unwrap();
    let mut text = String::from("\u{feff}# made for a test\n\"theta_i\", phi_i,theta_e,phi_e\r\n\n");
    for a in &angles {
        text += &format!("{}, {:e},{},{}\r\n", a.theta_i, a.phi_i, a.theta_e, a.phi_e);
    }
    fs::write(file("header.csv"), &text).unwrap();
    fs::write(file("plain.csv"), text.split_once("\n\n").unwrap().1.trim_end()).unwrap();

    for device in ["--device=auto", "--device=cpu"] {
        let mut all = Vec::new();
        for name in ["little.npy", "big.npy", "header.csv", "plain.csv"] {
            for out in ["out.npy", "out.csv"] {
                let run = list(&file(name), &file(out), &[device, "--json"]);
                assert!(run.status.success(), "{name}: {}", error(&run));
                let summary: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
                assert_eq!(summary["points"], 1000);
                assert_eq!(summary["not_finite_or_negative"], 0);
                let values = if out == "out.npy" {
                    let (shape, values) = readers::npy(&fs::read(file(out)).unwrap()).unwrap();
                    assert_eq!(shape, [1000, 3]);
                    values
                } else {
                    let (header, values) = csv(&file(out));
                    assert_eq!(header, "R,G,B");
                    values
                };
                all.push(values);
            }
        }
        assert_eq!(all[0].len(), 3000);
        assert!(all.iter().all(|values| *values == all[0]));

        // And they are what the library says; roughness = √α is rounded on the way.
        let evaluator = if device == "--device=cpu" { evaluators()[1] } else { evaluators()[0] };
        let weights = [1.0, 0.5, 0.2].map(|f0| [f0, 1.0]).to_vec();
        let lobe = Lobe::new(model("ggx"), Some(0.1f64.sqrt()), weights).unwrap();
        assert_eq!(evaluate(&mut Points::new(evaluator, &[lobe]).unwrap(), &angles), all[0]);
    }
    let left: Vec<_> = fs::read_dir(dir.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left.len(), 6, "nothing but what was asked for: {left:?}");
}

/// float32 angles are those numbers; only π/2, which it rounds up, is π/2. An empty list is a list.
#[test]
fn single_precision_and_empty_lists_are_taken() {
    let dir = tempfile::tempdir().unwrap();
    let (pairs, out) = (dir.path().join("pairs.npy"), dir.path().join("out.npy"));
    let rows = [[0.5f32, 0.1, 0.7, 3.0], [FRAC_PI_2 as f32, 0.0, 1.0, 2.0]];
    let data: Vec<_> = rows.as_flattened().iter().copied().flat_map(f32::to_le_bytes).collect();
    fs::write(&pairs, npy("<f4", false, "(2, 4)", &data)).unwrap();
    let run = list(&pairs, &out, &[]);
    assert!(run.status.success(), "{}", error(&run));
    let (shape, values) = readers::npy(&fs::read(&out).unwrap()).unwrap();
    let [a, b] = rows.map(|row| row.map(f64::from));
    let doubles = [
        Angles { theta_i: a[0], phi_i: a[1], theta_e: a[2], phi_e: a[3] },
        Angles { theta_i: FRAC_PI_2, phi_i: b[1], theta_e: b[2], phi_e: b[3] },
    ];
    let weights = [1.0, 0.5, 0.2].map(|f0| [f0, 1.0]).to_vec();
    let lobe = Lobe::new(model("ggx"), Some(0.1f64.sqrt()), weights).unwrap();
    assert_eq!(shape, [2, 3]);
    assert_eq!(values, evaluate(&mut Points::new(device(), &[lobe]).unwrap(), &doubles));

    fs::write(&pairs, npy("<f8", false, "(0, 4)", &[])).unwrap();
    assert!(list(&pairs, &out, &[]).status.success());
    assert_eq!(readers::npy(&fs::read(&out).unwrap()).unwrap(), (vec![0, 3], vec![]));
}

/// Bad lists are refused with exit code 2, the file, the place and the remedy, and what was there stays.
#[test]
fn bad_lists_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("out.csv");
    fs::write(&out, "mine").unwrap();
    let row = |x: f64| [0.1, 0.2, x, 0.4].into_iter().flat_map(f64::to_le_bytes).collect::<Vec<_>>();
    let good = row(0.3);
    let long = npy("<f8", false, "(1, 4)", &good);
    let deep = "(".repeat(60_000);
    let cases: Vec<(&str, Vec<u8>, &[&str])> = vec![
        ("a.npy", npy("<f8", true, "(1, 4)", &good), &["Fortran", "ascontiguousarray"]),
        ("b.npy", npy("<f8", false, "(4, 1)", &good), &["(4, 1)", "(n, 4)"]),
        ("c.npy", npy("<f8", false, "(4,)", &good), &["(4,)", "(n, 4)"]),
        ("d.npy", npy("<i8", false, "(1, 4)", &good), &["<i8", "float64"]),
        ("e.npy", npy("<f8", false, "(2, 4)", &good), &["ends", "2 rows"]),
        ("f.npy", npy("<f8", false, "(1152921504606846976, 4)", &good), &["ends"]),
        ("g.npy", npy("<f8", false, &deep, &good), &["shape"]),
        ("h.npy", long[..40].to_vec(), &["ends", "header"]),
        ("i.npy", b"theta_i,phi_i".to_vec(), &["not an NPY file"]),
        (
            "j.npy",
            npy("<f8", false, "(2, 4)", &[good.clone(), row(1.6)].concat()),
            &["row 1", "theta_e = 1.6"],
        ),
        ("k.npy", npy("<f8", false, "(1, 4)", &row(f64::NAN)), &["row 0", "theta_e = NaN"]),
        ("l.csv", b"phi_i,theta_i,theta_e,phi_e\n".to_vec(), &["line 1", "theta_i,phi_i,theta_e,phi_e"]),
        ("m.csv", b"# a list\n0,0,0,0\n0,0,0\n".to_vec(), &["line 3", "3 columns", "four"]),
        ("n.csv", b"0,0,0,0\n0,0,zero,0\n".to_vec(), &["line 2", "theta_e", "zero"]),
        ("o.csv", b"0,0,0,0\n\n0,0,-0.1,0\n".to_vec(), &["line 3", "theta_e = -0.1"]),
        ("p.csv", b"0,inf,0,0\n".to_vec(), &["line 1", "phi_i = inf"]),
        ("q.csv", b"0,0,0,\xff\n".to_vec(), &["line 1", "UTF-8"]),
        ("s.csv", [b"0,0,0,0\n#", &[b'x'; 1 << 16][..], b"\n0,0,0,0\n"].concat(), &["line 2", "65536 bytes"]),
        ("r.txt", b"0,0,0,0\n".to_vec(), &[".npy", ".csv"]),
    ];
    for (name, bytes, words) in cases {
        let pairs = dir.path().join(name);
        fs::write(&pairs, bytes).unwrap();
        let run = list(&pairs, &out, &[]);
        let error = error(&run);
        assert_eq!(run.status.code(), Some(2), "{name}: {error}");
        for word in words.iter().chain(&[name]) {
            assert!(error.contains(word), "{word} in {error}");
        }
        assert_eq!(fs::read_to_string(&out).unwrap(), "mine", "{name}");
        fs::remove_file(pairs).unwrap();
    }
    let left = fs::read_dir(dir.path()).unwrap().count();
    assert_eq!(left, 1, "a refused list leaves nothing");

    let pairs = dir.path().join("pairs.csv");
    fs::write(&pairs, "0,0,0,0\n").unwrap();
    let code = |output: Output| output.status.code();
    assert_eq!(code(list(&dir.path().join("none.csv"), &out, &[])), Some(2));
    assert_eq!(code(list(&pairs, &pairs, &[])), Some(2), "the list itself");
    assert_eq!(code(list(&pairs, dir.path(), &[])), Some(2), "a folder");
    assert_eq!(code(list(&pairs, &dir.path().join("none/out.npy"), &[])), Some(2));
    for more in ["--theta-i=0", "--theta-e=0", "--phi-i=0", "--phi-e=0"] {
        assert_eq!(code(list(&pairs, &out, &[more])), Some(2), "{more} beside a list");
    }
    assert_eq!(
        code(gonio(&["--model=lambert", "--set=albedo=1", "--pairs", "x.csv"])),
        Some(2),
        "into what?"
    );
    assert_eq!(fs::read_to_string(&pairs).unwrap(), "0,0,0,0\n");
}

// ---- One pair --------------------------------------------------------------------------------------

/// f cos θi, D, G2 and F of one pair make f, and the mirror direction is δφ = 0.
#[test]
fn one_pair_is_taken_apart() {
    let one = |more: &[&str]| {
        let run = gonio(&[&GGX[..], &["--theta-i=0.5", "--theta-e=0.8"], more].concat());
        assert!(run.status.success(), "{}", error(&run));
        String::from_utf8(run.stdout).unwrap()
    };
    let json: serde_json::Value = serde_json::from_str(&one(&["--phi-e=3", "--json"])).unwrap();
    let factors = &json["factors"][0];
    let [d, g2] = ["D", "G2"].map(|key| factors[key].as_f64().unwrap());
    for k in 0..3 {
        let f = factors["F"][k].as_f64().unwrap() * d * g2 / (4.0 * 0.5f64.cos() * 0.8f64.cos());
        let [value, reference] = ["value", "reference"].map(|key| json[key][k].as_f64().unwrap());
        assert!((f / reference - 1.0).abs() < 1e-12, "{json}");
        assert!((f / value - 1.0).abs() < VALUE_F32, "{json}");
        assert!((json["f_cos_theta_i"][k].as_f64().unwrap() / (value * 0.5f64.cos()) - 1.0).abs() < 1e-12);
    }
    let words = one(&[]);
    for word in ["δφ = 0 rad", "f cos θi", "D ", "G2 ", "F  "] {
        assert!(words.contains(word), "{word} in {words}");
    }
    assert!(one(&["--phi-i=0.3"]).contains("δφ = 0 rad"));
    assert!(one(&["--phi-e=3.141593"]).contains("δφ = 0.000000346"), "what is not 0 is shown");
}

/// Anisotropic models are evaluated at all four angles. A turn by 90° exchanges αx and αy.
#[test]
fn one_pair_of_an_anisotropic_model() {
    let value = |alpha: &str, phi_i: &str, phi_e: &str| {
        let angles = ["--theta-i=0.5", "--theta-e=0.8", phi_i, phi_e, "--device=cpu", "--json"];
        let output = gonio(&[&["--model=ggx", "--set=f0=1", alpha][..], &angles].concat());
        let json: serde_json::Value =
            serde_json::from_slice(&output.stdout).unwrap_or_else(|why| panic!("{why}: {}", error(&output)));
        assert!(json["relative_difference"].as_f64().unwrap() < 1e-6, "{json}");
        json["value"][0].as_f64().unwrap()
    };
    let along = value("--set=alpha=[0.1,0.4]", "--phi-i=0", "--phi-e=180deg");
    let across = value("--set=alpha=[0.1,0.4]", "--phi-i=90deg", "--phi-e=270deg");
    let exchanged = value("--set=alpha=[0.4,0.1]", "--phi-i=-90deg", "--phi-e=90deg");
    assert!((across / along - 1.0).abs() > 0.1, "{along} {across}");
    assert!((exchanged / along - 1.0).abs() < 1e-6, "{along} {exchanged}");
}

/// Terms of a microfacet model by the words of recipes. By hand, retro-reflection at normal incidence with
/// α = 0.1: f = D/4, D = 1/(πα²), as G2 = F = 1.
#[test]
fn the_terms_of_a_model_are_chosen_by_name() {
    let straight = ["--set=alpha=0.1", "--theta-i=0", "--theta-e=0", "--device=cpu", "--json"];
    let terms = ["--model=ggx", "--set=masking=smith-separable", "--set=fresnel=none"];
    let output = gonio(&[&terms[..], &straight].concat());
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let value = json["value"][0].as_f64().unwrap();
    assert!((value * 4.0 * PI * 0.01 - 1.0).abs() < 1e-6, "{value}");
    assert_eq!(json["subject"], "ggx-smith-separable-none");
    for (set, words) in [
        ("--set=masking=smith", "smith-correlated, smith-separable, schlick-ggx"),
        ("--set=fresnel=exact", "schlick, none"),
        ("--set=masking=2", "a text in quotes"),
    ] {
        let output = gonio(&[&["--model=ggx", set], &straight[..]].concat());
        assert_eq!(output.status.code(), Some(2));
        assert!(error(&output).contains(words), "{}", error(&output));
    }
    let output = gonio(&[&["--model=ggx", "--set=fresnel=none", "--set=f90=1"], &straight[..]].concat());
    assert!(error(&output).contains("f90: unknown key"), "{}", error(&output));
    let output =
        gonio(&[&["--model=lambert", "--set=albedo=1", "--set=masking=none"], &straight[..]].concat());
    assert!(error(&output).contains("masking"), "{}", error(&output));
}

/// The list names what recipes can say, and each model of it has a page.
#[test]
fn models_are_listed_and_described() {
    let models = |more: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_gonio")).arg("models").args(more).output().unwrap();
        (output.status.code(), String::from_utf8(output.stdout).unwrap())
    };
    let (_, list) = models(&[]);
    // What a test registers in this process, the command does not know.
    for model in MODELS.into_iter().chain(MICROFACETS.iter()).chain(MIRRORS.iter()) {
        let (code, page) = models(&[model.name]);
        assert!(code == Some(0) && page.contains(model.source), "{page}");
        assert!(model.components.iter().all(|component| page.contains(component.weight)), "{page}");
    }
    assert!(["ggx", "mirror", "smith-separable", "schlick"].iter().all(|word| list.contains(word)), "{list}");
    assert_eq!(models(&["plastic"]).0, Some(2));
}
