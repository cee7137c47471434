//! A set is replaced as a whole or not at all, whatever operation on the disk fails and wherever the process dies: for a
//! reader that knows no more than `manifest.json` and the files that it lists.

use super::TableSet;
use crate::base::error::Result;
use crate::io::disk::faults::{DiskFault, run};
use crate::io::verify;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// A set: its files by their plain names.
type Set = BTreeMap<String, Vec<u8>>;

fn set(files: &[(&str, &str)]) -> Set {
    files.iter().map(|(name, content)| (format!("{name}.png"), content.as_bytes().to_vec())).collect()
}

fn write(dir: &Path, set: &Set) -> Result<()> {
    let mut written = TableSet::create(dir)?;
    let mut files = Map::new();
    for (name, bytes) in set {
        let (name, sha256) = written.add(name, bytes)?;
        files.insert(name, sha256.into());
    }
    written.commit(&json!({ "schema": 1, "gonio": {}, "files": files }))
}

/// What a plain reader finds; nothing without a manifest.
fn read(dir: &Path) -> Set {
    let Ok(manifest) = fs::read(dir.join("manifest.json")) else { return Set::new() };
    let manifest: Value = serde_json::from_slice(&manifest).unwrap();
    let content = |listed: &String| (super::plain_name(listed), fs::read(dir.join(listed)).unwrap());
    manifest["files"].as_object().unwrap().keys().map(content).collect()
}

/// Every file of a folder but the lock.
fn snapshot(dir: &Path) -> Set {
    let mut files = Set::new();
    for entry in fs::read_dir(dir).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if path.is_dir() {
            files
                .extend(snapshot(&path).into_iter().map(|(below, bytes)| (format!("{name}/{below}"), bytes)));
        } else if name != super::LOCK {
            files.insert(name, fs::read(&path).unwrap());
        }
    }
    files
}

/// A new file, a changed one and one that goes; a set where none was; the same set again.
#[test]
fn any_fault_at_any_step_leaves_the_old_set_or_the_new() {
    let first = set(&[("gold", "old gold"), ("tin", "tin")]);
    let second = set(&[("gold", "new gold"), ("lead", "lead")]);
    let empty = Set::new();
    let mut tried = [0; 2];
    for (old, new) in [(&first, &second), (&empty, &second), (&first, &first)] {
        for (kind, fault) in [DiskFault::Error, DiskFault::Kill].into_iter().enumerate() {
            for n in 0.. {
                let folder = tempfile::tempdir().unwrap();
                let dir = folder.path().join("out");
                if !old.is_empty() {
                    write(&dir, old).unwrap();
                    fs::write(dir.join("notes.txt"), "not ours").unwrap();
                }
                let before = if old.is_empty() { Set::new() } else { snapshot(&dir) };
                let (result, happened) = run(n, fault, || write(&dir, new));
                let found = read(&dir);
                let place = format!("{fault:?} at step {n}: {result:?}");
                if !happened {
                    assert!(result.is_ok() && found == *new, "{place}");
                    break;
                }
                tried[kind] += 1;
                assert!(found == *old || found == *new, "{place}: {found:?}");
                if result.is_ok() {
                    // What failed was of no account: the copy of a link, say.
                    assert!(found == *new, "{place}");
                    assert!(verify(&dir).unwrap().is_empty(), "{place}");
                } else if fault == DiskFault::Error && found == *old && old != new {
                    let after = if dir.exists() { snapshot(&dir) } else { Set::new() };
                    let left: Vec<_> =
                        after.keys().filter(|name| !name.starts_with(super::STAGING)).collect();
                    assert_eq!(left, before.keys().collect::<Vec<_>>(), "{place}");
                }
                // The next bake is in nobody's way, finishes what is to be finished, and leaves nothing.
                write(&dir, new).unwrap_or_else(|error| panic!("{place}, then {error}"));
                assert!(read(&dir) == *new && verify(&dir).unwrap().is_empty(), "{place}");
                let mut whole = snapshot(&dir);
                whole.remove("notes.txt");
                assert_eq!(whole.len(), 2 * new.len() + 1, "{place}: {:?}", whole.keys());
                assert_eq!(dir.join("notes.txt").exists(), !old.is_empty(), "{place}");
            }
        }
    }
    println!("{} errors and {} kills", tried[0], tried[1]);
    assert!(tried[0] > 100 && tried[1] > 100, "{tried:?}");
}

/// A bake that was killed after the commit point is finished by the next, even if that one fails.
#[test]
fn plain_names_follow_the_manifest() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    let [old, new] = [set(&[("gold", "old"), ("tin", "tin")]), set(&[("gold", "new"), ("lead", "lead")])];
    write(dir, &old).unwrap();
    for n in 0.. {
        let (_, happened) = run(n, DiskFault::Kill, || write(dir, &new));
        assert!(happened, "no kill was between the manifest and the plain names");
        if read(dir) == new && fs::read(dir.join("gold.png")).unwrap() == b"old" {
            break;
        }
    }
    assert!(!verify(dir).unwrap().is_empty(), "gold.png is not what the manifest lists");
    drop(TableSet::create(dir).unwrap());
    assert_eq!(verify(dir).unwrap(), [""; 0]);
    assert!(!dir.join("tin.png").exists() && dir.join("lead.png").exists());
}
