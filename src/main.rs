//! The `gonio` command. See `gonio --help`.

fn main() {
    gonio::cli::main()
}
