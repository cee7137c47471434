//! Promises of every file that a command writes: whole or as it was, several together, and the process ends when it is asked
//! to.

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::thread;
use std::time::{Duration, Instant};
use tempfile::TempDir;

fn gonio(dir: &Path, args: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gonio"));
    command
        .args(args.split(' '))
        .current_dir(dir)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

fn run(dir: &Path, args: &str) -> Output {
    let output = gonio(dir, args).output().unwrap();
    assert!(!text(&output.stderr).contains("panicked"), "{args}: {}", text(&output.stderr));
    output
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// The names in a folder, in order.
fn names(dir: &Path) -> Vec<String> {
    let names = fs::read_dir(dir).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<_> = names.collect();
    names.sort();
    names
}

/// A folder with three pairs of directions.
fn folder() -> TempDir {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("pairs.csv"), "0.1,0,0.2,3\n0.3,0,0.4,2\n0.5,0,0.6,1\n").unwrap();
    dir
}

const EVAL: &str = "eval --model lambert --set albedo=0.5 --device cpu --pairs pairs.csv --out out.csv";
const PLOT: &str = "plot lambert --device cpu --out a.png --out a.svg";
const CHECK: &str =
    "check --model lambert --set albedo=0.5 --device cpu --budget 1e3 --junit check.xml --out pictures";
const ATLAS: &str = "atlas --model lambert --device cpu --budget 1000 --out atlas";

/// A trap with the name that temporary files once had, a link to somebody's file.
#[cfg(unix)]
#[test]
fn temporary_files_cannot_be_foreseen() {
    use std::os::unix::fs::symlink;
    let dir = folder();
    let victim = dir.path().join("victim");
    fs::write(&victim, "mine").unwrap();
    let traps = [".out.csv.partial", ".a.png.partial", ".a.svg.partial", "check.xml.partial"];
    traps.iter().for_each(|name| symlink(&victim, dir.path().join(name)).unwrap());
    for args in [EVAL, PLOT, CHECK, ATLAS] {
        assert!(run(dir.path(), args).status.success(), "{args}");
    }
    assert_eq!(fs::read(&victim).unwrap(), b"mine");
    let mut expected =
        ["a.png", "a.svg", "atlas", "check.xml", "out.csv", "pairs.csv", "pictures", "victim"].to_vec();
    expected.extend(traps);
    expected.sort();
    assert_eq!(names(dir.path()), expected, "no trace of a temporary file");
}

/// As shells and editors do it: the link stays, the file that it leads to is new.
#[cfg(unix)]
#[test]
fn a_link_stays_a_link_and_permissions_stay() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let dir = folder();
    let target = dir.path().join("target.csv");
    fs::write(&target, "old").unwrap();
    fs::set_permissions(&target, fs::Permissions::from_mode(0o640)).unwrap();
    symlink("target.csv", dir.path().join("out.csv")).unwrap();
    assert!(run(dir.path(), EVAL).status.success());
    assert!(dir.path().join("out.csv").is_symlink());
    assert!(fs::read_to_string(&target).unwrap().lines().count() == 4);
    assert_eq!(fs::metadata(&target).unwrap().permissions().mode() & 0o777, 0o640);

    fs::remove_file(&target).unwrap();
    let output = run(dir.path(), EVAL);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        text(&output.stderr).contains("out.csv: a link that leads to no file"),
        "{}",
        text(&output.stderr)
    );
    assert_eq!(names(dir.path()), ["out.csv", "pairs.csv"]);
}

#[cfg(unix)]
#[test]
fn devices_are_written_to_and_not_replaced() {
    let dir = folder();
    let args = "check --model lambert --set albedo=0.5 --device cpu --budget 1e3 --json --junit /dev/stderr";
    let output = run(dir.path(), args);
    assert!(
        output.status.success() && text(&output.stderr).contains("<testsuites"),
        "{}",
        text(&output.stderr)
    );
    assert!(!fs::symlink_metadata("/dev/stderr").unwrap().is_file());
}

/// The second file cannot have its name: the first gives its own back.
#[test]
fn files_of_a_command_come_together() {
    let dir = folder();
    fs::create_dir(dir.path().join("pictures")).unwrap();
    fs::create_dir(dir.path().join("pictures/0_lambert.error.png")).unwrap();
    fs::write(dir.path().join("check.xml"), "old").unwrap();
    assert_eq!(run(dir.path(), CHECK).status.code(), Some(2));
    assert_eq!(names(&dir.path().join("pictures")), ["0_lambert.error.png"]);
    assert_eq!(fs::read(dir.path().join("check.xml")).unwrap(), b"old");

    fs::create_dir_all(dir.path().join("atlas/atlas_lambert.png")).unwrap();
    fs::write(dir.path().join("atlas/atlas.csv"), "old").unwrap();
    assert_eq!(run(dir.path(), ATLAS).status.code(), Some(2));
    assert_eq!(names(&dir.path().join("atlas")), ["atlas.csv", "atlas_lambert.png"]);
    assert_eq!(fs::read(dir.path().join("atlas/atlas.csv")).unwrap(), b"old");
}

#[test]
fn two_processes_do_not_mix_their_files() {
    let dir = folder();
    let list: String =
        (0..20_000).map(|k| format!("{},0,{},1\n", 1e-5 * k as f64, 2e-5 * k as f64)).collect();
    fs::write(dir.path().join("pairs.csv"), list).unwrap();
    let alone = |albedo: &str| {
        assert!(run(dir.path(), &EVAL.replace("0.5", albedo)).status.success());
        fs::read(dir.path().join("out.csv")).unwrap()
    };
    let whole = [alone("0.25"), alone("0.75")];
    for _ in 0..3 {
        let both =
            ["0.25", "0.75"].map(|albedo| gonio(dir.path(), &EVAL.replace("0.5", albedo)).spawn().unwrap());
        both.into_iter().for_each(|mut child| assert!(child.wait().unwrap().success()));
        let now = fs::read(dir.path().join("out.csv")).unwrap();
        assert!(whole.contains(&now), "{} bytes of neither", now.len());
        assert_eq!(names(dir.path()), ["out.csv", "pairs.csv"]);
    }
}

// ---- Ending when asked -----------------------------------------------------------------------------

/// Commands that take minutes: a reference integral, a CPU table, an atlas, an evaluation, a plan.
const LONG: [&str; 4] = [
    "bake charlie.toml --device cpu --check 1 --out out",
    "bake large.toml --device cpu --check 0 --out out",
    "check --model ggx --device cpu --budget 1e12 --junit check.xml --out out",
    "atlas --model ggx --device cpu --budget 10000000000 --out out",
];

#[cfg(unix)]
#[test]
fn a_signal_ends_any_command_at_once_and_leaves_no_trace() {
    for args in LONG {
        let dir = folder();
        let axes = "axes = { roughness = 64 }";
        let charlie =
            format!("[[tables]]\nquantity = 'rho_hh'\nmodel = 'charlie'\ntolerance = 1e-5\n{axes}\n");
        fs::write(dir.path().join("charlie.toml"), charlie).unwrap();
        let axes = "axes = { mu = 1024, roughness = 1024 }";
        let large = format!("[[tables]]\nquantity = 'split_sum'\nmodel = 'gtr'\ntolerance = 1e-8\n{axes}\n");
        fs::write(dir.path().join("large.toml"), large).unwrap();
        let before = names(dir.path());
        for signal in ["TERM", "INT"] {
            let child = gonio(dir.path(), args).spawn().unwrap();
            thread::sleep(Duration::from_millis(300));
            let (code, seconds, stderr) = interrupt(child, signal);
            assert_eq!(code, Some(130), "{args}: {stderr}");
            assert!(seconds < 1.0, "{args}: {seconds} s after SIG{signal}");
            assert!(stderr.contains("interrupted; the files on disk are as they were"), "{args}: {stderr}");
            assert_eq!(names(dir.path()), before, "{args}");
        }
    }
}

/// Sends a signal. Returns the exit code, the seconds until the end, and what was said.
fn interrupt(child: Child, signal: &str) -> (Option<i32>, f64, String) {
    let start = Instant::now();
    let kill = format!("kill -{signal} {}", child.id());
    assert!(Command::new("sh").args(["-c", &kill]).status().unwrap().success(), "it ended before");
    let output = child.wait_with_output().unwrap();
    (output.status.code(), start.elapsed().as_secs_f64(), text(&output.stderr))
}

/// Without threads or files to be had there is an error that says so, or the work is done.
#[cfg(target_os = "linux")]
#[test]
fn limits_of_the_system_are_errors() {
    for limit in ["-n 20", "-n 10", "-v 300000"] {
        let dir = folder();
        let command = format!("ulimit {limit} && exec {} {EVAL}", env!("CARGO_BIN_EXE_gonio"));
        let output = Command::new("sh").args(["-c", &command]).current_dir(dir.path()).output().unwrap();
        let stderr = text(&output.stderr);
        assert!(!stderr.contains("panicked"), "{limit}: {stderr}");
        assert!(matches!(output.status.code(), Some(0 | 2)), "{limit}: {:?} {stderr}", output.status);
    }
}

// ---- Sets, and text of others ----------------------------------------------------------------------

/// A process killed at random moments, a reader that knows only the manifest, and sets that differ.
#[cfg(unix)]
#[test]
#[ignore = "minutes: scripts/test.sh --long"]
fn killed_at_any_moment_a_plain_reader_has_one_set() {
    let dir = folder();
    for (name, albedo) in [("old", 0.25), ("new", 0.75)] {
        let materials: String = (0..12)
            .map(|k| format!("[materials.m{k}]\nlobes = [{{ model = 'lambert', albedo = {albedo} }}]\n"))
            .collect();
        fs::write(dir.path().join(format!("{name}.toml")), materials).unwrap();
    }
    let bake = |name: &str| {
        gonio(dir.path(), &format!("bake {name}.toml --quantity rho_dh --device cpu --check 0 --out out"))
    };
    let start = Instant::now();
    assert!(bake("old").output().unwrap().status.success());
    let all = start.elapsed().as_secs_f64();
    let (mut old, mut new, mut killed) = (0, 0, 0);
    for k in 0..300 {
        let name = ["new", "old"][k % 2];
        let mut child = bake(name).spawn().unwrap();
        thread::sleep(Duration::from_secs_f64(1.2 * all * (k as f64 * 0.618_034).fract()));
        let _ = child.kill();
        killed += usize::from(!child.wait().unwrap().success());
        let scene = plain_reader(&dir.path().join("out"));
        *(if scene.starts_with("old") { &mut old } else { &mut new }) += 1;
    }
    println!("300 bakes, {killed} killed: the old set {old} times, the new one {new} times, never another");
    assert!(killed > 30 && old > 0 && new > 0);
}

/// Reads a set as an engine does: the manifest, and the files that it lists. Returns its scene.
#[cfg(unix)]
fn plain_reader(dir: &Path) -> String {
    let manifest: Value = serde_json::from_slice(&fs::read(dir.join("manifest.json")).unwrap()).unwrap();
    for table in manifest["tables"].as_array().unwrap() {
        for (format, name) in table["files"].as_object().unwrap() {
            let hash = gonio::io::sha256(&dir.join(name.as_str().unwrap())).unwrap();
            assert_eq!(Some(hash.as_str()), table["sha256"][format].as_str(), "{name}");
        }
    }
    manifest["scene"]["file"].as_str().unwrap().to_owned()
}

#[test]
fn verify_says_whether_a_set_is_whole() {
    let dir = folder();
    let recipe = "[[tables]]\nname = 'dfg'\nquantity = 'rho_hh'\nmodel = 'lambert'\n";
    fs::write(dir.path().join("r.toml"), recipe).unwrap();
    assert_eq!(run(dir.path(), "verify out").status.code(), Some(2), "there is none");
    assert!(run(dir.path(), "bake r.toml --device cpu --check 0 --out out").status.success());
    let whole = run(dir.path(), "verify out --json");
    let json: Value = serde_json::from_slice(&whole.stdout).unwrap();
    assert!(whole.status.success() && json["whole"] == true && json["files"] == 2, "{json}");

    fs::create_dir(dir.path().join("out/.gonio-staging")).unwrap();
    let left = run(dir.path(), "verify out");
    assert!(left.status.success() && text(&left.stderr).contains(".gonio-staging"), "{}", text(&left.stderr));

    fs::write(dir.path().join("out/dfg.exr"), "changed").unwrap();
    let broken = run(dir.path(), "verify out --json");
    assert_eq!(broken.status.code(), Some(1));
    let json: Value = serde_json::from_slice(&broken.stdout).unwrap();
    assert!(json["whole"] == false && json["faults"].to_string().contains("dfg"), "{json}");
    assert!(text(&broken.stderr).contains("bake again"));
}

/// Each command makes the axes that its subject needs, and what `check` and `atlas` print can be pasted.
#[test]
fn anisotropic_models_go_through_every_command() {
    let dir = folder();
    let trade = "trade --model ggx-anisotropic --size 2 --budget 0.01s --device cpu --out trade";
    let set = "--set roughness=0.5 --set aspect=0.5";
    let pairs =
        format!("eval --model beckmann-anisotropic {set} --device cpu --pairs pairs.csv --out out.csv");
    for args in [trade, &pairs] {
        let output = run(dir.path(), args);
        assert!(output.status.success(), "{args}: {}", text(&output.stderr));
    }
    // The energy of an anisotropic model takes minutes; the command that is printed is made in the same way for all.
    let check = run(dir.path(), "check --model lambert --set albedo=0.5 --device cpu --budget 1e3");
    let atlas = run(dir.path(), "atlas --model ggx-anisotropic --budget 1000");
    let printed = [text(&check.stdout), text(&atlas.stdout)].concat();
    let commands: Vec<_> =
        printed.lines().filter_map(|line| Some(line.split_once("gonio eval ")?.1)).collect();
    assert!(commands.len() > 4, "{printed}{}", text(&check.stderr));
    for command in commands {
        let output = run(dir.path(), &format!("eval {command} --device cpu"));
        assert!(output.status.success(), "gonio eval {command}: {}", text(&output.stderr));
    }
}

/// Names of materials that are no characters of XML or turn the direction of writing, and keys that act on a terminal.
#[test]
fn text_of_others_is_escaped_wherever_it_goes() {
    let dir = folder();
    let recipe = "[materials.\"a\\u202E\\uFFFE<&\"]\nlobes = [{ model = 'lambert', albedo = 0.5 }]\n";
    fs::write(dir.path().join("r.toml"), recipe).unwrap();
    let output = run(dir.path(), "check r.toml --device cpu --budget 1e3 --junit check.xml");
    assert!(output.status.success(), "{}", text(&output.stderr));
    let xml = fs::read_to_string(dir.path().join("check.xml")).unwrap();
    for (what, said) in [("stdout", text(&output.stdout)), ("XML", xml.replace("&lt;&amp;", "<&"))] {
        assert!(!said.contains(['\u{202e}', '\u{fffe}']), "{what}: {said:?}");
        assert!(said.contains(r"a\u{202e}\u{fffe}<&"), "{what}: {said}");
    }
    let json = run(dir.path(), "bake r.toml --device cpu --check 0 --quantity rho_dh --out out --json");
    let manifest: Value = serde_json::from_slice(&json.stdout).unwrap();
    assert_eq!(manifest["requirements"]["materials"][0]["name"], "a\u{202e}\u{fffe}<&");

    fs::write(dir.path().join("key.toml"), "\"\\u001b[2J\\u009b\" = 1\n").unwrap();
    let output = gonio(dir.path(), "bake key.toml --dry-run").env("CLICOLOR_FORCE", "1").output().unwrap();
    let stderr = text(&output.stderr);
    assert!(stderr.contains(r"\u{1b}[2J\u{9b}"), "{stderr:?}");
    assert!(!stderr.contains("\u{1b}[2J") && !stderr.contains('\u{9b}'), "{stderr:?}");
}
