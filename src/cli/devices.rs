//! `gonio devices`

use super::{HEADING, print, print_json};
use crate::error::Result;
use crate::gpu::{self, Adapter};
use serde_json::json;

#[derive(clap::Args)]
#[command(after_help = AFTER_HELP)]
pub struct Args {
    /// Print JSON on stdout
    #[arg(long)]
    json: bool,
}

const AFTER_HELP: &str = "\
Examples:
  gonio devices
  gonio bake scene.gltf --out tables --device llvmpipe

Exit codes: 0 success, 2 the list cannot be written";

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
        print(&format!("{HEADING}{}{HEADING:#}{mark}\n    {kind}, {backend}, {driver}", adapter.info.name))?;
    }
    if adapters.is_empty() {
        print(&format!("no GPU and no Vulkan driver. {}", gpu::INSTALL))?;
    }
    let mark = if adapters.is_empty() { " (auto)" } else { "" };
    print(&format!("{HEADING}cpu{HEADING:#}{mark}\n    the CPU path, in f64 on all cores"))?;
    Ok(())
}
