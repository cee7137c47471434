//! Reads a shader's file: its text, its language, and what JavaScript wraps around it.

use super::token::words;
use crate::base::error::{Error, Result};
use std::path::{Path, PathBuf};

/// What a shader is written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ShaderLanguage {
    Wgsl,
    Glsl,
}

/// Extensions of files that hold shaders. Modules of JavaScript hold them as template literals.
const EXTENSIONS: [(&str, Option<ShaderLanguage>); 11] = [
    ("wgsl", Some(ShaderLanguage::Wgsl)),
    ("wesl", Some(ShaderLanguage::Wgsl)),
    ("glsl", Some(ShaderLanguage::Glsl)),
    ("frag", Some(ShaderLanguage::Glsl)),
    ("vert", Some(ShaderLanguage::Glsl)),
    ("comp", Some(ShaderLanguage::Glsl)),
    ("fs", Some(ShaderLanguage::Glsl)),
    ("vs", Some(ShaderLanguage::Glsl)),
    ("js", None),
    ("mjs", None),
    ("ts", None),
];

/// Whether a path has the extension of a shader.
pub fn is_shader(path: &Path) -> bool {
    extension(path).is_some()
}

fn extension(path: &Path) -> Option<Option<ShaderLanguage>> {
    let name = path.extension()?.to_str()?.to_lowercase();
    EXTENSIONS.iter().find(|(extension, _)| *extension == name).map(|&(_, language)| language)
}

/// The language of a text, by the file's extension, else by what it looks like.
pub(super) fn language(file: &str, text: &str) -> ShaderLanguage {
    extension(Path::new(file)).flatten().unwrap_or_else(|| {
        let words = words(text);
        match words.windows(3).any(|w| w[0].is("fn") && w[1].is_name() && w[2].is("(")) {
            true => ShaderLanguage::Wgsl,
            false => ShaderLanguage::Glsl,
        }
    })
}

/// Reads a file of shader source, as text.
pub(super) fn read(path: &Path) -> Result<String> {
    let bytes = std::fs::read(path).map_err(Error::io("read", path))?;
    let text = String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        Error::input(format!("{} is not text in UTF-8, from byte {at}", path.display()))
    })?;
    Ok(clean(&path.display().to_string(), text))
}

/// The shader in a file's text: without a byte order mark, and of JavaScript only the template literals.
pub(super) fn clean(file: &str, text: String) -> String {
    let text = text.strip_prefix('\u{feff}').map_or(text.clone(), str::to_owned).replace("\r\n", "\n");
    match extension(Path::new(file)) {
        Some(None) => literals(&text),
        _ => text,
    }
}

/// The template literals of a JavaScript module; all else becomes blank, so that lines stay.
fn literals(text: &str) -> String {
    let mut inside = false;
    let mut escaped = false;
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        let is_mark = c == '`' && !escaped;
        escaped = c == '\\' && !escaped;
        inside ^= is_mark;
        out.push(if c == '\n' || (inside && !is_mark) { c } else { ' ' });
    }
    out
}

/// Finds a file that a shader includes, beside the file that asks and in the folders given.
pub(super) fn find(name: &str, beside: Option<&Path>, folders: &[PathBuf]) -> Option<PathBuf> {
    let folders = beside.into_iter().chain(folders.iter().map(PathBuf::as_path));
    // Engines that keep chunks as modules leave the extension out.
    let mut paths = folders.flat_map(|folder| {
        ["", ".glsl", ".wgsl", ".glsl.js", ".wgsl.js", ".js"]
            .map(|ending| folder.join(format!("{name}{ending}")))
    });
    paths.find(|path| path.is_file())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn javascript_is_blank_but_for_its_literals() {
        assert_eq!(clean("a.glsl.js", "x = `a\r\nb`;\n".into()), "     a\nb  \n");
        assert_eq!(clean("a.wgsl", "\u{feff}fn".into()), "fn");
    }

    #[test]
    fn languages_are_told_apart() {
        assert_eq!(language("a.js", "float f(vec3 l) { }"), ShaderLanguage::Glsl);
        assert_eq!(language("a.js", "fn f(l: vec3f) { }"), ShaderLanguage::Wgsl);
        assert_eq!(language("a.frag", "fn f() { }"), ShaderLanguage::Glsl);
    }
}
