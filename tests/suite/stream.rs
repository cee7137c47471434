//! Promises of streamed tables: the same bytes as in one piece, and a bake that was killed goes on where it
//! was.

use crate::common::*;
use gonio::backend::gpu::DeviceChoice;
use gonio::bake::{Evaluator, Observer, Unobserved};
use gonio::base::timings::Timings;
use gonio::batch::{Baked, SetOptions, Streaming, bake_set};
use gonio::check::Check;
use gonio::io::format::FORMATS;
use gonio::io::target::IDENTITY;
use gonio::scene::planner::{Plan, Selection};
use gonio::table::storage::Storage;
use gonio::{Result, scene};
use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::time::Duration;
use std::{env, fs, thread};

/// RGB, a basis with a roughness axis, rows that are no whole quads, and a table that does not stream.
const RECIPE: &str = r#"
[materials.gold]
lobes = [
  { model = "ggx", roughness = 0.3, f0 = [1.0, 0.78, 0.34] },
  { model = "lambert", albedo = [0.1, 0.2, 0.3] },
]
[[tables]]
name = "gold"
quantity = "brdf"
material = "gold"
axes = { theta_i = 7, theta_e = 13, delta_phi = 21 }
[[tables]]
name = "basis"
quantity = "brdf"
model = "ggx"
axes = { roughness = { values = [0.1, 0.5, 1.0] }, theta_i = 7, theta_e = 9, delta_phi = 17 }
[[tables]]
name = "dfg"
quantity = "split_sum"
model = "ggx"
axes = { mu = 8, roughness = 8 }
"#;

/// Eleven and twelve tiles, the last ones smaller.
const SMALL: Streaming = Streaming { above: 0, tile: 2400 };
const WHOLE: Streaming = Streaming { above: usize::MAX, tile: 1 << 25 };

fn recipe(dir: &Path, text: &str) -> PathBuf {
    let path = dir.join("recipe.toml");
    fs::write(&path, text).unwrap();
    path
}

fn bake_recipe(
    evaluator: &Evaluator,
    recipe: &Path,
    out: &Path,
    streaming: Streaming,
    check: Check,
    observer: &dyn Observer,
) -> Result<Baked> {
    let plan = Plan::new(&scene::read(recipe)?, &Selection::default())?;
    let options = SetOptions { formats: FORMATS.to_vec(), target: &IDENTITY, check, streaming };
    bake_set(&plan, recipe, evaluator, out, &options, Timings::default(), observer)
}

/// Every table file of a set: its name and bytes.
fn files(dir: &Path) -> BTreeMap<String, Vec<u8>> {
    let names = fs::read_dir(dir).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    names
        .filter(|name| FORMATS.iter().any(|format| name.ends_with(format.extension)))
        .map(|name| (name.clone(), fs::read(dir.join(name)).unwrap()))
        .collect()
}

/// EXR with its header, the error in it included; NPY; and the preview, as each axis here is drawn whole.
#[test]
fn streamed_files_are_those_of_the_whole_table() {
    let folder = tempfile::tempdir().unwrap();
    let recipe = recipe(folder.path(), RECIPE);
    for (name, evaluator) in ["device", "cpu"].into_iter().zip(evaluators()) {
        for check in [Check::Sample(0), Check::Sample(100), Check::All] {
            let [whole, tiles] = [("whole", WHOLE), ("tiles", SMALL)].map(|(how, streaming)| {
                let out = folder.path().join(format!("{name} {check:?} {how}"));
                let baked = bake_recipe(evaluator, &recipe, &out, streaming, check, &Unobserved).unwrap();
                assert_eq!(baked.tiles.all, if how == "whole" { 0 } else { 23 });
                assert_eq!(gonio::io::verify(&out).unwrap(), Vec::<String>::new());
                assert!(!out.join(".gonio-partial").exists());
                files(&out)
            });
            assert_eq!(whole.len(), 9);
            for (name, bytes) in &whole {
                assert!(tiles[name] == *bytes, "{name} differs");
            }
        }
    }
}

/// Tiles are f32: what is computed or stored otherwise is baked whole, to its own digits.
#[test]
fn only_f32_is_streamed() {
    let folder = tempfile::tempdir().unwrap();
    let text = r#"
[[tables]]
name = "precise"
quantity = "brdf"
model = "ggx"
tolerance = 1e-7
axes = { roughness = { values = [0.5] }, theta_i = 5, theta_e = 5, delta_phi = 7 }
[[tables]]
name = "half"
quantity = "brdf"
model = "lambert"
tolerance = 1e-3
storage = "f16"
axes = { theta_i = 5, theta_e = 5, delta_phi = 7 }
"#;
    let recipe = recipe(folder.path(), text);
    for (name, evaluator) in ["device", "cpu"].into_iter().zip(evaluators()) {
        let baked =
            bake_recipe(evaluator, &recipe, &folder.path().join(name), SMALL, Check::All, &Unobserved)
                .unwrap();
        assert_eq!(baked.tiles.all, 0);
        assert_eq!(baked.tables[0].storage, Storage::F64);
        // Their values are in the files: the memory of a set does not grow with its tables.
        assert!(baked.tables.iter().all(|table| table.values.is_empty()));
    }

    let huge = |how: &str| {
        let axes = "axes = { theta_i = 1024, theta_e = 1024, delta_phi = 512 }";
        let text = format!("[[tables]]\nquantity = \"brdf\"\nmodel = \"lambert\"\n{how}\n{axes}\n");
        let path = folder.path().join("huge.toml");
        fs::write(&path, text).unwrap();
        Plan::new(&scene::read(&path).unwrap(), &Selection::default())
    };
    assert!(huge("").is_ok());
    for how in ["storage = \"f16\"", "storage = \"f64\"", "tolerance = 1e-7"] {
        let why = huge(how).unwrap_err().to_string();
        assert!(why.contains("268435456 values") && why.contains("store it as f32"), "{why}");
    }
    // A caller who wants one piece gets the remedy, not an abort.
    let plan = huge("").unwrap().tables.remove(0);
    let why =
        device().bake(&plan, Check::Sample(0), &mut Timings::default(), &Unobserved).unwrap_err().to_string();
    assert!(why.contains("too many for one piece"), "{why}");
}

/// Killed in the second table, started again: the finished tiles are not computed again, and the files are
/// those of a bake that nobody disturbed.
#[test]
fn a_killed_bake_goes_on() {
    const BEFORE: usize = 14;
    let folder = tempfile::tempdir().unwrap();
    let recipe = recipe(folder.path(), RECIPE);
    let out = folder.path().join("out");
    let mut child = Command::new(env::current_exe().unwrap())
        .args(["--exact", "stream::a_bake_that_hangs", "--ignored", "--nocapture"])
        .env("GONIO_TEST_RECIPE", &recipe)
        .env("GONIO_TEST_OUT", &out)
        .env("GONIO_TEST_TILES", BEFORE.to_string())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    assert!(lines.any(|line| line.unwrap().contains(HANGS)), "the child ended before it could be killed");
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(files(&out).is_empty());

    // One tile is damaged: its hash tells.
    let partial = out.join(".gonio-partial");
    let tile = fs::read_dir(&partial).unwrap().next().unwrap().unwrap().path().join("000001.tile");
    let mut bytes = fs::read(&tile).unwrap();
    bytes[5] ^= 1;
    fs::write(&tile, bytes).unwrap();

    let check = Check::Sample(100);
    let baked = bake_recipe(device(), &recipe, &out, SMALL, check, &Unobserved).unwrap();
    assert_eq!((baked.tiles.all, baked.tiles.found), (23, BEFORE - 1));
    assert!(!partial.exists());
    let undisturbed = folder.path().join("undisturbed");
    let again = bake_recipe(device(), &recipe, &undisturbed, SMALL, check, &Unobserved).unwrap();
    assert_eq!(again.tiles.found, 0);
    assert!(files(&out) == files(&undisturbed));
}

const HANGS: &str = "now it hangs";

/// The process that [`a_killed_bake_goes_on`] kills.
#[test]
#[ignore = "run by another test"]
fn a_bake_that_hangs() {
    let path = |name| PathBuf::from(env::var_os(name).unwrap());
    let left = env::var("GONIO_TEST_TILES").unwrap().parse().unwrap();
    let observer = Stop::after(left, &|| {
        println!("{HANGS}");
        std::io::stdout().flush().unwrap();
        thread::sleep(Duration::from_secs(600));
        Ok(())
    });
    let (recipe, out) = (path("GONIO_TEST_RECIPE"), path("GONIO_TEST_OUT"));
    bake_recipe(device(), &recipe, &out, SMALL, Check::Sample(0), &observer).unwrap();
}

/// Another scene, tile size or device starts over, and the tiles that nobody wants go.
#[test]
fn any_difference_starts_over() {
    let folder = tempfile::tempdir().unwrap();
    let path = recipe(folder.path(), RECIPE);
    let out = folder.path().join("out");
    let cut = |evaluator, streaming| {
        let observer = Stop::after(5, &|| Err(gonio::Error::Interrupted));
        bake_recipe(evaluator, &path, &out, streaming, Check::Sample(0), &observer).unwrap_err();
        fs::read_dir(out.join(".gonio-partial")).unwrap().count()
    };
    let found = |evaluator, streaming| {
        assert_eq!(cut(device(), SMALL), 1);
        bake_recipe(evaluator, &path, &out, streaming, Check::Sample(0), &Unobserved).unwrap().tiles.found
    };
    assert_eq!(found(device(), SMALL), 5);
    assert_eq!(found(device(), Streaming { tile: 4800, ..SMALL }), 0);
    assert_eq!(found(&Evaluator::Cpu, SMALL), 0);
    assert_eq!(cut(device(), SMALL), 1);
    assert_eq!(cut(&Evaluator::Cpu, SMALL), 1);
    recipe(folder.path(), &RECIPE.replace("0.78", "0.79"));
    let baked = bake_recipe(device(), &path, &out, SMALL, Check::Sample(0), &Unobserved).unwrap();
    assert_eq!(baked.tiles.found, 0);
}

/// A device that is lost is opened once more, and the bake goes on with the tile that it was at.
#[test]
fn a_lost_device_is_opened_again() {
    let folder = tempfile::tempdir().unwrap();
    let recipe = recipe(folder.path(), RECIPE);
    let bake = |evaluator: &Evaluator, out: &str, observer: &dyn Observer| {
        let out = folder.path().join(out);
        bake_recipe(evaluator, &recipe, &out, SMALL, Check::Sample(100), observer).map(|_| files(&out))
    };
    let Ok((Evaluator::Device(own), _)) = Evaluator::choose(&DeviceChoice::Auto) else { panic!("no device") };
    let handle = own.wgpu().0.clone();
    let destroy = || {
        handle.destroy();
        Ok(())
    };
    let lost = Stop::after(5, &destroy);
    let own = Evaluator::Device(own);
    let after = bake(&own, "lost", &lost).unwrap();
    assert!(after == bake(device(), "kept", &Unobserved).unwrap());
}

/// Tables are checked while the next is computed, and yet named and returned in the plan's order.
#[test]
fn tables_come_in_order() {
    let folder = tempfile::tempdir().unwrap();
    let recipe = recipe(folder.path(), RECIPE);
    let names = ["gold", "basis", "dfg"];
    for evaluator in evaluators() {
        for (streaming, checked) in [(WHOLE, &names[..]), (SMALL, &names[2..])] {
            let begun = Begun::default();
            let out = folder.path().join("out");
            let baked = bake_recipe(evaluator, &recipe, &out, streaming, Check::Sample(50), &begun).unwrap();
            assert!(baked.tables.iter().map(|table| table.name.as_str()).eq(names));
            let steps = begun.0.into_inner().unwrap();
            let of = |verb: &str| -> Vec<_> {
                steps.iter().filter_map(|step| step.strip_prefix(verb)).map(str::trim).collect()
            };
            assert_eq!((&of("baking")[..], &of("checking")[..]), (&names[..], checked), "{steps:?}");
        }
    }
}

/// What begins.
#[derive(Default)]
struct Begun(Mutex<Vec<String>>);

impl Observer for Begun {
    fn begin(&self, step: &str) {
        self.0.lock().unwrap().push(step.into());
    }
}

/// Does something else once so many tiles are done.
struct Stop<'a> {
    state: Mutex<(Step, usize)>,
    then: &'a (dyn Fn() -> Result<()> + Sync),
}

#[derive(PartialEq)]
enum Step {
    Baking,
    Other,
}

impl<'a> Stop<'a> {
    fn after(tiles: usize, then: &'a (dyn Fn() -> Result<()> + Sync)) -> Self {
        Self { state: Mutex::new((Step::Other, tiles)), then }
    }
}

impl Observer for Stop<'_> {
    fn begin(&self, step: &str) {
        self.state.lock().unwrap().0 = if step.starts_with("baking") { Step::Baking } else { Step::Other };
    }

    fn advance(&self, _: f64) -> Result<()> {
        let (step, left) = &mut *self.state.lock().unwrap();
        if *step == Step::Other || *left == 0 {
            return Ok(());
        }
        *left -= 1;
        if *left == 0 { (self.then)() } else { Ok(()) }
    }
}
