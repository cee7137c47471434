//! Joins a shader with the modules that it imports, as naga_oil names them: `#import bevy_pbr::lighting::F_Schlick`.
//!
//! Names of modules become plain ones, `bevy_pbr_lighting_F_Schlick`. The user's own names stay. A module that is not
//! there is no fault until the function that is checked reaches it.

use super::items::{ItemKind, items};
use super::preprocess::{Preprocessor, Unit};
use super::source::{self, ShaderLanguage};
use super::text::{ShaderText, SourceLine};
use super::token::{Token, words};
use crate::base::error::{Error, Result};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::{Path, PathBuf};

/// Files in which modules are looked for, at most.
const MOST_FILES: usize = 10_000;

/// A shader with all its modules.
pub(super) struct Joined {
    pub text: ShaderText,
    /// Plain names of what is imported and not there, and what the user wrote.
    pub missing: BTreeMap<String, String>,
}

/// Reads a shader with what it includes and imports.
pub(super) fn join(
    name: &str,
    source: &str,
    path: Option<&Path>,
    language: ShaderLanguage,
    folders: &[PathBuf],
    defines: &[(String, String)],
) -> Result<Joined> {
    let mut preprocessor = Preprocessor::new(language, folders, defines);
    let mut main = preprocessor.run(name, source, path)?;
    if language == ShaderLanguage::Wgsl {
        wesl_imports(&mut main)?;
    }
    let mut files = std::mem::take(&mut preprocessor.files);
    let qualified = |unit: &Unit| unit.lines.iter().any(|line| line.text.contains("::"));
    if language == ShaderLanguage::Glsl || (main.imports.is_empty() && !qualified(&main)) {
        let text = ShaderText { files, lines: main.lines };
        return Ok(Joined { text, missing: BTreeMap::new() });
    }

    let modules = modules(path, folders)?;
    let mut lines = Vec::new();
    let mut missing = BTreeMap::new();
    let mut known = HashSet::<String>::new();
    // The user's file has no prefix, wherever it says that it belongs.
    let own_path = main.path.clone().unwrap_or_default();
    known.insert(own_path.clone());
    let mut next = vec![(main, String::new())];
    while let Some((mut unit, prefix)) = next.pop() {
        let text = ShaderText { files: files.clone(), lines: std::mem::take(&mut unit.lines) };
        let joined = text.joined();
        let own: HashSet<_> = items(&joined, language)
            .into_iter()
            .filter(|item| item.kind != ItemKind::Directive)
            .flat_map(|i| i.names)
            .collect();
        let resolver = Resolver::new(&unit, &own_path, prefix, own, &modules);
        let (renamed, wanted) = resolver.rename(&joined);
        for (module, written, plain) in wanted {
            let Some(module) = module else {
                missing.insert(plain, written);
                continue;
            };
            if !known.insert(module.clone()) {
                continue;
            }
            let file = &modules[&module];
            let shown = file.display().to_string();
            let mut preprocessor = Preprocessor::new(language, folders, defines);
            let mut unit = preprocessor.run(&shown, &source::read(file)?, Some(file))?;
            unit.lines.iter_mut().for_each(|line| line.file += files.len());
            files.append(&mut preprocessor.files);
            next.push((unit, prefix_of(&module)));
        }
        lines.extend(hoisted(text.with_text(&renamed).lines, lines.is_empty()));
    }
    // Directives of modules must stand first.
    let (directives, lines): (Vec<_>, Vec<_>) = lines.into_iter().partition(|(_, first)| *first);
    let lines = directives.into_iter().chain(lines).map(|(line, _)| line).collect();
    Ok(Joined { text: ShaderText { files, lines }, missing })
}

/// Marks the lines of a module that must stand first.
fn hoisted(lines: Vec<SourceLine>, is_main: bool) -> impl Iterator<Item = (SourceLine, bool)> {
    lines.into_iter().map(move |line| {
        let first =
            !is_main && ["enable ", "requires "].iter().any(|word| line.text.trim_start().starts_with(word));
        (line, first)
    })
}

/// Refuses imports of WESL, with what flattens them.
fn wesl_imports(unit: &mut Unit) -> Result<()> {
    let found = unit.lines.iter().position(|line| {
        let words = words(&line.text);
        words.len() > 2 && words[0].is("import") && words[1].is_name() && words[2].is("::")
    });
    match found {
        None => Ok(()),
        Some(k) => Err(Error::input(format!(
            "line {}: `{}` is WESL; flatten it first, by `cargo install wesl-cli` and `wesl compile FILE > flat.wgsl`",
            unit.lines[k].number + 1,
            unit.lines[k].text.trim()
        ))),
    }
}

/// The plain prefix of a module's names.
fn prefix_of(module: &str) -> String {
    let plain: String = module.chars().map(|c| if c.is_alphanumeric() { c } else { '_' }).collect();
    format!("{plain}_").replace("__", "_")
}

/// The modules that files define, by their paths: those beside the shader, and those in the folders given.
fn modules(path: Option<&Path>, folders: &[PathBuf]) -> Result<HashMap<String, PathBuf>> {
    let mut found = HashMap::new();
    let mut count = 0;
    let beside =
        path.map(|path| path.parent().filter(|dir| !dir.as_os_str().is_empty()).unwrap_or(Path::new(".")));
    let mut next: Vec<_> = folders.iter().map(|folder| (folder.clone(), true)).collect();
    next.extend(beside.map(|folder| (folder.to_path_buf(), false)));
    while let Some((folder, deep)) = next.pop() {
        let entries = std::fs::read_dir(&folder).map_err(Error::io("read", &folder))?;
        let mut paths: Vec<_> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
        paths.sort();
        for path in paths {
            if path.is_dir() && deep && !path.is_symlink() {
                next.push((path, true));
            } else if path.extension().is_some_and(|extension| extension == "wgsl") {
                count += 1;
                if count > MOST_FILES {
                    return Err(Error::input(format!(
                        "{}: there are more than {MOST_FILES} shaders",
                        folder.display()
                    )));
                }
                let text = std::fs::read_to_string(&path).unwrap_or_default();
                let line = text.lines().find_map(|line| line.trim().strip_prefix("#define_import_path"));
                if let Some(module) = line {
                    found.insert(module.trim().trim_end_matches(';').to_owned(), path.clone());
                }
            }
        }
    }
    Ok(found)
}

/// What the names in one file mean.
struct Resolver<'a> {
    prefix: String,
    own: HashSet<String>,
    /// What an imported name stands for, as a whole path.
    aliases: HashMap<String, String>,
    modules: &'a HashMap<String, PathBuf>,
    /// The path of the user's own file, whose names stay.
    main: &'a str,
}

/// An imported item: its module, if it is there; what the user wrote; its plain name.
type Wanted = (Option<String>, String, String);

impl<'a> Resolver<'a> {
    fn new(
        unit: &Unit,
        main: &'a str,
        prefix: String,
        own: HashSet<String>,
        modules: &'a HashMap<String, PathBuf>,
    ) -> Self {
        let mut aliases = HashMap::new();
        for import in &unit.imports {
            let words = words(import);
            import_list(&words, "", &mut aliases, 0);
        }
        Self { prefix, own, aliases, modules, main }
    }

    /// Replaces paths and imported names by plain ones.
    fn rename(&self, text: &str) -> (String, Vec<Wanted>) {
        let mut out = String::with_capacity(text.len());
        let mut wanted = Vec::new();
        let words = words(text);
        // Members of structures keep their names.
        let members: HashSet<_> = members(&words);
        let (mut at, mut k) = (0, 0);
        while k < words.len() {
            let word = words[k];
            let start = k;
            k += 1;
            if !word.is_name() || members.contains(&start) || (start > 0 && words[start - 1].is(".")) {
                continue;
            }
            let mut path = self.aliases.get(word.text).cloned().unwrap_or(word.text.to_owned());
            while words.get(k).is_some_and(|w| w.is("::")) && words.get(k + 1).is_some_and(Token::is_name) {
                path += "::";
                path += words[k + 1].text;
                k += 2;
            }
            let plain = match path.rsplit_once("::") {
                None if self.own.contains(word.text) => format!("{}{}", self.prefix, word.text),
                None => continue,
                Some((module, item)) if self.main == module => item.to_owned(),
                Some((module, item)) => {
                    let plain = format!("{}{item}", prefix_of(module));
                    let there = self.modules.contains_key(module).then(|| module.to_owned());
                    wanted.push((there, path.clone(), plain.clone()));
                    plain
                }
            };
            out += &text[at..word.start];
            out += &plain;
            at = words[k - 1].end();
        }
        (out + &text[at..], wanted)
    }
}

/// The words that name members, in the declarations of structures.
fn members(words: &[Token]) -> HashSet<usize> {
    let mut found = HashSet::new();
    let mut inside = false;
    for (k, word) in words.iter().enumerate() {
        match word.text {
            "struct" => inside = true,
            "}" => inside = false,
            _ if inside && word.is_name() && words.get(k + 1).is_some_and(|next| next.is(":")) => {
                found.insert(k);
            }
            _ => {}
        }
    }
    found
}

/// Reads `a::b::{c, d as e}, f`, and returns how many words it took.
fn import_list(words: &[Token], prefix: &str, aliases: &mut HashMap<String, String>, depth: usize) -> usize {
    let mut k = 0;
    let mut path = prefix.to_owned();
    let mut alias = None;
    let finish = |path: &mut String, alias: &mut Option<String>, aliases: &mut HashMap<_, _>| {
        let last = path.rsplit("::").next().unwrap_or("").to_owned();
        let name = alias.take().unwrap_or(last);
        if !name.is_empty() && path.as_str() != prefix {
            aliases.insert(name, path.clone());
        }
        *path = prefix.to_owned();
    };
    while let Some(word) = words.get(k) {
        k += 1;
        match word.text {
            "{" if depth < 16 => {
                k += import_list(&words[k..], &path, aliases, depth + 1);
                path = prefix.to_owned();
            }
            "}" => break,
            "," => finish(&mut path, &mut alias, aliases),
            "as" => {
                alias = words.get(k).map(|word| word.text.to_owned());
                k += 1;
            }
            "::" | "\"" => {}
            text => {
                if !path.is_empty() {
                    path += "::";
                }
                path += text;
            }
        }
    }
    finish(&mut path, &mut alias, aliases);
    k
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_of_imports_are_read() {
        let mut aliases = HashMap::new();
        import_list(&words("a::b::{c, d as e, f::{g, h}}, x::y as z, w"), "", &mut aliases, 0);
        let mut all: Vec<_> = aliases.iter().map(|(name, path)| format!("{name}={path}")).collect();
        all.sort();
        assert_eq!(all, ["c=a::b::c", "e=a::b::d", "g=a::b::f::g", "h=a::b::f::h", "w=w", "z=x::y"]);
    }

    #[test]
    fn modules_become_plain_names() {
        let dir = tempfile::tempdir().unwrap();
        let module = "#define_import_path engine::math\nconst PI = 3.14;\nstruct S { PI: f32 }\nfn half(s: S) -> f32 { return s.PI * PI; }\n";
        std::fs::write(dir.path().join("math.wgsl"), module).unwrap();
        let main = "#import engine::math::{PI, half as h}\n#import engine::math\n#import engine::none::x\nfn f(a: vec3f) -> f32 { return PI + h(math::S(1.0)) + x(); }\n";
        let folders = [dir.path().to_path_buf()];
        let joined = join("main.wgsl", main, None, ShaderLanguage::Wgsl, &folders, &[]).unwrap();
        let text = joined.text.joined();
        let call = "return engine_math_PI + engine_math_half(engine_math_S(1.0)) + engine_none_x();";
        assert!(text.contains(call), "{text}");
        assert!(
            text.contains("struct engine_math_S { PI: f32 }")
                && text.contains("return s.PI * engine_math_PI"),
            "{text}"
        );
        assert_eq!(joined.missing.keys().collect::<Vec<_>>(), ["engine_none_x"]);
        let offset = text.find("const").unwrap();
        assert!(joined.text.place(offset).ends_with("math.wgsl:2"), "{}", joined.text.place(offset));
    }
}
