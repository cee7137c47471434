//! The `gonio` command. See `gonio --help`.

use std::process::ExitCode;

fn main() -> ExitCode {
    gonio::cli::main()
}
