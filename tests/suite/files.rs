//! Promises of the table files: they say what they are, read back bit for bit in independent readers, and
//! a set of them is replaced as a whole or not at all.

use crate::common::readers;
use gonio::base::precision::Precision;
use gonio::io::format::{EXR, FORMATS, NPY, PNG, find};
use gonio::io::{Format, Provenance, TableEntry, TableSet, read_manifest, verify};
use gonio::table::axis::{Axis, Mapping, Positions, Variable};
use gonio::table::quantity::BRDF;
use gonio::table::storage::Storage;
use gonio::table::{ErrorKind, Table, TableError, indices};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

#[test]
fn exr_holds_values_axes_and_provenance() {
    for table in tables() {
        let image = readers::exr(&encode(&table, &EXR)).unwrap();
        assert_eq!((image.width, image.height), table.image_size(), "{}", table.name);
        assert_eq!(image.channels.len(), table.channels.len());
        for (c, name) in table.channels.iter().enumerate() {
            let read: Vec<_> = image.channels[name].iter().map(|v| v.to_bits()).collect();
            let baked: Vec<_> = (0..table.texels()).map(|t| (table.value(t, c) as f32).to_bits()).collect();
            assert_eq!(read, baked, "{}, channel {name}", table.name);
        }
        assert_eq!(image.text("gonio:name"), table.name);
        assert_eq!(image.text("gonio:quantity"), table.quantity.name);
        assert_eq!(image.text("gonio:unit"), table.quantity.unit);
        assert_eq!(image.text("gonio:subject"), table.subject);
        assert_eq!(image.text("gonio:rule"), table.rule);
        assert_eq!(image.text("gonio:precision"), table.precision.name());
        assert_eq!(image.text("gonio:scene"), "scène.gltf");
        let json = |name: &str| -> Value { serde_json::from_str(image.text(name)).unwrap() };
        assert_eq!(json("gonio:parameters"), json!(table.parameters));
        assert_eq!(json("gonio:channels"), json!(table.channels));
        assert_eq!(json("gonio:error"), json!(table.error));
        check_axes(&table, &json("gonio:axes"));
        assert!(!image.attributes.contains_key("gonio:seconds"), "times differ from run to run");
    }
}

#[test]
fn npy_holds_values_in_the_shape_of_the_axes() {
    for table in tables() {
        let (shape, values) = readers::npy(&encode(&table, &NPY)).unwrap();
        let expected: Vec<_> = table.axes.iter().map(Axis::len).chain([table.channels.len()]).collect();
        assert_eq!(shape, expected, "{}", table.name);
        assert_eq!(bits(&values), bits(&table.values.to_f32()), "{}", table.name);
    }
}

#[test]
fn readers_see_a_flipped_byte() {
    let table = brdf("gold");
    for format in [&EXR, &NPY] {
        let whole = encode(&table, format);
        let mut flipped = whole.clone();
        *flipped.last_mut().unwrap() ^= 1;
        let mut unknown = whole.clone();
        unknown[0] ^= 1;
        let short = &whole[..whole.len() - 1];
        match format.name {
            "exr" => {
                assert_ne!(readers::exr(&flipped), readers::exr(&whole));
                assert!(readers::exr(&unknown).is_err() && readers::exr(short).is_err());
            }
            _ => {
                assert_ne!(readers::npy(&flipped), readers::npy(&whole));
                assert!(readers::npy(&unknown).is_err() && readers::npy(short).is_err());
            }
        }
    }
}

#[test]
fn previews_of_all_shapes_are_pictures() {
    for table in tables() {
        let image = image::load_from_memory(&encode(&table, &PNG)).unwrap().into_rgb8();
        assert!(image.width() <= 1400 && image.height() >= 100, "{}: {:?}", table.name, image.dimensions());
        let ink = image.pixels().filter(|pixel| pixel.0 != [255; 3]).count();
        assert!(ink > 500, "{}: {ink} pixels drawn", table.name);
        let edge =
            (0..image.height()).filter(|&y| image.get_pixel(image.width() - 1, y).0 != [255; 3]).count();
        assert_eq!(edge, 0, "{}: something is cut off at the right", table.name);
    }
}

/// On nodes the first sample lies on the border, so its cell is half as wide as the others.
#[test]
fn heat_map_shows_samples_where_they_lie() {
    for (positions, share) in [(Positions::Nodes, 0.25), (Positions::Centers, 1.0 / 3.0)] {
        let axis = |v| Axis::new(v, 3, v.natural_range(), positions, Mapping::Linear).unwrap();
        let axes = vec![axis(Variable::Mu), axis(Variable::Roughness)];
        let table = table("corner", axes, &["A"], |at| f64::from(at[0] < 0.4 && at[1] < 0.4));
        let image = image::load_from_memory(&encode(&table, &PNG)).unwrap().into_rgb8();
        let yellow = image
            .enumerate_pixels()
            .filter(|(x, _, pixel)| *x < 640 && pixel.0[0] > 220 && pixel.0[1] > 200 && pixel.0[2] < 80);
        let (xs, ys): (BTreeSet<_>, BTreeSet<_>) = yellow.map(|(x, y, _)| (x, y)).unzip();
        let dark = |(_, _, pixel): &(u32, u32, &image::Rgb<u8>)| {
            pixel.0[0] < 80 && pixel.0[1] < 10 && pixel.0[2] > 60
        };
        let top = image.enumerate_pixels().find(dark).map(|(_, y, _)| y).unwrap();
        for (places, name) in [(&xs, "μ"), (&ys, "roughness")] {
            let share_seen = places.len() as f64 / 560.0;
            assert!((share_seen - share).abs() < 0.01, "{positions:?}, {name}: {share_seen}");
        }
        assert!(ys.first().unwrap() > &(top + 300), "small values are at the bottom");
    }
}

#[test]
fn same_table_same_bytes() {
    for table in tables() {
        for format in FORMATS {
            let first = encode(&table, format);
            for _ in 0..4 {
                assert!(encode(&table, format) == first, "{} as {format}", table.name);
            }
            let slower = Table { seconds: table.seconds + 1.0, ..table.clone() };
            assert!(encode(&slower, format) == first, "{} as {format} depends on the time taken", table.name);
        }
    }
}

#[test]
fn formats_have_names() {
    for format in FORMATS {
        assert_eq!(find(&format.to_string()).unwrap(), *format);
        let same =
            FORMATS.iter().filter(|other| other.name == format.name || other.extension == format.extension);
        assert_eq!(same.count(), 1, "{format}");
    }
    let error = find("tiff").unwrap_err().to_string();
    assert!(error.contains("tiff") && error.contains("exr, npy or png"), "{error}");
}

#[test]
fn a_set_has_files_hashes_and_axes_in_its_manifest() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("not/yet/there");
    bake(&dir, &tables());
    assert_eq!(verify(&dir).unwrap(), [""; 0]);
    let manifest = read_manifest(&dir).unwrap();
    for (table, entry) in tables().iter().zip(manifest["tables"].as_array().unwrap()) {
        assert_eq!(entry["name"], json!(table.name));
        assert_eq!(entry["channels"], json!(table.channels));
        assert_eq!(entry["seconds"], json!(table.seconds));
        check_axes(table, &entry["axes"]);
        for format in FORMATS {
            let bytes = fs::read(dir.join(entry["files"][format.name].as_str().unwrap())).unwrap();
            assert!(bytes == encode(table, format), "{} as {format}", table.name);
            assert_eq!(entry["sha256"][format.name].as_str().unwrap().len(), 64);
        }
    }
    let left: Vec<_> = snapshot(&dir).into_keys().filter(|name| name.starts_with('.')).collect();
    assert_eq!(left, [""; 0], "staging is gone");
}

#[test]
fn a_changed_or_missing_file_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    bake(dir, &[brdf("gold"), brdf("tin")]);
    let mut bytes = fs::read(dir.join("gold.npy")).unwrap();
    *bytes.last_mut().unwrap() ^= 1;
    // A file of its own now, not another name of the listed one.
    fs::remove_file(dir.join("gold.npy")).unwrap();
    fs::write(dir.join("gold.npy"), bytes).unwrap();
    fs::remove_file(dir.join("tin.exr")).unwrap();
    let listed = |table: usize, format: &str| {
        let manifest = read_manifest(dir).unwrap();
        dir.join(manifest["tables"][table]["files"][format].as_str().unwrap())
    };
    fs::write(listed(0, "exr"), "no image").unwrap();
    let faults = verify(dir).unwrap().join("\n");
    for words in
        ["gold.npy: is not files/gold.", "tin.exr: cannot be read", "SHA-256", "its shape is no table"]
    {
        assert!(faults.contains(words), "{words} in {faults}");
    }
    assert!(!faults.contains("png"), "{faults}");

    bake(dir, &[brdf("gold"), brdf("tin")]);
    assert_eq!(verify(dir).unwrap(), [""; 0], "baked again");
    let mut manifest = read_manifest(dir).unwrap();
    manifest["tables"][1]["axes"].as_array_mut().unwrap().pop();
    fs::write(dir.join("manifest.json"), manifest.to_string()).unwrap();
    let faults = verify(dir).unwrap();
    assert!(faults.len() == 2 && faults.iter().all(|fault| fault.contains("shape")), "{faults:?}");
}

/// Names that tell the content: what a reader of the old manifest opens cannot be something else.
#[test]
fn a_changed_table_has_another_name_and_a_plain_one() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    let name = || read_manifest(dir).unwrap()["tables"][0]["files"]["npy"].as_str().unwrap().to_owned();
    bake(dir, &[brdf("gold")]);
    let old = name();
    assert!(old.starts_with("files/gold.") && old.ends_with(".npy"), "{old}");
    bake(dir, &[brdf("gold")]);
    assert_eq!(name(), old);
    let mut gold = brdf("gold");
    gold.values = gold.values.iter().map(|value| 2.0 * value as f32).collect::<Vec<_>>().into();
    bake(dir, &[gold]);
    assert_ne!(name(), old);
    assert!(!dir.join(&old).exists());
    assert_eq!(fs::read(dir.join(name())).unwrap(), fs::read(dir.join("gold.npy")).unwrap());
}

/// Links with the names of our folders lead elsewhere, and nothing there is ours.
#[cfg(unix)]
#[test]
fn links_are_not_followed() {
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().unwrap();
    let elsewhere = folder.path().join("elsewhere");
    let precious = elsewhere.join("0123456789abcdef0123456789abcdef");
    fs::create_dir_all(&precious).unwrap();
    fs::write(precious.join("000000.tile"), "precious").unwrap();
    fs::write(elsewhere.join("thesis.exr"), "precious").unwrap();
    for (name, is_refused) in
        [(".gonio-partial", false), (".gonio-staging", true), ("files", true), (".gonio.lock", true)]
    {
        let dir = folder.path().join(name.trim_start_matches('.'));
        fs::create_dir(&dir).unwrap();
        symlink(&elsewhere, dir.join(name)).unwrap();
        let written = TableSet::create(&dir).and_then(|mut set| {
            let files = set.write(&brdf("gold"), FORMATS, &provenance())?;
            set.commit(
                &json!({ "schema": 1, "gonio": {}, "tables": [TableEntry::new(&brdf("gold"), files)] }),
            )
        });
        assert_eq!(written.is_err(), is_refused, "{name}: {written:?}");
        assert!(dir.join(name).is_symlink());
        assert_eq!(fs::read(precious.join("000000.tile")).unwrap(), b"precious", "{name}");
        assert_eq!(fs::read_dir(&elsewhere).unwrap().count(), 2, "{name}");
    }
}

#[test]
fn staging_that_was_cut_off_is_dropped() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    bake(dir, &[brdf("gold")]);
    let before = snapshot(dir);
    fs::create_dir(dir.join(".gonio-staging")).unwrap();
    fs::write(dir.join(".gonio-staging/gold.exr"), "half a fi").unwrap();
    drop(TableSet::create(dir).unwrap());
    assert!(snapshot(dir) == before && !dir.join(".gonio-staging").exists());
}

#[test]
fn without_a_commit_nothing_changes() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("out");
    let mut set = TableSet::create(&dir).unwrap();
    set.write(&brdf("gold"), FORMATS, &provenance()).unwrap();
    drop(set);
    assert!(!dir.exists(), "a folder that the bake made goes again");

    bake(&dir, &[brdf("gold")]);
    let before = snapshot(&dir);
    let mut set = TableSet::create(&dir).unwrap();
    set.write(&brdf("tin"), FORMATS, &provenance()).unwrap();
    drop(set);
    assert!(snapshot(&dir) == before && !dir.join(".gonio-staging").exists());

    let mut set = TableSet::create(&dir).unwrap();
    set.write(&brdf("tin"), FORMATS, &provenance()).unwrap();
    let empty = json!({ "schema": 1, "gonio": {}, "tables": [] });
    let error = set.commit(&empty).unwrap_err().to_string();
    assert!(error.contains("files/tin."), "a manifest must list what was written: {error}");
    assert!(snapshot(&dir) == before);
}

#[test]
fn two_bakes_do_not_mix() {
    let folder = tempfile::tempdir().unwrap();
    let first = TableSet::create(folder.path()).unwrap();
    let error = TableSet::create(folder.path()).unwrap_err().to_string();
    assert!(error.contains("another bake") && error.contains(folder.path().to_str().unwrap()), "{error}");
    drop(first);
    TableSet::create(folder.path()).unwrap();
}

#[test]
fn names_become_safe_and_unique_files() {
    let long = "x".repeat(5000);
    let names = [
        "../../etc/passwd",
        "a/b",
        "a\\b",
        "a_b",
        "..",
        ".",
        "",
        " ",
        ".hidden",
        "-rf",
        "CON",
        "com1.x",
        "Gold",
        "gold",
        "GOLD",
        "金属",
        "tr\u{202e}ick",
        "nul\0byte",
        "manifest",
        "dot.",
        "C:x",
        &long,
        "gold-2",
    ];
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("a/b/c");
    let all: Vec<_> = names.iter().map(|name| constant(name)).collect();
    bake(&dir, &all);
    assert_eq!(verify(&dir).unwrap(), [""; 0]);
    let files: BTreeSet<_> = snapshot(&dir).into_keys().map(|name| name.to_lowercase()).collect();
    assert_eq!(
        files.len(),
        3 * names.len() + 2,
        "with the manifest and the folder of the files that it lists"
    );
    for file in files {
        assert!(file.len() <= 120 && !file.starts_with(['.', '-']), "{file}");
        assert!(file.chars().all(|c| c.is_ascii_alphanumeric() || "._-".contains(c)), "{file}");
        assert!(!file.starts_with("con.") && !file.starts_with("com1."), "{file}");
    }
    let outside: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!(outside, ["a"]);
}

#[test]
fn files_of_others_stay() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("out");
    fs::create_dir(&dir).unwrap();

    // A table's file name is taken.
    fs::write(dir.join("gold.exr"), "a scan").unwrap();
    let mut set = TableSet::create(&dir).unwrap();
    let error = set.write(&brdf("gold"), &[&EXR], &provenance()).unwrap_err().to_string();
    assert!(error.contains("gold.exr") && error.contains("another folder"), "{error}");
    drop(set);
    assert_eq!(fs::read(dir.join("gold.exr")).unwrap(), b"a scan");

    // The manifest is a web application's.
    fs::write(dir.join("manifest.json"), r#"{ "name": "app" }"#).unwrap();
    let error = TableSet::create(&dir).unwrap_err().to_string();
    assert!(error.contains("manifest.json") && error.contains("not a manifest of gonio"), "{error}");
    assert!(read_manifest(&dir).is_err());

    // A forged manifest lists files that are not ours, one with the right hash.
    let victim = folder.path().join("victim.exr");
    fs::write(&victim, "").unwrap();
    let empty = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";
    fs::write(dir.join("thesis.doc"), "").unwrap();
    let forged = json!({ "schema": 1, "gonio": {}, "tables": [
        { "files": { "exr": "../victim.exr" }, "sha256": { "exr": empty } },
        { "files": { "exr": victim.to_str() }, "sha256": { "exr": empty } },
        { "files": { "exr": "thesis.doc" }, "sha256": { "exr": empty } },
        { "files": { "exr": "gold.exr" }, "sha256": { "exr": empty } },
    ]});
    fs::write(dir.join("manifest.json"), forged.to_string()).unwrap();
    assert_eq!(verify(&dir).unwrap().len(), 4, "none of them is taken for ours");
    bake(&dir, &[brdf("tin")]);
    assert!(victim.exists() && dir.join("thesis.doc").exists());
    assert_eq!(fs::read(dir.join("gold.exr")).unwrap(), b"a scan");
}

#[test]
fn folders_that_cannot_be_used_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    for dir in [file.clone(), file.join("below")] {
        let error = TableSet::create(&dir).unwrap_err().to_string();
        assert!(error.contains(dir.to_str().unwrap()) && error.contains("give another"), "{error}");
    }
    let error = read_manifest(folder.path()).unwrap_err().to_string();
    assert!(error.contains("manifest.json") && error.contains("bake"), "{error}");
}

/// Tables of every shape that previews tell apart, and the odd ones.
fn tables() -> Vec<Table> {
    let axis = |variable, count| Axis::natural(variable, count).unwrap();
    let one = |variable, value| Axis::listed(variable, vec![value]).unwrap();
    let root = Axis::new(Variable::Mu, 5, [0.1, 0.9], Positions::Nodes, Mapping::Sqrt).unwrap();
    let mut zero = brdf("zero");
    zero.values = vec![0.0f32; zero.values.len()].into();
    vec![
        brdf("gold"),
        zero,
        constant("constant"),
        table("none", vec![], &["R", "G", "B"], |_| 0.5),
        table("texel", vec![one(Variable::Roughness, 0.3)], &["rho"], |_| 0.5),
        table("line", vec![axis(Variable::ThetaI, 9)], &["R", "G", "B"], f64_sum),
        table("map", vec![root.clone(), axis(Variable::Roughness, 7)], &["A", "B"], f64_sum),
        table("flat", vec![one(Variable::ThetaI, 0.5), axis(Variable::ThetaE, 7)], &["A"], f64_sum),
        table(
            "four",
            vec![axis(Variable::Roughness, 4), axis(Variable::ThetaI, 5), root, axis(Variable::DeltaPhi, 3)],
            &["A", "B"],
            f64_sum,
        ),
    ]
}

/// A table whose values all differ, over more than ten decades.
fn brdf(name: &str) -> Table {
    let axes = [(Variable::ThetaI, 4), (Variable::ThetaE, 5), (Variable::DeltaPhi, 6)];
    let axes = axes.map(|(variable, count)| Axis::natural(variable, count).unwrap()).to_vec();
    table(name, axes, &["R", "G", "B"], |at| (8.0 * (at[0] + at[1] - at[2])).exp())
}

fn constant(name: &str) -> Table {
    table(name, vec![Axis::natural(Variable::Mu, 2).unwrap()], &["rho"], |_| 1.0 / 3.0)
}

fn f64_sum(at: &[f64]) -> f64 {
    at.iter().sum()
}

/// The table of a function of the axes; each channel a little larger than the one before.
fn table(name: &str, axes: Vec<Axis>, channels: &[&str], f: impl Fn(&[f64]) -> f64) -> Table {
    let shape: Vec<_> = axes.iter().map(Axis::len).collect();
    let value = |texel| {
        let at: Vec<_> = axes.iter().zip(indices(&shape, texel)).map(|(axis, k)| axis.values()[k]).collect();
        f(&at)
    };
    let texels = 0..shape.iter().product();
    let values = texels.flat_map(|t| (0..channels.len()).map(move |c| (t, c)));
    let values: Vec<f32> = values.map(|(t, c)| (value(t) * (1.0 + 0.1 * c as f64)) as f32).collect();
    Table {
        name: name.into(),
        quantity: &BRDF,
        subject: "gold α".into(),
        parameters: BTreeMap::from([("alpha".into(), 0.1)]),
        axes,
        channels: channels.iter().map(|&channel| channel.into()).collect(),
        values: values.into(),
        rule: "warped 32 v × 2·24 φ".into(),
        storage: Storage::F32,
        bilinear: None,
        precision: Precision::F32,
        error: TableError {
            kind: ErrorKind::Relative,
            floor: Some(1e-6),
            estimate: Some(1e-5),
            rounding: None,
            measured_max: Some(3e-7),
            measured_rms: Some(1e-7),
            texels_checked: 256,
            against: None,
            underflows: None,
            interpolation: None,
            worst: BTreeMap::from([("theta_i".into(), 0.25)]),
        },
        seconds: 0.25,
    }
}

fn provenance() -> Provenance {
    BTreeMap::from([("scene".into(), "scène.gltf".into()), ("device".into(), "llvmpipe".into())])
}

fn encode(table: &Table, format: &Format) -> Vec<u8> {
    format.encode(table, &provenance()).unwrap()
}

fn bake(dir: &Path, tables: &[Table]) {
    let mut set = TableSet::create(dir).unwrap();
    let mut entries = vec![];
    for table in tables {
        let files = set.write(table, FORMATS, &provenance()).unwrap();
        entries.push(TableEntry::new(table, files));
    }
    set.commit(&json!({ "schema": 1, "gonio": { "version": "test" }, "tables": entries })).unwrap();
}

/// Every file of a folder with its bytes, but for the lock, which stays.
fn snapshot(dir: &Path) -> BTreeMap<String, Vec<u8>> {
    let files = fs::read_dir(dir).unwrap().map(|entry| entry.unwrap().path());
    let named = files.map(|path| (path.file_name().unwrap().to_str().unwrap().to_owned(), path));
    let ours = named.filter(|(name, _)| name != ".gonio.lock");
    ours.map(|(name, path)| (name, fs::read(path).unwrap_or_default())).collect()
}

fn check_axes(table: &Table, read: &Value) {
    assert_eq!(read.as_array().unwrap().len(), table.axes.len());
    for (axis, read) in table.axes.iter().zip(read.as_array().unwrap()) {
        assert_eq!(read["name"], json!(axis.variable().name()));
        assert_eq!(read["unit"], json!(axis.variable().unit()));
        assert_eq!(read["mapping"], json!(axis.mapping()));
        assert_eq!(read["positions"], json!(axis.positions()));
        let numbers = |key: &str| -> Vec<u64> {
            read[key].as_array().unwrap().iter().map(|v| v.as_f64().unwrap().to_bits()).collect()
        };
        assert_eq!(numbers("range"), axis.range().map(f64::to_bits));
        assert_eq!(numbers("values"), axis.values().iter().map(|v| v.to_bits()).collect::<Vec<_>>());
    }
}

fn bits(values: &[f32]) -> Vec<u32> {
    values.iter().map(|value| value.to_bits()).collect()
}
