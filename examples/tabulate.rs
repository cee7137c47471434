//! Computes the measured number tables of the models and writes them into the source.
//!
//!     cargo run --release --example tabulate                  # lists them
//!     cargo run --release --example tabulate -- ggx-counts    # minutes; writes src/model/ndf/ggx_counts.rs
//!
//! A test holds the tables in the source to what this writes: `cargo test --lib tabulate`, and all of them with `--ignored`.

use gonio::lab::tabulate::TABLES;
use std::path::Path;
use std::sync::Mutex;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let names: Vec<_> = std::env::args().skip(1).collect();
    if names.is_empty() {
        for table in &TABLES {
            println!("{:16}{}: {}", table.name, table.file, table.summary);
        }
        return Ok(());
    }
    for name in names {
        let Some(table) = TABLES.iter().find(|table| table.name == name) else {
            let known: Vec<_> = TABLES.iter().map(|table| table.name).collect();
            return Err(format!("no table \"{name}\"; there are {}", known.join(", ")).into());
        };
        let done = Mutex::new(0.0);
        let text = (table.compute)(&|share| {
            if let Ok(mut done) = done.lock() {
                let before = *done;
                *done += share;
                if (20.0 * before) as usize != (20.0 * *done) as usize {
                    eprintln!("{name}: {:.0} %", 100.0 * *done);
                }
            }
        });
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(table.file);
        let is_new = text != table.source;
        std::fs::write(&file, text)?;
        println!("{}: {}", file.display(), if is_new { "changed" } else { "as it was" });
    }
    Ok(())
}
