//! The command line: parse, call, print.

mod atlas;
mod bake;
mod check;
mod devices;
mod eval;
mod gallery;
mod junit;
mod licenses;
mod light;
mod models;
mod plot;
mod print;
mod stop;
mod subject;
mod threads;
mod trade;
mod verify;
mod watch;

use crate::backend::gpu::DeviceChoice;
use crate::bake::Evaluator;
use crate::base::error::{Error, Result};
use crate::light::set::device_json;
use clap::{Parser, Subcommand};
use print::{HEADING, fail, print, print_beside, print_json, tell, warn};
use std::io::Write;

#[derive(Parser)]
#[command(name = "gonio", version, about, max_term_width = 100, after_help = AFTER_HELP)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Bake the tables of a scene or recipe and measure their error
    Bake(bake::Args),
    /// Compare the files of a folder with its manifest
    Verify(verify::Args),
    /// Evaluate a BRDF for one pair of directions or for a list of pairs
    Eval(eval::Args),
    /// Search for inputs at which a BRDF is not finite, not reciprocal, or gains energy
    Check(Box<check::Args>),
    /// Measure the error of f32 against f64 for each model and decade of α
    Atlas(atlas::Args),
    /// Draw a BRDF: its lobe, its albedo and lit spheres
    Plot(plot::Args),
    /// Make a web page with a picture of every model
    Gallery(gallery::Args),
    /// Compare the time and error of all integration methods
    Trade(trade::Args),
    /// Compute irradiance, spherical harmonics, exitant radiance or radiosity under a light
    Light(Box<light::Args>),
    /// List all models and their parts, or describe one model
    Models(models::Args),
    /// List the devices and test their drivers
    Devices(devices::Args),
    /// Print the licences of the crates and fonts that the program is made of
    Licenses,
}

const AFTER_HELP: &str = "\
Examples:
  gonio bake scene.gltf --out tables
  gonio verify tables
  gonio eval --model ggx --set roughness=0.3 --theta-i 45deg --theta-e 45deg
  gonio check brdf.wgsl#brdf --set roughness=0.05..1
  gonio atlas --out atlas
  gonio plot ggx --set roughness=0.1,0.3,0.6 --out ggx.png
  gonio gallery --out gallery
  gonio trade --quantity split_sum --model ggx --out trade
  gonio light --env museum.exr --out light
  gonio models ggx
  gonio devices

Exit codes: 0 success, 1 a table misses its tolerance, a BRDF breaks a promise, or files are not those of
their manifest, 2 bad input, 3 no device, 70 internal error, 130 interrupted";

/// Runs the command and ends the process with its exit code.
pub fn main() -> ! {
    stop::listen();
    let command = Cli::parse().command;
    let result = threads::start().and_then(|()| match command {
        Command::Bake(args) => bake::run(&args),
        Command::Verify(args) => verify::run(&args),
        Command::Eval(args) => eval::run(&args),
        Command::Check(args) => check::run(&args),
        Command::Atlas(args) => atlas::run(&args),
        Command::Plot(args) => plot::run(&args),
        Command::Gallery(args) => gallery::run(&args),
        Command::Trade(args) => trade::run(&args),
        Command::Light(args) => light::run(&args),
        Command::Models(args) => models::run(&args),
        Command::Devices(args) => devices::run(&args),
        Command::Licenses => licenses::run(),
    });
    stop::wait_if_asked();
    let code = result.map_or_else(
        |error| {
            fail(&error);
            exit_code(&error)
        },
        |()| 0,
    );
    let _ = std::io::stdout().flush(); // a reader that has gone is no error
    stop::end(code)
}

/// Opens what evaluates a command. It lives as long as the process, which ends with the command: drivers would take time to
/// take apart what the system frees at once, and a device that hangs would hold the process.
fn open(choice: &DeviceChoice) -> Result<(&'static Evaluator, String)> {
    let (evaluator, line) = Evaluator::choose(choice)?;
    Ok((Box::leak(Box::new(evaluator)), line))
}

/// Maps an error to the exit code that docs/drivers.md lists for its kind.
fn exit_code(error: &Error) -> u8 {
    match error {
        Error::Promise(_) => 1,
        Error::Input(_) | Error::Io { .. } => 2,
        Error::Device(_) => 3,
        Error::Internal(_) => 70,
        Error::Interrupted => 130,
    }
}
