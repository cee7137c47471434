//! Nothing in `src/` stands in the way of a target with 32 bits and without threads or a clock, as a browser is. The
//! lines are read as text, so this finds slips and proves nothing.

use std::path::{Path, PathBuf};

/// The files of `src/` with a line of code that `is_found` takes.
fn files_with(is_found: impl Fn(&str) -> bool) -> Vec<String> {
    let src = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/src"));
    let mut folders: Vec<PathBuf> = vec![src.into()];
    let mut files = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let text = std::fs::read_to_string(&path).unwrap();
            let mut code = text.lines().map(|line| line.split("//").next().unwrap_or_default());
            if code.any(&is_found) {
                files.push(path.strip_prefix(src).unwrap().to_str().unwrap().replace('\\', "/"));
            }
        }
    }
    files.sort();
    files
}

#[test]
fn one_module_reads_the_clock() {
    assert_eq!(
        files_with(|line| line.contains("Instant") || line.contains("SystemTime")),
        ["base/timings.rs"]
    );
}

#[test]
fn one_module_waits_for_futures() {
    assert_eq!(
        files_with(|line| line.contains("pollster") || line.contains("block_on")),
        ["backend/gpu/device.rs"]
    );
}

/// Threads of the standard library; those of rayon run where it is asked for no more than one, too. The command is for
/// systems that have them, and so are shaders of more than a thousand operators in a row.
#[test]
fn two_modules_spawn_threads() {
    let mut files = files_with(|line| line.contains("std::thread"));
    files.retain(|file| !file.starts_with("cli/"));
    assert_eq!(files, ["batch/set.rs", "verify/limits.rs"]);
}

#[test]
fn no_constant_is_beyond_a_usize_of_32_bits() {
    assert_eq!(files_with(is_large), Vec::<String>::new());
    assert!(is_large("const MAX: usize = 1 << 33;") && is_large("const MAX: usize = 5_000_000_000;"));
    assert!(!is_large("const MAX: u64 = 1 << 33;") && !is_large("const MAX: usize = 1 << 28;"));
}

/// Whether a line is a constant of type usize that 32 bits do not hold: one number, or one number shifted.
fn is_large(line: &str) -> bool {
    let Some((_, value)) = line.split_once(": usize = ") else { return false };
    let number = |text: &str| text.trim().trim_end_matches(';').replace('_', "").parse::<u128>().ok();
    let value = match value.split_once("<<") {
        Some((number_text, shift)) => number(number_text).zip(number(shift)).map(|(n, by)| n << by),
        None => number(value),
    };
    value.is_some_and(|value| value > u128::from(u32::MAX))
}
