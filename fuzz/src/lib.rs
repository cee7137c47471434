//! The parsers of gonio as targets of `cargo fuzz`; `scripts/fuzz.sh` runs them all.

pub use gonio::fuzz::Parser;
pub use libfuzzer_sys;

/// A target for a parser of this name.
#[macro_export]
macro_rules! target {
    ($name:literal) => {
        $crate::libfuzzer_sys::fuzz_target!(|data: &[u8]| $crate::run($name, data));
    };
}

/// Runs a parser on bytes, in a folder that the process keeps.
pub fn run(name: &str, data: &[u8]) {
    static FOLDER: std::sync::LazyLock<tempfile::TempDir> = std::sync::LazyLock::new(|| {
        let folder = tempfile::tempdir().expect("a folder for temporary files");
        Parser::prepare(folder.path()).expect("a file in it");
        folder
    });
    let parser = Parser::find(name).expect("a parser of this name");
    let _ = parser.run(FOLDER.path(), data);
}
