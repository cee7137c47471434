//! `gonio devices`

use crate::backend::gpu;
use crate::backend::gpu::{ASKED_TURNS, Adapter, Canary};
use crate::base::error::Result;
use crate::cli::{HEADING, print, print_json};
use serde_json::{Value, json};

#[derive(clap::Args)]
#[command(after_help = AFTER_HELP)]
pub struct Args {
    /// Print JSON on stdout
    #[arg(long)]
    json: bool,
}

const AFTER_HELP: &str = "\
Each device runs one small shader. It tests whether the driver stops long loops, rounds a·b + c once,
reorders sums or drops denormals. The list states the consequences for tables.

Examples:
  gonio devices
  gonio bake scene.gltf --out tables --device llvmpipe

Exit codes: 0 success, 2 the list cannot be written";

pub fn run(args: &Args) -> Result<()> {
    let adapters = gpu::adapters();
    // `auto` chooses the first that opens.
    let opened = adapters.iter().map(Adapter::open);
    let canaries: Vec<_> = opened.map(|device| device.map(|device| device.canary())).collect();
    if args.json {
        let mut devices: Vec<_> = adapters.iter().zip(&canaries).map(|(a, c)| entry(a, c)).collect();
        devices.push(json!({ "name": "cpu", "kind": "CPU", "backend": "none", "driver": "f64" }));
        return print_json(&devices);
    }
    let auto = canaries.iter().position(Result::is_ok);
    let mark = |is_auto| if is_auto { " (auto)" } else { "" };
    for (k, (adapter, canary)) in adapters.iter().zip(&canaries).enumerate() {
        let (kind, backend, driver) = (adapter.kind(), adapter.info.backend, adapter.driver());
        print(&format!("{HEADING}{}{HEADING:#}{}", adapter.info.name, mark(auto == Some(k))))?;
        print(&format!("    {kind}, {backend}, {driver}"))?;
        match canary {
            Ok(Ok(canary)) => {
                print(&format!("    {}", loops(canary)))?;
                arithmetic(canary).iter().try_for_each(|line| print(&format!("    {line}")))?;
            }
            Ok(Err(why)) => print(&format!("    its driver could not be asked: {why}"))?,
            Err(why) => print(&format!("    it cannot be opened: {why}"))?,
        }
    }
    if adapters.is_empty() {
        print(&format!("no GPU and no Vulkan driver. {}", gpu::INSTALL))?;
    }
    print(&format!("{HEADING}cpu{HEADING:#}{}\n    the CPU path, in f64 on all cores", mark(auto.is_none())))
}

fn entry(adapter: &Adapter, canary: &Result<Result<Canary>>) -> Value {
    let mut entry = json!({
        "name": adapter.info.name,
        "kind": adapter.kind(),
        "backend": adapter.info.backend.to_string(),
        "driver": adapter.driver(),
    });
    match canary {
        Ok(Ok(canary)) => entry["canary"] = json!(canary),
        Ok(Err(why)) | Err(why) => entry["error"] = json!(why.to_string()),
    }
    entry
}

/// Describes how the driver treats long loops.
fn loops(canary: &Canary) -> String {
    match canary.loop_turns {
        Some(turns) => {
            format!("stops loops after {turns} turns, silently: tables that take more are refused")
        }
        None => format!("runs loops of {ASKED_TURNS} turns"),
    }
}

/// Describes how the driver rounds, and the consequences for tables.
fn arithmetic(canary: &Canary) -> Vec<&'static str> {
    let Canary { contracts, fused_fma, reassociates, flushes_denormals, tells_nan, .. } = *canary;
    let products = match (contracts, fused_fma) {
        (true, _) => "contracts a·b + c: last bits may change when ωi and ωe are exchanged",
        (false, true) => "rounds a·b + c twice, fma once: exchanging ωi and ωe changes no bit",
        (false, false) => "rounds a·b + c twice, fma too: exchanging ωi and ωe changes no bit",
    };
    let oddities = [
        (reassociates, "takes (a + b) − b for a: sums are in blocks, which that cannot harm"),
        (flushes_denormals, "takes denormals for 0: f below 1e-38 sr⁻¹ is 0"),
        (!tells_nan, "misses NaN in x ≠ x: results are judged by their bits"),
    ];
    let oddities = oddities.into_iter().filter(|(has, _)| *has).map(|(_, line)| line);
    std::iter::once(products).chain(oddities).collect()
}
