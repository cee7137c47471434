//! Promises of the command line: what it writes, what it prints and where, its exit codes, and that
//! whatever fails leaves the folder as it was.

use crate::common::readers;
use gonio::io::{sha256, verify};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

const OK: i32 = 0;
const PROMISE: i32 = 1;
const INPUT: i32 = 2;
const NO_DEVICE: i32 = 3;
const INTERRUPTED: i32 = 130;

// ---- A scene, end to end ---------------------------------------------------------------------------

#[test]
fn a_scene_becomes_the_files_that_its_manifest_lists() {
    let (run, dir) = bake(&demo(), ["--check", "64"]);
    let manifest = manifest(&dir);
    let mut listed = BTreeSet::from(["manifest.json".to_string(), ".gonio.lock".into()]);
    for table in list(&manifest["tables"]) {
        let files = table["files"].as_object().unwrap();
        assert_eq!(keys(&table["files"]), ["exr", "png"], "the default formats");
        assert_eq!(keys(&table["sha256"]), ["exr", "png"]);
        for (format, file) in files {
            let file = text(file);
            assert_eq!(sha256(&dir.path().join(file)).unwrap(), text(&table["sha256"][format]), "{file}");
            assert!(listed.insert(file.into()), "{file} is two tables'");
            assert!(listed.insert(plain_name(file)), "{file} has no plain name of its own");
        }
        assert!(table["error"]["measured_max"].as_f64().unwrap() <= 1e-4, "{table}");
        let texels: usize = list(&table["axes"]).iter().map(|axis| list(&axis["values"]).len()).product();
        assert_eq!(table["error"]["texels_checked"].as_u64().unwrap() as usize, texels.min(64), "{table}");
        assert!(run.out.contains(text(&table["name"])), "the summary has a line for {}", table["name"]);
    }
    assert_eq!(snapshot(&dir).into_keys().collect::<BTreeSet<_>>(), listed);
    assert_eq!(text(&manifest["scene"]["sha256"]), sha256(&demo()).unwrap());
    for words in ["device", "max error", "12 tables in", "left out"] {
        assert!(run.out.contains(words), "{words} in {}", run.out);
    }
}

#[test]
fn the_manifest_has_the_documented_keys_and_no_others() {
    let (_, dir) = bake(&demo(), ["--check", "8", "--format", "exr,npy,png"]);
    let manifest = manifest(&dir);
    assert_eq!(manifest["schema"], 1);
    assert_eq!(
        keys(&manifest),
        ["device", "gonio", "requirements", "scene", "schema", "stages", "tables", "tolerance"]
    );
    assert_eq!(keys(&manifest["gonio"]), ["version"]);
    assert_eq!(keys(&manifest["scene"]), ["file", "sha256"]);
    assert_eq!(keys(&manifest["device"]), ["driver", "kind", "name"]);
    assert_eq!(
        keys(&manifest["stages"]),
        ["certify", "check", "compile", "compose", "device", "dispatch", "readback", "scene", "write"]
    );

    let requirements = &manifest["requirements"];
    assert_eq!(keys(requirements), ["bases", "left_out", "materials", "warnings"]);
    for basis in list(&requirements["bases"]) {
        assert_eq!(keys(basis), ["model", "roughness"]);
    }
    for left_out in list(&requirements["left_out"]) {
        assert_eq!(keys(left_out), ["what", "why"]);
    }
    let names: BTreeSet<_> = list(&manifest["tables"]).iter().map(|table| text(&table["name"])).collect();
    assert_eq!(names.len(), list(&manifest["tables"]).len(), "names are unique");
    for material in list(&requirements["materials"]) {
        assert_eq!(
            keys(material),
            ["metallic", "name", "rho_bound", "roughness", "tables", "weights"],
            "{material}"
        );
        for weight in list(&material["weights"]) {
            assert_eq!(keys(weight), ["basis", "components"]);
        }
        let tables = list(&material["tables"]);
        assert!(!tables.is_empty() && tables.iter().all(|table| names.contains(text(table))), "{material}");
    }

    for table in list(&manifest["tables"]) {
        assert_eq!(
            keys(table),
            [
                "axes",
                "channels",
                "error",
                "files",
                "name",
                "parameters",
                "precision",
                "quantity",
                "rule",
                "seconds",
                "sha256",
                "storage",
                "subject",
                "unit",
            ]
        );
        for axis in list(&table["axes"]) {
            assert_eq!(keys(axis), ["mapping", "name", "positions", "range", "unit", "values"]);
        }
        assert_eq!(keys(&table["files"]), ["exr", "npy", "png"]);
        assert_eq!(keys(&table["sha256"]), ["exr", "npy", "png"]);
        let error = &table["error"];
        let mut expected = vec![
            "estimate",
            "interpolation",
            "kind",
            "measured_max",
            "measured_rms",
            "texels_checked",
            "worst",
        ];
        match text(&error["kind"]) {
            "relative" => expected.insert(1, "floor"),
            kind => assert_eq!(kind, "absolute"),
        }
        assert_eq!(keys(error), expected);
        let between = &error["interpolation"];
        if between.is_object() {
            assert_eq!(
                keys(between),
                ["certified", "domain", "kind", "max", "points", "points_checked", "rms", "worst"]
            );
        }
        assert!(text(&error["kind"]) == "absolute" || between.is_null(), "f is not sampled bilinearly");
        let axes = list(&table["axes"]).iter().map(|axis| text(&axis["name"]));
        let worst: BTreeSet<_> = axes.chain(["channel", "reference", "value"]).collect();
        assert_eq!(keys(&error["worst"]), Vec::from_iter(worst));
    }
}

/// Both are within 1e-4 of the truth, or the bake would have failed; here they are held side by side.
#[test]
fn the_device_and_the_cpu_path_agree() {
    let on = |device| bake(&demo(), ["--format", "npy", "--check", "0", "--device", device]).1;
    let (device, cpu) = (on("auto"), on("cpu"));
    let (of_device, of_cpu) = (manifest(&device), manifest(&cpu));
    let mut different = 0;
    for (x, y) in list(&of_device["tables"]).iter().zip(list(&of_cpu["tables"])) {
        assert_eq!(
            (&x["precision"], &y["precision"]),
            (&"f32".into(), &"f64".into()),
            "no device to test on"
        );
        for key in ["name", "quantity", "axes", "channels"] {
            assert_eq!(x[key], y[key]);
        }
        let relative = x["error"]["kind"] == "relative";
        let [(shape, x), (other_shape, y)] = [(&device, x), (&cpu, y)].map(|(dir, table)| npy(dir, table));
        assert_eq!(shape, other_shape);
        assert_eq!(x.len(), y.len());
        different += usize::from(x != y);
        for (x, y) in x.iter().zip(&y) {
            let difference = f64::from((x - y).abs());
            let difference = if relative { difference / f64::from(*y).max(1e-30) } else { difference };
            assert!(difference <= 1e-4, "{x} on the device, {y} on the CPU path");
        }
    }
    assert_eq!(list(&of_device["tables"]).len(), 12);
    assert!(different > 0, "f32 and f64 are alike to the last bit: one was compared with itself");
}

#[test]
fn two_runs_on_one_device_are_alike_to_the_byte() {
    for device in ["auto", "cpu"] {
        let bake = |threads: &str| {
            let dir = folder();
            let mut command =
                command(["bake", "--format", "exr,npy,png", "--check", "2", "--device", device]);
            command.env("RAYON_NUM_THREADS", threads);
            let run = run(command.arg("--out").arg(dir.path()).arg(demo()));
            assert_eq!(run.code, OK, "{}", run.err);
            let mut files = snapshot(&dir);
            let mut manifest: Value =
                serde_json::from_slice(&files.remove("manifest.json").unwrap()).unwrap();
            // Only the times differ.
            manifest["stages"] = Value::Null;
            manifest["tables"].as_array_mut().unwrap().iter_mut().for_each(|t| t["seconds"] = Value::Null);
            (files, manifest)
        };
        assert_eq!(bake("1"), bake("3"), "{device}");
    }
}

#[test]
fn a_second_bake_replaces_the_first() {
    let (_, dir) = bake(&demo(), ["--check", "0", "--quantity", "rho_hh"]);
    let first = snapshot(&dir);
    fs::write(dir.path().join("notes.txt"), "mine").unwrap();
    let recipe = recipe("[[tables]]\nname = 'other'\nquantity = 'rho_hh'\nmodel = 'lambert'\n");
    let run = bake_into(&recipe.path, dir.path(), ["--format", "npy"]);
    assert_eq!(run.code, OK, "{}", run.err);
    assert!(first.contains_key("ggx.rho_hh.exr"));
    let now = snapshot(&dir);
    let names: Vec<_> = now.keys().filter(|name| !name.starts_with("files/")).collect();
    assert_eq!(names, [".gonio.lock", "manifest.json", "notes.txt", "other.npy"]);
    assert_eq!(now.len(), names.len() + 1, "{:?}", now.keys());
    assert_eq!(verify(dir.path()).unwrap(), Vec::<String>::new());
}

// ---- Devices ---------------------------------------------------------------------------------------

#[cfg(target_os = "linux")]
#[test]
fn without_a_vulkan_driver_the_cpu_path_bakes_and_says_so() {
    let dir = folder();
    let arguments = ["--check", "8", "--format", "npy", "--out"].map(OsStr::new);
    let mut command = without_vulkan(["bake".as_ref(), demo().as_os_str()]);
    let run = run(command.args(arguments).arg(dir.path()));
    assert_eq!(run.code, OK, "{}", run.err);
    let line = run.out.lines().find(|line| line.contains("fell back to the CPU path")).expect("a line");
    assert!(line.contains("no Vulkan driver"), "it says why: {line}");
    assert_eq!(verify(dir.path()).unwrap(), Vec::<String>::new());
    let manifest = manifest(&dir);
    assert_eq!(text(&manifest["device"]["kind"]), "CPU");
    assert_eq!(list(&manifest["tables"]).len(), 12);
    assert!(list(&manifest["tables"]).iter().all(|table| table["precision"] == "f64"));
}

#[cfg(target_os = "linux")]
#[test]
fn without_a_vulkan_driver_devices_says_how_to_install_one() {
    let devices = run(&mut without_vulkan(["devices"]));
    assert_eq!(devices.code, OK);
    assert!(devices.out.contains("apt-get install"), "{}", devices.out);
    assert!(devices.out.contains("cpu (auto)"), "{}", devices.out);

    let json: Value = run(&mut without_vulkan(["devices", "--json"])).json();
    assert_eq!(list(&json).iter().map(|device| text(&device["name"])).collect::<Vec<_>>(), ["cpu"]);

    let dir = folder();
    let out = dir.path().join("out");
    let mut command = without_vulkan(["bake", "--device", "llvmpipe", "--out"]);
    let named = run(command.arg(&out).arg(demo()));
    assert_eq!(named.code, NO_DEVICE);
    assert!(named.err.contains("llvmpipe") && named.err.contains("apt-get install"), "{}", named.err);
    assert!(!out.exists());
}

#[test]
fn devices_lists_what_bake_takes() {
    let devices: Value = gonio(["devices", "--json"]).json();
    let best = text(&list(&devices)[0]["name"]).to_owned();
    let (run, dir) = bake(&demo(), ["--check", "0", "--quantity", "rho_hh", "--device", &best]);
    assert!(run.out.contains(&best));
    assert_eq!(text(&manifest(&dir)["device"]["name"]), best);
    assert!(gonio(["devices"]).out.contains(&format!("{best} (auto)")));
}

#[test]
fn a_device_that_is_not_there_is_refused_with_those_that_are() {
    for name in ["Voodoo 2", ""] {
        let run = bake_into(&demo(), folder().path(), ["--device", name]);
        assert_eq!(run.code, NO_DEVICE, "{name}");
        let devices: Value = gonio(["devices", "--json"]).json();
        assert!(run.err.contains(&format!("\"{name}\"")), "{}", run.err);
        assert!(run.err.contains("auto and cpu"), "{}", run.err);
        assert!(run.err.contains(text(&list(&devices)[0]["name"])), "{}", run.err);
    }
}

// ---- What is printed, and where --------------------------------------------------------------------

#[test]
fn dry_run_prints_the_plan_and_touches_neither_disk_nor_device() {
    let dir = folder();
    let out = dir.path().join("out");
    let mut command = command(["bake", "--dry-run", "--device", "no such device", "--out"]);
    let run = run(command.arg(&out).arg(demo()));
    assert_eq!(run.code, OK, "{}", run.err);
    assert_eq!(run.err, "", "no device was asked for, and nothing is to be warned of");
    assert!(!out.exists());
    for words in ["materials", "worn paint", "tables", "ggx.split_sum", "left out", "lambert: nothing"] {
        assert!(run.out.contains(words), "{words} in {}", run.out);
    }
    assert_eq!(gonio(["bake".as_ref(), demo().as_os_str(), "--dry-run".as_ref()]).out, run.out, "no --out");
}

/// The plan is the bake's own: same tables, same axes, same left-outs.
#[test]
fn the_plan_is_what_is_baked() {
    let plan = gonio(["bake".as_ref(), demo().as_os_str(), "--dry-run".as_ref(), "--json".as_ref()]).json();
    let (_, dir) = bake(&demo(), ["--check", "0", "--format", "npy"]);
    let manifest = manifest(&dir);
    for key in ["bases", "materials", "left_out", "warnings"] {
        assert_eq!(plan[key], manifest["requirements"][key], "{key}");
    }
    assert_eq!(list(&plan["tables"]).len(), list(&manifest["tables"]).len());
    for (planned, baked) in list(&plan["tables"]).iter().zip(list(&manifest["tables"])) {
        for key in ["name", "quantity", "subject", "channels"] {
            assert_eq!(planned[key], baked[key]);
        }
        let counts = list(&planned["axes"]).iter().map(|axis| axis["count"].as_u64().unwrap() as usize);
        let channels = list(&baked["channels"]).len();
        assert_eq!(npy(&dir, baked).0, counts.chain([channels]).collect::<Vec<_>>(), "{}", baked["name"]);
    }
}

#[test]
fn json_is_all_of_stdout_and_nothing_is_drawn_off_a_terminal() {
    // A terminal sees a progress bar after a second: check more until that has passed.
    for check in ["512", "8192", "65536", "all"] {
        let start = Instant::now();
        let (run, dir) = bake(&demo(), ["--json", "--check", check]);
        assert_eq!(run.json(), manifest(&dir));
        for words in ["device", "max error", "12 tables in"] {
            assert!(run.err.contains(words), "{words} in {}", run.err);
        }
        // No escapes, and no line drawn twice.
        assert!(!run.out.contains(['\x1b', '\r']) && !run.err.contains(['\x1b', '\r']), "{}", run.err);
        if start.elapsed() > Duration::from_secs(2) {
            break;
        }
    }
}

#[test]
fn a_failure_leaves_stdout_to_the_machine() {
    let run = bake_into(&demo(), folder().path(), ["--json", "--quantity", "rho_hh", "--tolerance", "1e-12"]);
    assert_eq!(run.code, PROMISE);
    assert!(!run.err.contains("--device cpu"), "f64 is stored as f32 too: {}", run.err);
    assert_eq!(run.out, "", "there is no manifest of a bake that failed");
}

#[test]
fn warnings_go_to_stderr_and_into_the_manifest() {
    let recipe =
        recipe("[materials.glow]\nlobes = [{ model = 'lambert', albedo = 1 }, { model = 'mirror' }]\n");
    let (run, dir) = bake(&recipe.path, ["--check", "0", "--quantity", "rho_dh"]);
    let manifest = manifest(&dir);
    let warnings = list(&manifest["requirements"]["warnings"]);
    assert_eq!(warnings.len(), 1);
    assert!(text(&warnings[0]).contains("glow: reflects up to 2.0000"), "{warnings:?}");
    assert!(run.err.contains(&format!("warning: {}", text(&warnings[0]))), "{}", run.err);
    assert!(!text(&warnings[0]).contains("glTF 2.0's"), "a recipe is not glTF: {warnings:?}");
}

#[cfg(target_os = "linux")]
#[test]
fn output_that_cannot_be_written_is_an_error_and_no_panic() {
    let demo = demo();
    let arguments: [&[&str]; 4] = [
        &["bake", "--dry-run", demo.to_str().unwrap()],
        &["devices"],
        &["devices", "--json"],
        &["eval", "--model=lambert", "--set=albedo=0.5", "--theta-i=0", "--theta-e=0", "--device=cpu"],
    ];
    for arguments in arguments {
        let full = fs::File::create("/dev/full").unwrap();
        let output = command(arguments).stdout(full).stderr(Stdio::piped()).output().unwrap();
        let err = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(INPUT), "{arguments:?}: {err}");
        assert!(err.contains("stdout: cannot write"), "{arguments:?}: {err}");
    }
}

#[test]
fn help_has_examples_and_exit_codes() {
    for command in [&["--help"][..], &["bake", "--help"], &["eval", "--help"], &["devices", "--help"]] {
        let run = gonio(command);
        assert_eq!(run.code, OK);
        assert!(run.out.contains("Examples:\n  gonio "), "{command:?}: {}", run.out);
        assert!(run.out.contains("Exit codes: 0 success"), "{command:?}: {}", run.out);
    }
    let bake = gonio(["bake", "--help"]).out;
    for words in ["--tolerance", "--device", "--format", "--check", "--material", "--quantity", "[[tables]]"]
    {
        assert!(bake.contains(words), "{words}");
    }
}

// ---- Selections and options ------------------------------------------------------------------------

#[test]
fn material_and_quantity_select() {
    let plan = |arguments: &[&str]| {
        let run = run(command(["bake", "--dry-run", "--json"]).args(arguments).arg(demo()));
        assert_eq!(run.code, OK, "{}", run.err);
        run.json()
    };
    let names = |plan: &Value| -> Vec<String> {
        list(&plan["tables"]).iter().map(|table| text(&table["name"]).into()).collect()
    };
    let gold = plan(&["--material", "gold"]);
    assert_eq!(
        names(&gold),
        ["ggx.brdf", "ggx.rho_dh", "ggx.rho_hh", "ggx.split_sum", "gold.brdf", "gold.rho_dh"]
    );
    assert_eq!(list(&gold["materials"]).len(), 1);
    assert_eq!(gold["bases"], serde_json::json!([{ "model": "ggx", "roughness": [0.3, 0.3] }]));

    assert_eq!(names(&plan(&["--quantity", "rho_hh"])), ["gltf_diffuse.rho_hh", "ggx.rho_hh"]);
    assert_eq!(names(&plan(&["--material", "gold", "--quantity", "rho_hh"])), ["ggx.rho_hh"]);
}

/// What a recipe's other tables need is not of the selection.
#[test]
fn a_selection_requires_no_basis_that_it_does_not_use() {
    let recipe = recipe(
        "[materials.plaster]\nlobes = [{ model = 'lambert', albedo = 0.5 }]\n\
         [[tables]]\nquantity = 'rho_hh'\nmaterial = 'plaster'\n\
         [[tables]]\nquantity = 'rho_hh'\nmodel = 'ggx'\n",
    );
    let mut command = command(["bake", "--dry-run", "--json", "--material", "plaster"]);
    let plan = run(command.arg(&recipe.path)).json();
    assert_eq!(plan["bases"], serde_json::json!([{ "model": "lambert", "roughness": null }]));
    let left_out: Vec<_> = list(&plan["left_out"]).iter().map(|entry| text(&entry["what"])).collect();
    assert!(left_out.contains(&"ggx"), "{left_out:?}");
}

#[test]
fn unknown_names_are_refused_with_the_valid_ones() {
    let cases: [(&[&str], &[&str]); 4] = [
        (&["--material", "cheese"], &["demo.gltf", "\"cheese\"", "worn paint", "gold", "clay"]),
        (&["--quantity", "colour"], &["\"colour\"", "brdf", "rho_dh", "rho_hh", "split_sum"]),
        (&["--format", "tiff"], &["tiff", "exr", "npy", "png"]),
        (&["--check", "some"], &["some", "count", "all"]),
    ];
    for (arguments, words) in cases {
        refused_into_nothing(&demo(), arguments, words);
    }
}

#[test]
fn tolerances_that_promise_nothing_are_refused() {
    for tolerance in ["0", "-1", "abc", "nan", "inf", "2", "1e-400", ""] {
        let argument = format!("--tolerance={tolerance}");
        refused_into_nothing(&demo(), &[&argument], &["--tolerance", tolerance]);
    }
    refused_into_nothing(&demo(), &["--tolerance", "-1"], &["--tolerance", "-1", "above 0"]);
}

#[test]
fn formats_checks_and_tolerances_are_as_asked() {
    let text = "tolerance = 0.5\n[[tables]]\nquantity = 'rho_dh'\nmodel = 'lambert'\naxes.theta_i = 300\n";
    let recipe = recipe(text);
    for (check, expected) in [("0", 0), ("7", 7), ("256", 256), ("all", 300), ("999999999", 300)] {
        let (_, dir) = bake(&recipe.path, ["--check", check, "--format", "npy,exr,npy"]);
        let manifest = manifest(&dir);
        let table = &manifest["tables"][0];
        assert_eq!(table["error"]["texels_checked"], expected);
        assert_eq!(table["error"]["measured_max"].is_null(), expected == 0);
        assert_eq!(keys(&table["files"]), ["exr", "npy"]);
        assert_eq!(manifest["tolerance"], 0.5, "the recipe's");
    }
    let (_, dir) = bake(&recipe.path, ["--tolerance", "0.25"]);
    assert_eq!(manifest(&dir)["tolerance"], 0.25, "the command line goes before the recipe");
}

// ---- Failures --------------------------------------------------------------------------------------

#[test]
fn a_missed_tolerance_fails_and_keeps_the_old_files() {
    let (_, dir) = bake(&demo(), ["--check", "0", "--quantity", "rho_hh"]);
    let old = snapshot(&dir);
    let coarse = |tolerance: &str| {
        recipe(&format!(
            "[[tables]]\nname = 'fine'\nquantity = 'rho_hh'\nmodel = 'lambert'\n\
             [[tables]]\nname = 'coarse'\nquantity = 'rho_dh'\nmodel = 'ggx'\nroughness = 0.5\n\
             grid = [8, 16]\naxes.theta_i = 5\ntolerance = {tolerance}\n"
        ))
    };
    let missed = coarse("1e-6");
    let run = bake_into(&missed.path, dir.path(), []);
    assert_eq!(run.code, PROMISE);
    for words in ["table coarse", "its error is ", "1e-6 is allowed", "theta_i = ", "take a finer grid"] {
        assert!(run.err.contains(words), "{words} in {}", run.err);
    }
    assert!(run.err.contains(&dir.path().display().to_string()), "it says what became of DIR");
    assert!(!run.err.contains("table fine"), "{}", run.err);
    assert_eq!(snapshot(&dir), old);

    let fresh = dir.path().join("fresh");
    assert_eq!(bake_into(&missed.path, &fresh, []).code, PROMISE);
    assert!(!fresh.exists(), "a folder that nothing came of goes again");
    assert_eq!(bake_into(&coarse("0.9").path, &fresh, []).code, OK, "the same table, more allowed");
}

#[test]
fn input_that_cannot_be_used_is_named() {
    let dir = folder();
    let write = |name: &str, bytes: &[u8]| {
        let path = dir.path().join(name);
        fs::write(&path, bytes).unwrap();
        path
    };
    let demo = fs::read(demo()).unwrap();
    let cases: [(PathBuf, &[&str]); 9] = [
        (dir.path().join("missing.gltf"), &["missing.gltf", "cannot read"]),
        (dir.path().join("missing.toml"), &["missing.toml", "cannot read"]),
        (write("cut.gltf", &demo[..demo.len() / 2]), &["cut.gltf", "line"]),
        (write("empty.glb", b""), &["empty.glb"]),
        (write("empty.toml", b""), &["empty.toml", "[[tables]]"]),
        (write("scene.obj", &demo), &["scene.obj", ".gltf", ".glb", ".toml"]),
        (
            write("key.toml", b"tolerance = 1e-4\n\nshiny = 1\n"),
            &["key.toml", "line 3", "shiny", "materials"],
        ),
        (write("text.toml", b"[[tables]\n"), &["text.toml", "line 1"]),
        (dir.path().into(), &[dir.path().to_str().unwrap(), ".gltf"]),
    ];
    for (scene, words) in cases {
        refused_into_nothing(&scene, &[], words);
    }
}

#[test]
fn a_folder_that_cannot_be_used_is_named() {
    let dir = folder();
    let file = dir.path().join("file");
    fs::write(&file, "mine").unwrap();
    for out in [file.clone(), file.join("below")] {
        let run = bake_into(&demo(), &out, ["--quantity", "rho_hh", "--check", "0"]);
        assert_eq!(run.code, INPUT, "{}", run.err);
        assert!(run.err.contains(out.to_str().unwrap()) && run.err.contains("not a folder"), "{}", run.err);
    }
    assert_eq!(fs::read(&file).unwrap(), b"mine");
    assert_eq!(bake_into(&demo(), Path::new(""), []).code, INPUT);
    let bare = gonio(["bake".as_ref(), demo().as_os_str()]);
    assert_eq!(bare.code, INPUT);
    assert!(bare.err.contains("--out"), "{}", bare.err);
}

/// Memory is asked about before it is taken: the plan refuses, with or without a device.
#[test]
fn a_table_that_fits_no_memory_is_refused() {
    let cases = [
        "quantity = 'split_sum'\nmodel = 'ggx'\naxes = { mu = 1048576, roughness = 1048576 }",
        "quantity = 'brdf'\nmodel = 'lambert'\naxes = { theta_i = 1048576, theta_e = 1048576, delta_phi = 1048576 }",
        "quantity = 'brdf'\nmodel = 'lambert'\naxes = { theta_i = 65536, theta_e = 65536, delta_phi = 2 }",
        "quantity = 'split_sum'\nmodel = 'lambert'\naxes = { mu = 1048576 }",
        "quantity = 'rho_dh'\nmodel = 'lambert'\naxes = { theta_i = 4096 }\ngrid = [16384, 2]",
    ];
    for case in cases {
        let recipe = recipe(&format!("\n[[tables]]\nname = 'vast'\n{case}\n"));
        let run = gonio(["bake".as_ref(), recipe.path.as_os_str(), "--dry-run".as_ref()]);
        assert_eq!(run.code, INPUT, "{case}: {}", run.err);
        for words in ["recipe.toml: line 2", "\"vast\"", "fewer samples"] {
            assert!(run.err.contains(words), "{words} in {}", run.err);
        }
    }
}

/// The largest table that the plan lets through is one that the device takes too.
#[test]
fn the_largest_tables_bake() {
    let recipe = recipe(
        "[[tables]]\nquantity = 'brdf'\nmodel = 'lambert'\naxes = { theta_i = 2048, theta_e = 2048, delta_phi = 2 }\n\
         [[tables]]\nquantity = 'rho_dh'\nmodel = 'lambert'\ngrid = [16384, 2]\naxes = { theta_i = 256 }\n\
         [[tables]]\nquantity = 'split_sum'\nmodel = 'lambert'\naxes = { mu = 65536 }\n",
    );
    bake(&recipe.path, ["--check", "4", "--format", "npy", "--tolerance", "1e-2"]);
}

#[test]
fn a_material_may_be_named_like_a_model() {
    let recipe = recipe(
        "[materials.ggx]\nlobes = [{ model = 'ggx', roughness = 0.5, f0 = 1.0 }]\n\
         [materials.lambert]\nlobes = [{ model = 'lambert', albedo = 0.9 }]\n",
    );
    let (_, dir) = bake(&recipe.path, ["--check", "4", "--format", "npy", "--quantity", "rho_dh"]);
    let manifest = manifest(&dir);
    let names: BTreeSet<_> = list(&manifest["tables"]).iter().map(|table| text(&table["name"])).collect();
    assert_eq!(names.len(), 4, "each table has a name of its own: {names:?}");
    let channels = |material: &Value| {
        let named = |table: &&Value| list(&material["tables"]).contains(&table["name"]);
        list(&manifest["tables"]).iter().filter(named).map(|t| list(&t["channels"]).len()).collect::<Vec<_>>()
    };
    let of_materials: Vec<_> = list(&manifest["requirements"]["materials"]).iter().map(channels).collect();
    assert_eq!(of_materials, [[2, 3], [1, 3]], "each has its basis and its RGB table");
}

#[test]
fn tables_without_a_name_get_one_each() {
    let recipe = recipe(
        "[[tables]]\nquantity = 'rho_hh'\nmodel = 'ggx'\nroughness = 0.2\n\
         [[tables]]\nquantity = 'rho_hh'\nmodel = 'ggx'\nroughness = 0.7\n\
         [[tables]]\nname = 'ggx.rho_hh'\nquantity = 'rho_hh'\nmodel = 'ggx'\nroughness = 0.9\n",
    );
    let (_, dir) = bake(&recipe.path, ["--check", "0", "--format", "npy"]);
    let manifest = manifest(&dir);
    let of =
        |table: &Value| (text(&table["name"]).to_owned(), table["parameters"]["roughness"].as_f64().unwrap());
    let tables: BTreeMap<_, _> = list(&manifest["tables"]).iter().map(of).collect();
    assert_eq!(tables.len(), 3, "{tables:?}");
    assert_eq!(tables["ggx.rho_hh"], 0.9, "a name that is given stays: {tables:?}");
    for table in list(&manifest["tables"]) {
        assert_eq!(plain_name(text(&table["files"]["npy"])), format!("{}.npy", text(&table["name"])));
    }
}

#[test]
fn names_of_materials_stay_inside_the_folder() {
    let dir = folder();
    let out = dir.path().join("out");
    let recipe = recipe(
        "[materials.'../../up']\nlobes = [{ model = 'lambert', albedo = 0.5 }]\n\
         [materials.'/a/b']\nlobes = [{ model = 'lambert', albedo = 0.5 }]\n\
         [materials.'_a_b']\nlobes = [{ model = 'lambert', albedo = 0.5 }]\n\
         [materials.'ü☃ 木']\nlobes = [{ model = 'lambert', albedo = 0.5 }]\n",
    );
    let run = bake_into(&recipe.path, &out, ["--check", "0", "--format", "npy,png", "--quantity", "rho_dh"]);
    assert_eq!(run.code, OK, "{}", run.err);
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);
    assert_eq!(fs::read_dir(&out).unwrap().count(), 2 * 5 + 3);
    assert_eq!(verify(&out).unwrap(), Vec::<String>::new());
}

// ---- Stopping in the middle ------------------------------------------------------------------------

#[cfg(unix)]
#[test]
fn interrupted_or_killed_a_bake_leaves_the_old_set() {
    let recipe = recipe(
        "[[tables]]\nname = 'ggx.rho_hh'\nquantity = 'rho_hh'\nmodel = 'lambert'\n\
         [[tables]]\nname = 'long'\nquantity = 'split_sum'\nmodel = 'ggx'\naxes = { mu = 256, roughness = 256 }\n",
    );
    let (_, dir) = bake(&demo(), ["--check", "0", "--quantity", "rho_hh"]);
    let old = snapshot(&dir);
    for (signal, code) in [("INT", Some(INTERRUPTED)), ("TERM", Some(INTERRUPTED)), ("KILL", None)] {
        let mut command = command(["bake", "--check", "all", "--format", "exr", "--out"]);
        command.arg(dir.path()).arg(&recipe.path).stdout(Stdio::null()).stderr(Stdio::piped());
        let bake = Running(command.spawn().unwrap());
        // The first table is written, the long one is under way.
        let staged = dir.path().join(".gonio-staging/ggx.rho_hh.exr");
        until(|| fs::metadata(&staged).is_ok_and(|file| file.len() > 0));
        bake.signal(signal);
        let (status, err) = bake.end();
        assert_eq!(status, code, "SIG{signal}: {err}");
        if code.is_some() {
            assert!(err.contains("interrupted; the files on disk are as they were"), "{err}");
            assert_eq!(snapshot(&dir), old, "SIG{signal}");
        }
        let mut left = snapshot(&dir);
        left.retain(|name, _| !name.starts_with(".gonio-staging"));
        assert_eq!(left, old, "SIG{signal}");
        assert_eq!(verify(dir.path()).unwrap(), Vec::<String>::new());
    }
    // What the kill left is in nobody's way.
    assert_eq!(bake_into(&demo(), dir.path(), ["--check", "0", "--quantity", "rho_hh"]).code, OK);
    assert_eq!(snapshot(&dir).into_keys().collect::<Vec<_>>(), old.into_keys().collect::<Vec<_>>());
}

// ---- Accuracy, end to end --------------------------------------------------------------------------

#[test]
fn a_split_sum_of_64_by_64_is_exact_to_two_millionths() {
    let recipe = recipe(
        "[[tables]]\nname = 'centers'\nquantity = 'split_sum'\nmodel = 'ggx'\naxes = { mu = 64, roughness = 64 }\n\
         [[tables]]\nname = 'nodes'\nquantity = 'split_sum'\nmodel = 'ggx'\n[tables.axes]\n\
         mu = { count = 64, range = [1e-3, 1.0], positions = 'nodes' }\n\
         roughness = { count = 64, range = [0.0, 1.0], positions = 'nodes' }\n",
    );
    let (_, dir) = bake(&recipe.path, ["--check", "all", "--tolerance", "2e-6"]);
    let manifest = manifest(&dir);
    for (table, ends) in list(&manifest["tables"]).iter().zip([[0.5 / 64.0, 1.0 - 0.5 / 64.0], [0.0, 1.0]]) {
        let error = &table["error"];
        assert!(error["measured_max"].as_f64().unwrap() <= 2e-6, "{error}");
        assert_eq!(error["texels_checked"], 64 * 64);
        let roughness = list(&table["axes"][0]["values"]);
        assert_eq!([&roughness[0], &roughness[63]], [&ends[0].into(), &Value::from(ends[1])]);
    }
}

#[test]
fn values_of_a_sharp_lobe_hold_at_the_mirror_direction() {
    let recipe = recipe(
        "[[tables]]\nquantity = 'brdf'\nmodel = 'ggx'\nroughness = 0.01\n\
         axes = { theta_i = 33, theta_e = 65, delta_phi = 65 }\n",
    );
    let (_, dir) = bake(&recipe.path, ["--check", "all", "--tolerance", "1e-5", "--format", "npy"]);
    let manifest = manifest(&dir);
    let table = &manifest["tables"][0];
    assert_eq!((text(&table["error"]["kind"]), text(&table["precision"])), ("relative", "f32"));
    assert!(table["error"]["measured_max"].as_f64().unwrap() <= 1e-5, "{}", table["error"]);
    assert_eq!(table["error"]["texels_checked"], 33 * 65 * 65);
    // At normal incidence A + B = D / 4 = 1 / (4 π α²): the peak is on the grid.
    let (shape, values) = npy(&dir, table);
    assert_eq!(shape, [33, 65, 65, 2]);
    let peak = 1.0 / (4.0 * std::f64::consts::PI * 1e-8);
    assert!((f64::from(values[0] + values[1]) / peak - 1.0).abs() < 1e-5, "{} and {}", values[0], values[1]);
}

// ---- eval ------------------------------------------------------------------------------------------

#[test]
fn eval_shows_the_value_the_reference_and_their_difference() {
    // At normal incidence f = F0 D / 4 = F0 / (4 π α²).
    let json = eval(&["--model=ggx", "--set=roughness=0.5", "--set=f0=[1.0,0.5,0.0]"], "0", "0").json();
    assert_eq!(json["channels"], serde_json::json!(["R", "G", "B"]));
    let exact = 1.0 / (4.0 * std::f64::consts::PI * 0.0625);
    for (k, f0) in [1.0, 0.5, 0.0].into_iter().enumerate() {
        let [value, reference] = ["value", "reference"].map(|key| json[key][k].as_f64().unwrap());
        assert!((value - f0 * exact).abs() < 1e-5 * exact, "{json}");
        assert!((reference - f0 * exact).abs() < 1e-12 * exact, "{json}");
    }
    assert!(json["relative_difference"].as_f64().unwrap() < 1e-5);
    assert_eq!(text(&json["unit"]), "sr⁻¹");

    let words = gonio(["eval", "--model=lambert", "--set=albedo=0.5", "--theta-i=0.1", "--theta-e=1"]);
    assert_eq!(words.code, OK, "{}", words.err);
    for words_of in ["device", "reference", "difference", "sr⁻¹", "R = 1.5915494"] {
        assert!(words.out.contains(words_of), "{words_of} in {}", words.out);
    }
}

#[test]
fn eval_takes_degrees_and_radians_and_any_azimuth() {
    let gold = ["--model=ggx", "--set=roughness=0.3"];
    let value = |more: &[&str], theta_i: &str| {
        let run = eval(&[&gold[..], more].concat(), theta_i, "60deg");
        assert_eq!(run.code, OK, "{more:?}: {}", run.err);
        run.json()["value"].clone()
    };
    assert_eq!(value(&[], "45deg"), value(&[], "0.7853981633974483"));
    let mirror = value(&[], "45deg");
    assert_eq!(value(&["--phi-i", "0", "--phi-e", "180deg"], "45deg"), mirror, "the default is the mirror's");
    assert_eq!(value(&["--phi-i", "-90deg", "--phi-e", "90deg"], "45deg"), mirror);
    let aside = value(&["--phi-e", "90deg"], "45deg");
    assert_ne!(aside, mirror);
    for phi_e in ["-90deg", "450deg", "-1.5707963267948966"] {
        let [aside, other] = [&aside, &value(&["--phi-e", phi_e], "45deg")].map(|v| v[0].as_f64().unwrap());
        assert!((aside / other - 1.0).abs() < 1e-5, "{phi_e}: {aside}, {other}");
    }
    assert_eq!(eval(&["--model=ggx", "--set=alpha=0.09"], "45deg", "60deg").json()["value"], mirror);
}

#[test]
fn eval_takes_materials() {
    let demo = demo();
    let gold = eval(&[demo.to_str().unwrap(), "--material=gold"], "30deg", "30deg").json();
    let by_hand = ["--model=ggx", "--set=roughness=0.3", "--set=f0=[1.0,0.78,0.34]"];
    let by_hand = eval(&by_hand, "30deg", "30deg").json();
    for k in 0..3 {
        let [x, y] = [&gold, &by_hand].map(|json| json["value"][k].as_f64().unwrap());
        assert!((x / y - 1.0).abs() < 1e-5, "{x}, {y}");
    }
    let cpu = eval(&[demo.to_str().unwrap(), "--material=gold", "--device=cpu"], "30deg", "30deg").json();
    assert_eq!(text(&cpu["precision"]), "f64");
}

#[test]
fn eval_refuses_with_the_valid_words() {
    let demo = demo();
    let demo = demo.to_str().unwrap();
    let cases: [(&[&str], &str, &[&str]); 15] = [
        (&["--model=plastic"], "0", &["\"plastic\"", "lambert", "gltf_diffuse", "ggx", "mirror"]),
        (&["--model=my model"], "0", &["\"my model\"", "lambert", "gltf_diffuse", "ggx", "mirror"]),
        (&["--model=ggx"], "0", &["roughness", "alpha"]),
        (&["--model=ggx", "--set=shiny=1"], "0", &["shiny", "roughness", "alpha", "f0", "f90"]),
        (&["--model=ggx", "--set=roughness=2"], "0", &["roughness", "[0, 1]"]),
        (&["--model=ggx", "--set=roughness=nan"], "0", &["roughness", "[0, 1]"]),
        (&["--model=ggx", "--set=roughness=rough"], "0", &["roughness", "number"]),
        (&["--model=ggx", "--set=roughness"], "0", &["KEY=VALUE"]),
        (&["--model=ggx", "--set=roughness=0"], "0", &["delta", "0.001"]),
        (&["--model=mirror"], "0", &["mirror", "delta"]),
        (&["--model=lambert", "--set=albedo=1"], "91deg", &["theta_i", "outside", "1.570796"]),
        (&["--model=lambert", "--set=albedo=1"], "-0.1", &["theta_i", "outside", "1.570796"]),
        (&["--model=lambert", "--set=albedo=1"], "nan", &["--theta-i", "not finite"]),
        (&[demo, "--material=cheese"], "0", &["demo.gltf", "worn paint", "gold", "clay"]),
        (&[demo, "--material=worn paint"], "0", &["worn paint", "varies", "--set roughness"]),
    ];
    for (arguments, theta_i, words) in cases {
        let run = eval(arguments, theta_i, "0");
        assert_eq!(run.code, INPUT, "{arguments:?}: {}", run.err);
        for word in words {
            assert!(run.err.contains(word), "{word} in {}", run.err);
        }
    }
    assert_eq!(gonio(["eval", "--theta-i=0", "--theta-e=0"]).code, INPUT, "of what?");
    assert_eq!(
        eval(&["--model=lambert", "--set=albedo=1"], "90deg", "0").code,
        OK,
        "90° itself is a direction"
    );
}

// ---- Helpers ---------------------------------------------------------------------------------------

/// How a command ended, and what it said.
struct Run {
    code: i32,
    out: String,
    err: String,
}

impl Run {
    /// All of stdout, as one JSON document.
    fn json(&self) -> Value {
        serde_json::from_str(&self.out).unwrap_or_else(|e| panic!("{e} in {}\n{}", self.out, self.err))
    }
}

/// The command, in a plain environment.
fn command<A: AsRef<OsStr>>(arguments: impl IntoIterator<Item = A>) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gonio"));
    command.args(arguments).stdin(Stdio::null());
    command.env_remove("CLICOLOR_FORCE").env_remove("RUST_LOG");
    command
}

/// The command where no Vulkan driver is.
fn without_vulkan<A: AsRef<OsStr>>(arguments: impl IntoIterator<Item = A>) -> Command {
    let mut command = command(arguments);
    for variable in ["VK_ICD_FILENAMES", "VK_DRIVER_FILES"] {
        command.env(variable, "/nonexistent/icd.json");
    }
    command.env_remove("VK_ADD_DRIVER_FILES");
    command
}

fn run(command: &mut Command) -> Run {
    let output = command.output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    let run = Run {
        code: output.status.code().unwrap_or_else(|| panic!("{command:?} ended by a signal")),
        out: text(output.stdout),
        err: text(output.stderr),
    };
    assert!(!run.err.contains("panicked"), "{command:?}: {}", run.err);
    run
}

fn gonio<A: AsRef<OsStr>>(arguments: impl IntoIterator<Item = A>) -> Run {
    run(&mut command(arguments))
}

fn bake_into<'a>(scene: &Path, out: &Path, arguments: impl IntoIterator<Item = &'a str>) -> Run {
    run(command(["bake"]).args(arguments).arg("--out").arg(out).arg(scene))
}

/// A bake that succeeds, and its folder.
fn bake<'a>(scene: &Path, arguments: impl IntoIterator<Item = &'a str>) -> (Run, TempDir) {
    let dir = folder();
    let run = bake_into(scene, dir.path(), arguments);
    assert_eq!(run.code, OK, "{}", run.err);
    (run, dir)
}

/// Bad input: exit code 2, the message has these words, and no folder is made.
fn refused_into_nothing(scene: &Path, arguments: &[&str], words: &[&str]) {
    let dir = folder();
    let out = dir.path().join("out");
    let run = bake_into(scene, &out, arguments.iter().copied());
    assert_eq!(run.code, INPUT, "{arguments:?}: {}", run.err);
    for word in words {
        assert!(run.err.contains(word), "{word} in {}", run.err);
    }
    assert!(!out.exists());
}

fn eval(arguments: &[&str], theta_i: &str, theta_e: &str) -> Run {
    run(command(["eval", "--json", "--theta-i", theta_i, "--theta-e", theta_e]).args(arguments))
}

fn demo() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/demo/demo.gltf")
}

fn folder() -> TempDir {
    TempDir::new().unwrap()
}

/// A recipe in a folder of its own.
struct Recipe {
    path: PathBuf,
    _dir: TempDir,
}

fn recipe(text: &str) -> Recipe {
    let dir = folder();
    let path = dir.path().join("recipe.toml");
    fs::write(&path, text).unwrap();
    Recipe { path, _dir: dir }
}

fn manifest(dir: &TempDir) -> Value {
    serde_json::from_slice(&fs::read(dir.path().join("manifest.json")).unwrap()).unwrap()
}

/// The shape and the values of a table.
fn npy(dir: &TempDir, table: &Value) -> (Vec<usize>, Vec<f32>) {
    readers::npy(&fs::read(dir.path().join(text(&table["files"]["npy"]))).unwrap()).unwrap()
}

/// Every file below a folder.
fn snapshot(dir: &TempDir) -> BTreeMap<String, Vec<u8>> {
    fn visit(dir: &Path, prefix: &str, files: &mut BTreeMap<String, Vec<u8>>) {
        for entry in fs::read_dir(dir).unwrap() {
            let path = entry.unwrap().path();
            let name = format!("{prefix}{}", path.file_name().unwrap().to_str().unwrap());
            if path.is_dir() {
                visit(&path, &format!("{name}/"), files);
            } else {
                files.insert(name, fs::read(&path).unwrap());
            }
        }
    }
    let mut files = BTreeMap::new();
    visit(dir.path(), "", &mut files);
    files
}

/// The name without the digits of its content.
fn plain_name(listed: &str) -> String {
    let parts: Vec<_> = listed.strip_prefix("files/").unwrap().rsplitn(3, '.').collect();
    format!("{}.{}", parts[2], parts[0])
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_else(|| panic!("{value} is no text"))
}

fn list(value: &Value) -> &[Value] {
    value.as_array().unwrap_or_else(|| panic!("{value} is no list"))
}

/// The keys of an object, in order.
fn keys(value: &Value) -> Vec<&str> {
    let object = value.as_object().unwrap_or_else(|| panic!("{value} is no object"));
    object.keys().map(String::as_str).collect::<BTreeSet<_>>().into_iter().collect()
}

/// A bake under way, ended with the test whatever happens.
struct Running(Child);

impl Running {
    fn signal(&self, name: &str) {
        let kill = format!("kill -{name} {}", self.0.id());
        assert!(Command::new("sh").args(["-c", &kill]).status().unwrap().success(), "{kill}");
    }

    /// The exit code, none for a signal, and stderr.
    fn end(mut self) -> (Option<i32>, String) {
        let mut status = None;
        until(|| {
            status = self.0.try_wait().unwrap();
            status.is_some()
        });
        let mut err = String::new();
        std::io::Read::read_to_string(self.0.stderr.as_mut().unwrap(), &mut err).unwrap();
        (status.unwrap().code(), err)
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Waits, but not for ever.
fn until(mut done: impl FnMut() -> bool) {
    let start = Instant::now();
    while !done() {
        assert!(start.elapsed() < Duration::from_secs(60), "waited in vain");
        std::thread::sleep(Duration::from_millis(5));
    }
}
