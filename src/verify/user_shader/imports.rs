//! Joins a shader with the modules that it imports, as naga_oil and WESL name them:
//! `#import bevy_pbr::lighting::F_Schlick`, `import package::lighting::F_Schlick;`.
//!
//! Names of modules become plain ones, `bevy_pbr_lighting_F_Schlick`. The user's own names stay. A module that is not
//! there is no fault until the function that is checked reaches it.

use super::conditional;
use super::items::{Item, ItemKind, items, pruned};
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
    includes: &[PathBuf],
    defines: &[(String, String)],
) -> Result<Joined> {
    let (before, folders): (Vec<_>, Vec<_>) = includes.iter().cloned().partition(|path| path.is_file());
    let mut preprocessor = Preprocessor::new(name, language, &folders, defines);
    let mut main = preprocessor.run(source, path, &before)?;
    let mut files = preprocessor.files.clone();
    if language == ShaderLanguage::Glsl {
        let text = ShaderText { files, lines: main.lines };
        return Ok(Joined { text, missing: BTreeMap::new() });
    }
    wesl(&mut main, &files, &preprocessor)?;
    if main.imports.is_empty() && !main.lines.iter().any(|line| line.text.contains("::")) {
        let text = ShaderText { files, lines: main.lines };
        return Ok(Joined { text, missing: BTreeMap::new() });
    }

    let modules = Modules::new(path, &folders)?;
    let mut lines = Vec::new();
    let mut missing = BTreeMap::new();
    // The user's file has no prefix, wherever it says that it belongs.
    let own_path = main.path.clone().unwrap_or_default();
    let mut known = HashSet::from([own_path.clone()]);
    let mut next = vec![(main, own_path.clone(), String::new())];
    while let Some((mut unit, module, prefix)) = next.pop() {
        let text = ShaderText { files: files.clone(), lines: std::mem::take(&mut unit.lines) };
        let joined = text.joined();
        let items = items(&joined, language);
        let own = items
            .into_iter()
            .filter(|item| item.kind != ItemKind::Directive)
            .flat_map(|item| item.names)
            .collect();
        let resolver = Resolver::new(&unit, &own_path, &module, prefix, own);
        let (renamed, wanted) = resolver.rename(&joined);
        for Wanted { module, written, plain } in wanted {
            let Some(file) = modules.find(&module) else {
                missing.insert(plain, written);
                continue;
            };
            if !known.insert(module.clone()) {
                continue;
            }
            let mut preprocessor =
                Preprocessor::new(&file.display().to_string(), language, &folders, defines);
            let mut unit = preprocessor.run(&source::read(&file)?, Some(&file), &[])?;
            wesl(&mut unit, &preprocessor.files, &preprocessor)?;
            unit.lines.iter_mut().for_each(|line| line.file += files.len());
            files.append(&mut preprocessor.files);
            let prefix = prefix_of(&module);
            next.push((unit, module, prefix));
        }
        lines.extend(hoisted(text.with_text(&renamed).lines, lines.is_empty()));
    }
    // Directives of modules must stand first.
    let (directives, lines): (Vec<_>, Vec<_>) = lines.into_iter().partition(|(_, first)| *first);
    let lines = directives.into_iter().chain(lines).map(|(line, _)| line).collect();
    Ok(Joined { text: ShaderText { files, lines }, missing })
}

/// Carries out the conditions of WESL and collects its imports.
fn wesl(unit: &mut Unit, files: &[String], preprocessor: &Preprocessor) -> Result<()> {
    let text = ShaderText { files: files.to_vec(), lines: std::mem::take(&mut unit.lines) };
    let translated = conditional::translated(&text.joined(), |condition| preprocessor.condition(condition))?;
    let items = items(&translated, ShaderLanguage::Wgsl);
    let is_import = |item: &Item| {
        item.kind == ItemKind::Directive && translated[item.range.clone()].starts_with("import")
    };
    let kept: Vec<_> = items.iter().map(|item| !is_import(item)).collect();
    for item in items.iter().filter(|item| is_import(item)) {
        unit.imports.push(translated[item.range.clone()]["import".len()..].trim_end_matches(';').to_owned());
    }
    unit.lines = text.with_text(&pruned(&translated, &items, &kept)).lines;
    Ok(())
}

/// Marks the lines of a module that must stand first.
fn hoisted(lines: Vec<SourceLine>, is_main: bool) -> impl Iterator<Item = (SourceLine, bool)> {
    lines.into_iter().map(move |line| {
        let first =
            !is_main && ["enable ", "requires "].iter().any(|word| line.text.trim_start().starts_with(word));
        (line, first)
    })
}

/// The plain prefix of a module's names.
fn prefix_of(module: &str) -> String {
    let plain: String = module.chars().map(|c| if c.is_alphanumeric() { c } else { '_' }).collect();
    format!("{plain}_").replace("__", "_")
}

/// The files of modules.
struct Modules<'a> {
    /// By the paths that files of naga_oil define: files beside the shader, and in the folders given.
    defined: HashMap<String, PathBuf>,
    /// The folder of the shader.
    beside: Option<PathBuf>,
    folders: &'a [PathBuf],
}

impl<'a> Modules<'a> {
    fn new(path: Option<&Path>, folders: &'a [PathBuf]) -> Result<Self> {
        let beside = path.and_then(|path| path.canonicalize().ok()?.parent().map(Path::to_path_buf));
        let mut defined = HashMap::new();
        let mut count = 0;
        let mut next: Vec<_> = folders.iter().map(|folder| (folder.clone(), true)).collect();
        next.extend(beside.iter().map(|folder| (folder.clone(), false)));
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
                        let folder = folder.display();
                        return Err(Error::input(format!(
                            "{folder}: there are more than {MOST_FILES} shaders"
                        )));
                    }
                    let text = std::fs::read_to_string(&path).unwrap_or_default();
                    let line = text.lines().find_map(|line| line.trim().strip_prefix("#define_import_path"));
                    if let Some(module) = line {
                        defined.insert(module.trim().trim_end_matches(';').to_owned(), path.clone());
                    }
                }
            }
        }
        Ok(Self { defined, beside, folders })
    }

    /// The file of a module. The folders of a WESL path are those of its package: the shader's own is the nearest around
    /// it in which the file is, another one is a folder of its name, or what is in its `src`.
    fn find(&self, module: &str) -> Option<PathBuf> {
        if let Some(path) = self.defined.get(module) {
            return Some(path.clone());
        }
        let (package, rest) = module.split_once("::")?;
        let inside = rest.replace("::", "/");
        let roots: Vec<PathBuf> = match package {
            "package" => self.beside.as_deref()?.ancestors().map(Path::to_path_buf).collect(),
            _ => self.folders.iter().flat_map(|folder| packages(folder, package)).collect(),
        };
        let mut files = roots
            .iter()
            .flat_map(|root| ["wesl", "wgsl"].map(|ending| root.join(format!("{inside}.{ending}"))));
        files.find(|path| path.is_file())
    }
}

/// Where the modules of a package can be, in a folder that has it or is it, with or without its version.
fn packages(folder: &Path, package: &str) -> Vec<PathBuf> {
    let is_it = |path: &Path| {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        name.strip_prefix(package).is_some_and(|rest| rest.is_empty() || rest.starts_with("-"))
    };
    let mut found = Vec::new();
    if is_it(&folder.canonicalize().unwrap_or_default()) {
        found.push(folder.to_path_buf());
    }
    let entries = std::fs::read_dir(folder).into_iter().flatten();
    let mut inside: Vec<_> =
        entries.filter_map(|entry| Some(entry.ok()?.path())).filter(|path| is_it(path)).collect();
    inside.sort();
    found.extend(inside);
    found.iter().flat_map(|root| [root.clone(), root.join("src"), root.join("src/shaders")]).collect()
}

/// What the names in one file mean.
struct Resolver<'a> {
    prefix: String,
    own: HashSet<String>,
    /// What an imported name stands for, as a whole path.
    aliases: HashMap<String, String>,
    /// The path of the user's own file, whose names stay.
    main: &'a str,
    /// The path of this file.
    module: &'a str,
}

/// An imported item.
struct Wanted {
    module: String,
    written: String,
    plain: String,
}

impl<'a> Resolver<'a> {
    fn new(unit: &Unit, main: &'a str, module: &'a str, prefix: String, own: HashSet<String>) -> Self {
        let mut aliases = HashMap::new();
        for import in &unit.imports {
            import_list(&words(import), "", &mut aliases, 0);
        }
        Self { prefix, own, aliases, main, module }
    }

    /// A path of WESL from the root of a package: `package` is this file's, `super` the folder around it.
    fn absolute(&self, path: String) -> String {
        let package = self.module.split("::").next().filter(|package| !package.is_empty());
        if let (Some(rest), Some(package)) = (path.strip_prefix("package::"), package) {
            return format!("{package}::{rest}");
        }
        match (path.strip_prefix("super::"), self.module.rsplit_once("::")) {
            (Some(rest), Some((around, _))) => format!("{around}::{rest}"),
            (Some(rest), None) => format!("package::{rest}"),
            _ => path,
        }
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
            let path = self.absolute(path);
            let plain = match path.rsplit_once("::") {
                None if self.own.contains(word.text) => format!("{}{}", self.prefix, word.text),
                None => continue,
                Some((module, item)) if self.main == module => item.to_owned(),
                Some((module, item)) => {
                    let plain = format!("{}{item}", prefix_of(module));
                    wanted.push(Wanted {
                        module: module.into(),
                        written: path.clone(),
                        plain: plain.clone(),
                    });
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
