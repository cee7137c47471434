//! Promises about what gonio is made of: every crate is of crates.io, under a licence that lets anyone use the program, known
//! twice only where a reason stands here, and named with its licence in THIRD-PARTY.md.

use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;

const LICENCES: [&str; 13] = [
    "0BSD",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "ISC",
    "MIT",
    "OFL-1.1",
    "Ubuntu-font-1.0",
    "Unicode-3.0",
    "Unlicense",
    "Zlib",
    "CC0-1.0",
];

/// Crates of which two versions are compiled, and why.
const DUPLICATES: [(&str, &str); 4] = [
    ("hashbrown", "gpu-allocator takes 0.16, wgpu 0.17"),
    ("jni-sys", "0.3 hands on to 0.4; for Android alone"),
    ("miniz_oxide", "exr and png take 0.8, flate2 0.9"),
    ("syn", "derive macros are moving from 2 to 3; none of it is in the program"),
];

#[test]
fn every_crate_is_of_crates_io_and_duplicates_are_known() {
    let lock = include_str!("../../Cargo.lock");
    let mut versions = BTreeMap::<_, BTreeSet<_>>::new();
    for package in lock.split("[[package]]").skip(1) {
        let field = |key: &str| {
            let line = package.lines().find_map(|line| line.strip_prefix(key));
            line.map(|line| line.trim_matches([' ', '=', '"']))
        };
        let (name, version) = (field("name").unwrap(), field("version").unwrap());
        versions.entry(name).or_default().insert(version);
        if !name.starts_with("gonio") {
            let source = field("source").unwrap_or("a path");
            assert_eq!(source, "registry+https://github.com/rust-lang/crates.io-index", "{name} {version}");
            assert!(field("checksum").is_some_and(|sum| sum.len() == 64), "{name} {version}");
        }
    }
    let twice: Vec<_> =
        versions.iter().filter(|(_, versions)| versions.len() > 1).map(|(&name, _)| name).collect();
    assert!(versions.len() > 100, "Cargo.lock is not read");
    assert_eq!(twice, DUPLICATES.map(|(name, _)| name), "{versions:?}");
}

#[test]
fn every_licence_is_allowed() {
    let metadata = metadata();
    let mut refused = Vec::new();
    for package in metadata["packages"].as_array().unwrap() {
        let licence = package["license"].as_str().unwrap_or("none");
        if !is_allowed(licence) {
            refused.push(format!("{}: {licence}", package["name"]));
        }
    }
    assert!(refused.is_empty(), "{refused:?}");
    assert!(
        !is_allowed("GPL-3.0-only")
            && !is_allowed("MIT AND GPL-3.0-only")
            && is_allowed("GPL-3.0-only OR MIT")
    );
}

/// An SPDX expression: all parts of an AND, any of an OR. Brackets hold ORs.
fn is_allowed(expression: &str) -> bool {
    let expression = expression.replace('/', " OR ");
    expression.split(" AND ").all(|part| {
        let part = part.trim_matches(['(', ')']);
        part.split(" OR ").any(|name| LICENCES.contains(&name.trim_matches(['(', ')', ' '])))
    })
}

/// Those of this platform; the page has those of all.
#[test]
fn third_party_notices_are_complete() {
    let page = include_str!("../../THIRD-PARTY.md");
    let metadata = metadata();
    let find = |list: &Value, id: &Value| {
        list.as_array().unwrap().iter().find(|entry| entry["id"] == *id).unwrap().clone()
    };
    let (mut found, mut next) = (Vec::new(), vec![metadata["resolve"]["root"].clone()]);
    while let Some(id) = next.pop() {
        if found.contains(&id) {
            continue;
        }
        for dep in find(&metadata["resolve"]["nodes"], &id)["deps"].as_array().unwrap() {
            if dep["dep_kinds"].as_array().unwrap().iter().any(|kind| kind["kind"].is_null()) {
                next.push(dep["pkg"].clone());
            }
        }
        found.push(id);
    }
    let is_listed =
        |label: &str| page.split([',', ':', '\n']).any(|word| word.trim().trim_end_matches('.') == label);
    let mut missing = Vec::new();
    for id in &found {
        let package = find(&metadata["packages"], id);
        let label = format!("{} {}", package["name"].as_str().unwrap(), package["version"].as_str().unwrap());
        if !package["source"].is_null() && !is_listed(&label) {
            missing.push(label);
        }
    }
    assert!(found.len() > 100 && !is_listed("gonio 0.0.0"));
    assert!(missing.is_empty(), "run scripts/third_party.py > THIRD-PARTY.md: {missing:?}");
    for licence in ["## Font: Hack", "## Font: Ubuntu Light", "## BSD-3-Clause: exr "] {
        assert!(page.contains(licence), "{licence}");
    }
}

/// `cargo metadata` of this platform, whose crates are here as the tests were built of them.
fn metadata() -> Value {
    let run = |program: &str, arguments: &[&str]| {
        let output =
            Command::new(program).args(arguments).current_dir(env!("CARGO_MANIFEST_DIR")).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    let cargo = std::env::var("CARGO").unwrap_or("cargo".into());
    let about = run(Path::new(&cargo).with_file_name("rustc").to_str().unwrap(), &["-vV"]);
    let host = about.lines().find_map(|line| line.strip_prefix("host: ")).unwrap();
    let arguments = ["metadata", "--offline", "--locked", "--format-version", "1", "--filter-platform", host];
    serde_json::from_str(&run(&cargo, &arguments)).unwrap()
}
