//! The rooms of `src/` stand in layers: a room uses those of its own layer and of the layers above it in this list,
//! and no two rooms of a layer use each other.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// From what everything stands on to what nothing stands on. A new room takes its place here.
const LAYERS: [&[&str]; 11] = [
    &["base"],
    &["table"],
    &["model"],
    &["plan"],
    &["integrate"],
    &["shader"],
    &["backend"],
    &["check"],
    &["bake"],
    &["scene", "io", "light", "verify", "batch"],
    &["cli", "figure", "lab", "fuzz"],
];

/// `from` uses `to`, in a file.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
struct Edge {
    from: String,
    to: String,
    file: PathBuf,
}

#[test]
fn rooms_use_only_what_stands_above_them() {
    let edges = edges_of(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/src")));
    assert!(edges.len() > 100, "{} uses found: the test reads the wrong folder", edges.len());
    let faults = faults(&edges);
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// The test sees an upward use, a circle within a layer, and a room without a place.
#[test]
fn planted_edges_are_seen() {
    let edge = |text: &str, from: &str| {
        uses(text)
            .into_iter()
            .map(|to| Edge { from: from.into(), to, file: "planted.rs".into() })
            .collect::<Vec<_>>()
    };
    assert!(faults(&edge("use crate::table::Table;", "plan")).is_empty());
    assert_eq!(faults(&edge("use crate::plan::TablePlan;", "table")).len(), 1);
    assert_eq!(faults(&edge("fn f() -> crate::cli::Args { todo!() }", "scene")).len(), 1);
    assert_eq!(faults(&edge("use crate::{base::error::Error, plan::{self, TablePlan}};", "table")).len(), 1);
    assert_eq!(faults(&edge("use crate::base::error::Error;", "hall")).len(), 1);
    assert_eq!(faults(&edge("// crate::cli is the command", "base")).len(), 0);
    let circle = [edge("use crate::io::Files;", "scene"), edge("use crate::scene::Scene;", "io")].concat();
    assert_eq!(faults(&circle).len(), 1);
}

/// What is wrong with some uses, a line each.
fn faults(edges: &[Edge]) -> Vec<String> {
    let layer = |room: &str| LAYERS.iter().position(|layer| layer.contains(&room));
    let mut faults = Vec::new();
    let mut beside = BTreeMap::<_, BTreeSet<_>>::new();
    for Edge { from, to, file } in edges {
        let file = file.display();
        match (layer(from), layer(to)) {
            (None, _) => faults.push(format!("{file}: src/{from} has no place in LAYERS")),
            (_, None) => faults.push(format!("{file}: crate::{to} has no place in LAYERS")),
            (Some(here), Some(there)) if there > here => {
                faults.push(format!("{file}: {from} uses {to}, which stands on it"));
            }
            (Some(here), Some(there)) if here == there => {
                beside.entry(from.as_str()).or_default().insert(to.as_str());
            }
            _ => {}
        }
    }
    let reaches = |from: &str, to: &str| {
        let (mut seen, mut next) = (BTreeSet::new(), vec![from]);
        while let Some(room) = next.pop() {
            for &other in beside.get(room).into_iter().flatten().filter(|&&other| other != room) {
                if other == to {
                    return true;
                }
                if seen.insert(other) {
                    next.push(other);
                }
            }
        }
        false
    };
    let rooms: BTreeSet<_> = beside.keys().copied().collect();
    let circle: Vec<_> = rooms.into_iter().filter(|room| reaches(room, room)).collect();
    if !circle.is_empty() {
        faults.push(format!("these rooms use each other in a circle: {}", circle.join(", ")));
    }
    faults
}

/// All uses of another room, file by file.
fn edges_of(src: &Path) -> Vec<Edge> {
    let mut folders = vec![src.to_path_buf()];
    let mut edges = BTreeSet::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let inside = path.strip_prefix(src).unwrap().to_path_buf();
            let room = inside.iter().next().unwrap().to_str().unwrap();
            if matches!(room, "lib.rs" | "main.rs") {
                continue;
            }
            let from = room.trim_end_matches(".rs").to_owned();
            for to in uses(&std::fs::read_to_string(&path).unwrap()) {
                edges.insert(Edge { from: from.clone(), to, file: inside.clone() });
            }
        }
    }
    edges.into_iter().collect()
}

/// The rooms that a source text names by `crate::room` or `crate::{room::…, room::…}`, outside comments.
fn uses(text: &str) -> BTreeSet<String> {
    let code: String =
        text.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n");
    let mut rooms = BTreeSet::new();
    for (at, _) in code.match_indices("crate::") {
        let rest = &code[at + "crate::".len()..];
        let Some(group) = rest.strip_prefix('{') else {
            rooms.extend(first_word(rest));
            continue;
        };
        let mut depth = 1;
        let mut starts = vec![0];
        for (k, letter) in group.char_indices() {
            match letter {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 1 => starts.push(k + 1),
                _ => {}
            }
            if depth == 0 {
                break;
            }
        }
        rooms.extend(starts.into_iter().filter_map(|start| first_word(group[start..].trim_start())));
    }
    rooms
}

fn first_word(text: &str) -> Option<String> {
    let word: String = text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    // Types, macros and constants at the root of the crate are no rooms.
    (word.starts_with(|c: char| c.is_lowercase()) && word != "wgpu").then_some(word)
}

/// The reference is a crate that depends on glam and libm and on nothing else; only what compares with it names it.
#[test]
fn the_reference_stands_apart() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let manifest = std::fs::read_to_string(root.join("crates/reference/Cargo.toml")).unwrap();
    let mut tables = Vec::new();
    let mut dependencies = Vec::new();
    for line in manifest.lines().map(str::trim) {
        match line.strip_prefix('[') {
            Some(table) => tables.push(table.trim_end_matches(']')),
            None if tables.last() == Some(&"dependencies") => {
                dependencies.extend(line.split_once('=').map(|(name, _)| name.trim()));
            }
            None => {}
        }
    }
    assert_eq!(dependencies, ["glam", "libm"]);
    let others: Vec<_> = tables.iter().filter(|table| table.contains("dependencies")).collect();
    assert_eq!(others, [&"dependencies"], "no other kind of dependency");
    assert!(!root.join("crates/reference/build.rs").exists());

    for room in std::fs::read_dir(root.join("src")).unwrap().map(|entry| entry.unwrap().path()) {
        let name = room.file_name().unwrap().to_str().unwrap();
        if !room.is_dir() || ["check", "verify", "lab", "light"].contains(&name) {
            continue;
        }
        for file in files(&room) {
            let text = std::fs::read_to_string(&file).unwrap();
            let is_test = file.ends_with("model/truth.rs");
            assert!(is_test || !text.contains("gonio_reference"), "{} names the reference", file.display());
        }
    }
}

/// All files below a folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}
