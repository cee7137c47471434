//! `gonio verify`

use crate::base::error::{Error, Result};
use crate::cli::{print, print_json, warn};
use crate::io;
use serde_json::{Value, json};
use std::path::PathBuf;

#[derive(clap::Args)]
#[command(after_help = AFTER_HELP)]
pub struct Args {
    /// The folder with manifest.json, as gonio bake, light or gallery wrote it
    #[arg(value_name = "DIR")]
    dir: PathBuf,
    /// Print JSON on stdout
    #[arg(long)]
    json: bool,
}

const AFTER_HELP: &str = "\
Examples:
  gonio verify tables
  gonio verify tables --json

Compares each file that the manifest lists with its SHA-256, tables also with their shape, and plain names
with the files that they stand for. Warns of what a bake that was killed left. Nothing is changed.

Exit codes: 0 the set is whole, 1 it is not, 2 no manifest, or it cannot be read, 130 interrupted";

pub fn run(args: &Args) -> Result<()> {
    let manifest = io::read_manifest(&args.dir)?;
    let faults = io::verify(&args.dir)?;
    let leftovers = io::leftovers(&args.dir)?;
    let count = |key: &str| manifest.get(key).and_then(Value::as_array).map_or(0, Vec::len);
    let files = io::listed_files(&manifest);
    if args.json {
        print_json(&json!({
            "dir": args.dir, "whole": faults.is_empty(), "tables": count("tables"), "files": files,
            "faults": faults, "left_over": leftovers,
        }))?;
    } else {
        leftovers.iter().for_each(|line| warn(line));
        print(&format!("{} tables, {files} files in {}", count("tables"), args.dir.display()))?;
    }
    if faults.is_empty() { Ok(()) } else { Err(Error::Promise(faults.join("\n"))) }
}
