//! `gonio devices`

use super::{HEADING, print_json};
use crate::error::Result;
use crate::gpu::{self, Adapter};
use anstream::println;
use serde_json::json;

#[derive(clap::Args)]
pub struct Args {
    /// Print JSON on stdout
    #[arg(long)]
    json: bool,
}

pub fn run(args: &Args) -> Result<()> {
    let adapters = gpu::adapters();
    if args.json {
        let entry = |a: &Adapter| {
            json!({
                "name": a.info.name,
                "kind": a.kind(),
                "backend": a.info.backend.to_string(),
                "driver": a.driver(),
            })
        };
        let mut devices: Vec<_> = adapters.iter().map(entry).collect();
        devices.push(json!({ "name": "cpu", "kind": "CPU", "backend": "none", "driver": "f64" }));
        return print_json(&devices);
    }
    for (k, adapter) in adapters.iter().enumerate() {
        let mark = if k == 0 { " (auto)" } else { "" };
        let (kind, backend, driver) = (adapter.kind(), adapter.info.backend, adapter.driver());
        println!("{HEADING}{}{HEADING:#}{mark}\n    {kind}, {backend}, {driver}", adapter.info.name);
    }
    if adapters.is_empty() {
        println!("no GPU and no Vulkan driver. {}", gpu::INSTALL);
    }
    let mark = if adapters.is_empty() { " (auto)" } else { "" };
    println!("{HEADING}cpu{HEADING:#}{mark}\n    the CPU path, in f64 on all cores");
    Ok(())
}
