//! Writes the seeds of every target into a folder: `seeds corpus`.

use gonio::fuzz::PARSERS;

fn main() -> std::io::Result<()> {
    let corpus = std::path::PathBuf::from(std::env::args().nth(1).unwrap_or("corpus".into()));
    for parser in PARSERS {
        let folder = corpus.join(parser.name);
        std::fs::create_dir_all(&folder)?;
        for (k, seed) in (parser.seeds)().iter().enumerate() {
            std::fs::write(folder.join(format!("seed{k}")), seed)?;
        }
    }
    Ok(())
}
