//! The command line: parse, call, print.

mod atlas;
mod bake;
mod check;
mod devices;
mod eval;
mod gallery;
mod junit;
mod light;
mod models;
mod plot;
mod subject;
mod trade;
mod watch;

use crate::base::error::{Error, Result};
use crate::light::set::device_json;
use anstyle::{AnsiColor, Style};
use clap::{Parser, Subcommand};
use std::io::{ErrorKind, Write};
use std::process::ExitCode;

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
    /// Evaluate a BRDF for one pair of directions or for a list of pairs
    Eval(eval::Args),
    /// Search for inputs at which a BRDF is not finite, not reciprocal, or gains energy
    Check(check::Args),
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
}

const AFTER_HELP: &str = "\
Examples:
  gonio bake scene.gltf --out tables
  gonio eval --model ggx --set roughness=0.3 --theta-i 45deg --theta-e 45deg
  gonio check --wgsl brdf.wgsl --entry brdf --set roughness=0.05..1
  gonio atlas --out atlas
  gonio plot ggx --set roughness=0.1,0.3,0.6 --out ggx.png
  gonio gallery --out gallery
  gonio trade --quantity split_sum --model ggx --out trade
  gonio light --env museum.exr --out light
  gonio models ggx
  gonio devices

Exit codes: 0 success, 1 a table misses its tolerance, or a BRDF breaks a promise, 2 bad input, 3 no device,
70 internal error, 130 interrupted";

/// Bold red.
const ERROR: Style = AnsiColor::Red.on_default().bold();
/// Bold yellow.
const WARNING: Style = AnsiColor::Yellow.on_default().bold();
/// Bold.
const HEADING: Style = Style::new().bold();

/// Runs the command and returns its exit code.
pub fn main() -> ExitCode {
    let result = match Cli::parse().command {
        Command::Bake(args) => bake::run(&args),
        Command::Eval(args) => eval::run(&args),
        Command::Check(args) => check::run(&args),
        Command::Atlas(args) => atlas::run(&args),
        Command::Plot(args) => plot::run(&args),
        Command::Gallery(args) => gallery::run(&args),
        Command::Trade(args) => trade::run(&args),
        Command::Light(args) => light::run(&args),
        Command::Models(args) => models::run(&args),
        Command::Devices(args) => devices::run(&args),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            tell(&format!("{ERROR}error:{ERROR:#} {error}"));
            ExitCode::from(exit_code(&error))
        }
    }
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

/// Prints a line on stderr. A closed stderr is no error: there is nobody left to tell.
fn tell(text: &str) {
    let _ = writeln!(anstream::stderr(), "{text}");
}

fn warn(message: &str) {
    tell(&format!("{WARNING}warning:{WARNING:#} {message}"));
}

/// Prints a message on stdout, or on stderr if stdout carries JSON.
fn print_beside(json: bool, text: &str) -> Result<()> {
    if json {
        tell(text);
        return Ok(());
    }
    print(text)
}

/// Prints a value as JSON on stdout.
fn print_json(value: &impl serde::Serialize) -> Result<()> {
    let text = serde_json::to_string_pretty(value).map_err(|e| Error::Internal(e.to_string()))?;
    print(&text)
}

/// Prints a line on stdout. A reader that closes the pipe early, as `head` does, is no error.
fn print(text: &str) -> Result<()> {
    match writeln!(anstream::stdout(), "{text}") {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Error::io("write", "stdout")(error)),
        _ => Ok(()),
    }
}
