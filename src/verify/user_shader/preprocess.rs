//! The preprocessor of engines: `#define`, `#if`, `#include`, and the imports of naga_oil, which it collects.
//!
//! A line that is removed becomes blank, so that all lines stay where they are.

use super::source::{self, ShaderLanguage};
use super::text::SourceLine;
use super::token::{Token, TokenKind, tokens, without_comments, words};
use crate::base::error::{Error, Result};
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

/// A macro: its parameters, if it takes some, and what it stands for.
#[derive(Debug, Clone)]
struct Macro {
    parameters: Option<Vec<String>>,
    body: String,
}

/// A file after preprocessing.
#[derive(Debug, Default)]
pub(super) struct Unit {
    pub lines: Vec<SourceLine>,
    /// What follows `#import`.
    pub imports: Vec<String>,
    /// The module's path, by `#define_import_path`.
    pub path: Option<String>,
}

/// State while files include each other.
pub(super) struct Preprocessor<'a> {
    folders: &'a [PathBuf],
    language: ShaderLanguage,
    macros: HashMap<String, Macro>,
    /// Names of all files so far, as in [`super::text::ShaderText::files`].
    pub files: Vec<String>,
    once: HashSet<PathBuf>,
    depth: usize,
    /// Characters that macros have made.
    expanded: usize,
}

/// How deep files may include each other.
const DEEPEST: usize = 64;
/// Characters that macros may make.
const LONGEST: usize = 1 << 20;

/// One `#if`, inside which lines may count.
struct Condition {
    /// Whether its lines count now.
    active: bool,
    /// Whether a branch has counted.
    done: bool,
    /// Whether the lines around it count.
    outer: bool,
}

impl<'a> Preprocessor<'a> {
    /// A preprocessor of the file `name`, which is the first of its files.
    pub fn new(
        name: &str,
        language: ShaderLanguage,
        folders: &'a [PathBuf],
        defines: &[(String, String)],
    ) -> Self {
        let define =
            |(name, body): &(String, String)| (name.clone(), Macro { parameters: None, body: body.clone() });
        Self {
            folders,
            language,
            macros: defines.iter().map(define).collect(),
            files: vec![name.into()],
            once: HashSet::new(),
            depth: 0,
            expanded: 0,
        }
    }

    /// Preprocesses the file's text; `path` is where it lies, if it is a file. `before` are put before it.
    pub fn run(&mut self, text: &str, path: Option<&Path>, before: &[PathBuf]) -> Result<Unit> {
        let mut unit = Unit::default();
        for path in before {
            let name = path.display().to_string();
            self.files.push(name);
            self.file(self.files.len() - 1, &source::read(path)?, Some(path), &mut unit)?;
        }
        self.file(0, text, path, &mut unit)?;
        Ok(unit)
    }

    /// Whether the condition of an `#if` holds.
    pub fn condition(&self, text: &str) -> Result<bool> {
        self.holds("if", text)
    }

    fn file(&mut self, file: usize, text: &str, path: Option<&Path>, unit: &mut Unit) -> Result<()> {
        let name = self.files[file].clone();
        if self.depth == DEEPEST {
            return Err(Error::input(format!("{name} includes itself")));
        }
        self.depth += 1;
        let text = without_comments(text, self.language == ShaderLanguage::Wgsl);
        let lines: Vec<&str> = text.lines().collect();
        let mut conditions = Vec::<Condition>::new();
        let mut number = 0;
        while number < lines.len() {
            let first = number;
            let mut line = lines[number].to_owned();
            let is_directive = line.trim_start().starts_with('#') && !line.trim_start().starts_with("#{");
            if is_directive {
                // What goes on in the next line, by `\` or in the braces of an import.
                while let Some(start) = unfinished(&line).filter(|_| number + 1 < lines.len()) {
                    number += 1;
                    line.truncate(start);
                    line.push(' ');
                    line += lines[number];
                }
                let is_active = conditions.last().is_none_or(|condition| condition.active);
                let place = format!("{name}:{}", first + 1);
                self.directive(line.trim(), is_active, &mut conditions, path, unit)
                    .map_err(|e| e.at(place))?;
                line.clear();
            } else if conditions.last().is_some_and(|condition| !condition.active) {
                line.clear();
            } else {
                // The arguments of a macro may take several lines.
                while self.is_open(&line) && number + 1 < lines.len() {
                    number += 1;
                    line.push(' ');
                    line += lines[number];
                }
                let mut busy = Vec::new();
                line = self.expand(&line, &mut busy).map_err(|e| e.at(format!("{name}:{}", first + 1)))?;
            }
            unit.lines.push(SourceLine { file, number: first, text: line });
            for number in first + 1..=number {
                unit.lines.push(SourceLine { file, number, text: String::new() });
            }
            number += 1;
        }
        if !conditions.is_empty() {
            return Err(Error::input(format!("{name}: an #if has no #endif")));
        }
        self.depth -= 1;
        Ok(())
    }

    /// Carries out one directive.
    fn directive(
        &mut self,
        line: &str,
        is_active: bool,
        conditions: &mut Vec<Condition>,
        path: Option<&Path>,
        unit: &mut Unit,
    ) -> Result<()> {
        let body = line[1..].trim_start();
        let end = body.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(body.len());
        let (word, rest) = (&body[..end], body[end..].trim());
        match word {
            "if" | "ifdef" | "ifndef" => {
                let holds = is_active && self.holds(word, rest)?;
                conditions.push(Condition { active: holds, done: holds, outer: is_active });
            }
            "else" | "elif" => {
                let condition =
                    conditions.last().ok_or_else(|| Error::input(format!("#{word} without #if")))?;
                let (outer, done) = (condition.outer, condition.done);
                // naga_oil writes `#else ifdef X`.
                let (word, rest) = match rest.split_once(char::is_whitespace) {
                    _ if word == "elif" => ("if", rest),
                    Some((word, rest)) => (word, rest),
                    None => ("", ""),
                };
                let holds = outer && !done && (word.is_empty() || self.holds(word, rest)?);
                if let Some(condition) = conditions.last_mut() {
                    condition.active = holds;
                    condition.done |= holds;
                }
            }
            "endif" => {
                conditions.pop().ok_or_else(|| Error::input("#endif without #if"))?;
            }
            _ if !is_active => {}
            "define" => self.define(rest)?,
            "undef" => {
                self.macros.remove(rest);
            }
            "include" => {
                let name = rest.trim_matches(|c| "\"<> ".contains(c));
                self.include(name, path.and_then(Path::parent), unit)?;
            }
            "import" => {
                // WESL and others import a file by its name.
                unit.imports.push(rest.trim_end_matches(';').to_owned());
            }
            "define_import_path" => unit.path = Some(rest.trim_end_matches(';').trim().to_owned()),
            "pragma" if rest == "once" => {
                self.once.extend(path.and_then(|path| path.canonicalize().ok()));
            }
            "pragma" | "version" | "extension" | "line" | "" => {}
            "error" => return Err(Error::input(format!("#error {rest}"))),
            _ => {
                return Err(Error::input(format!(
                    "#{word} is no directive; there are #define, #undef, #if, #ifdef, #ifndef, #elif, #else, #endif, \
                     #include, #import and #define_import_path"
                )));
            }
        }
        Ok(())
    }

    fn include(&mut self, name: &str, beside: Option<&Path>, unit: &mut Unit) -> Result<()> {
        let path = source::find(name, beside, self.folders).ok_or_else(|| {
            Error::input(format!("{name} is not there; give its folder as an include folder"))
        })?;
        if path.canonicalize().is_ok_and(|path| self.once.contains(&path)) {
            return Ok(());
        }
        let text = source::read(&path)?;
        self.files.push(path.display().to_string());
        self.file(self.files.len() - 1, &text, Some(&path), unit)
    }

    fn define(&mut self, text: &str) -> Result<()> {
        let words = tokens(text);
        let name = words.first().filter(|word| word.is_name());
        let name = name.ok_or_else(|| Error::input(format!("#define {text}: give a name")))?;
        let rest = &text[name.end()..];
        let parameters = rest.strip_prefix('(').and_then(|rest| rest.split_once(')'));
        let (parameters, body) = match parameters {
            Some((names, body)) => {
                let names = names.split(',').map(str::trim).filter(|name| !name.is_empty());
                (Some(names.map(str::to_owned).collect()), body)
            }
            None => (None, rest),
        };
        self.macros.insert(name.text.into(), Macro { parameters, body: body.trim().into() });
        Ok(())
    }

    /// Whether a condition holds.
    fn holds(&self, word: &str, rest: &str) -> Result<bool> {
        match word {
            "ifdef" => Ok(self.macros.contains_key(rest)),
            "ifndef" => Ok(!self.macros.contains_key(rest)),
            "if" => {
                let words: Vec<_> = words(rest).into_iter().map(|word| word.text).collect();
                let mut reader = ConditionReader { words: &words, at: 0, macros: &self.macros, depth: 0 };
                let value = reader.binary(0)?;
                match reader.at == words.len() {
                    true => Ok(value != 0),
                    false => {
                        Err(Error::input(format!("#if {rest}: \"{}\" is not expected", words[reader.at])))
                    }
                }
            }
            _ => Err(Error::input(format!("#else {word} is no condition"))),
        }
    }

    /// Whether a macro's arguments go on in the next line.
    fn is_open(&self, line: &str) -> bool {
        if self.macros.is_empty() {
            return false;
        }
        let words = words(line);
        let call = words.iter().position(|word| {
            word.is_name() && self.macros.get(word.text).is_some_and(|found| found.parameters.is_some())
        });
        let Some(call) = call.filter(|&call| words.get(call + 1).is_some_and(|word| word.is("("))) else {
            return false;
        };
        let depth = |text| words[call..].iter().filter(|word| word.is(text)).count();
        depth("(") > depth(")")
    }

    /// Puts what macros stand for in their places. `busy` are those that are being expanded.
    fn expand(&mut self, text: &str, busy: &mut Vec<String>) -> Result<String> {
        if self.macros.is_empty() && !text.contains("#{") {
            return Ok(text.to_owned());
        }
        let text = self.substitute(text);
        let tokens = tokens(&text);
        let mut out = String::new();
        let mut k = 0;
        while let Some(token) = tokens.get(k) {
            k += 1;
            let found = self.macros.get(token.text).filter(|_| token.is_name()).cloned();
            let Some(found) = found.filter(|_| !busy.iter().any(|name| name == token.text)) else {
                out += token.text;
                continue;
            };
            let body = match &found.parameters {
                None => found.body,
                Some(parameters) => {
                    let Some((arguments, length)) = arguments(&tokens[k..]) else {
                        out += token.text;
                        continue;
                    };
                    k += length;
                    let mut expanded = Vec::new();
                    for argument in &arguments {
                        expanded.push(self.expand(argument, busy)?);
                    }
                    let put = |token: &Token| match parameters.iter().position(|name| name == token.text) {
                        Some(place) if token.is_name() => expanded.get(place).cloned().unwrap_or_default(),
                        _ => token.text.to_owned(),
                    };
                    super::token::tokens(&found.body).iter().map(put).collect()
                }
            };
            self.expanded += body.len();
            if self.expanded > LONGEST || busy.len() == DEEPEST {
                return Err(Error::input(format!("the macro {} makes too much text", token.text)));
            }
            busy.push(token.text.to_owned());
            out += &self.expand(&body, busy)?;
            busy.pop();
        }
        Ok(out)
    }

    /// Puts values in the place of naga_oil's `#{NAME}`.
    fn substitute(&self, text: &str) -> String {
        let mut out = String::new();
        let mut rest = text;
        while let Some((before, after)) = rest.split_once("#{") {
            let Some((name, after)) = after.split_once('}') else { break };
            out += before;
            out += self.macros.get(name.trim()).map_or("", |found| &found.body);
            rest = after;
        }
        out + rest
    }
}

/// Where a directive is cut that goes on in the next line.
fn unfinished(line: &str) -> Option<usize> {
    let end = line.trim_end();
    if end.ends_with('\\') {
        return Some(end.len() - 1);
    }
    let is_import = line.trim_start()[1..].trim_start().starts_with("import ");
    let count = |mark| line.matches(mark).count();
    (is_import && (count('{') > count('}') || end.ends_with([',', ':']))).then_some(line.len())
}

/// A macro's arguments, if the next word opens them, and how many tokens they take.
fn arguments(tokens: &[Token]) -> Option<(Vec<String>, usize)> {
    let open = tokens.iter().position(|token| token.kind != TokenKind::Space)?;
    if !tokens[open].is("(") {
        return None;
    }
    let mut arguments = vec![String::new()];
    let mut depth = 0_usize;
    for (k, token) in tokens.iter().enumerate().skip(open) {
        match token.text {
            "(" | "[" => depth += 1,
            ")" | "]" => depth = depth.saturating_sub(1),
            "," if depth == 1 => {
                arguments.push(String::new());
                continue;
            }
            _ => {}
        }
        if depth == 0 {
            return Some((arguments.iter().map(|text| text.trim().to_owned()).collect(), k + 1));
        }
        if !(depth == 1 && k == open) {
            arguments.last_mut()?.push_str(token.text);
        }
    }
    None
}

/// Evaluates the condition of an `#if`, in whole numbers.
struct ConditionReader<'a> {
    words: &'a [&'a str],
    at: usize,
    macros: &'a HashMap<String, Macro>,
    depth: usize,
}

/// Operators of an `#if`, by what binds less.
const OPERATORS: [(&str, usize); 11] = [
    ("||", 0),
    ("&&", 1),
    ("==", 2),
    ("!=", 2),
    ("<=", 3),
    (">=", 3),
    ("<", 3),
    (">", 3),
    ("+", 4),
    ("-", 4),
    ("*", 5),
];

impl ConditionReader<'_> {
    fn operator(&self) -> Option<(&'static str, usize, usize)> {
        let [first, second] = [0, 1].map(|k| self.words.get(self.at + k).copied().unwrap_or(""));
        let both = format!("{first}{second}");
        let found = OPERATORS.iter().find(|(text, _)| *text == both || *text == first)?;
        Some((found.0, found.1, found.0.len()))
    }

    fn binary(&mut self, least: usize) -> Result<i64> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(Error::input("the condition is nested too deep"));
        }
        let mut left = self.unary()?;
        while let Some((operator, binds, length)) = self.operator().filter(|&(_, binds, _)| binds >= least) {
            self.at += length;
            let right = self.binary(binds + 1)?;
            left = match operator {
                "||" => i64::from(left != 0 || right != 0),
                "&&" => i64::from(left != 0 && right != 0),
                "==" => i64::from(left == right),
                "!=" => i64::from(left != right),
                "<=" => i64::from(left <= right),
                ">=" => i64::from(left >= right),
                "<" => i64::from(left < right),
                ">" => i64::from(left > right),
                "+" => left.wrapping_add(right),
                "-" => left.wrapping_sub(right),
                _ => left.wrapping_mul(right),
            };
        }
        self.depth -= 1;
        Ok(left)
    }

    fn unary(&mut self) -> Result<i64> {
        let word =
            *self.words.get(self.at).ok_or_else(|| Error::input("the condition of #if is not whole"))?;
        self.at += 1;
        match word {
            "!" | "-" => {
                self.depth += 1;
                if self.depth > DEEPEST {
                    return Err(Error::input("the condition is nested too deep"));
                }
                let value = self.unary()?;
                self.depth -= 1;
                Ok(if word == "!" { i64::from(value == 0) } else { value.wrapping_neg() })
            }
            "(" => {
                let value = self.binary(0)?;
                self.close()?;
                Ok(value)
            }
            "defined" => {
                let open = self.words.get(self.at) == Some(&"(");
                self.at += usize::from(open);
                let name = self.words.get(self.at).copied().unwrap_or("");
                self.at += 1;
                if open {
                    self.close()?;
                }
                Ok(i64::from(self.macros.contains_key(name)))
            }
            "true" => Ok(1),
            "false" => Ok(0),
            _ => self.number(word, 0),
        }
    }

    fn close(&mut self) -> Result<()> {
        self.at += 1;
        match self.words.get(self.at - 1) == Some(&")") {
            true => Ok(()),
            false => Err(Error::input("the condition of #if lacks a )")),
        }
    }

    /// The value of a number, or of a macro that stands for one; 0 of a name that nothing defines, as in C.
    fn number(&self, word: &str, depth: usize) -> Result<i64> {
        if let Ok(value) = word.trim_end_matches(['u', 'i']).parse() {
            return Ok(value);
        }
        match (word, self.macros.get(word)) {
            ("true", _) => Ok(1),
            ("false" | "", _) => Ok(0),
            (_, Some(found)) if depth < DEEPEST => self.number(&found.body, depth + 1),
            (_, None) if word.starts_with(|c: char| c == '_' || c.is_alphabetic()) => Ok(0),
            _ => Err(Error::input(format!("\"{word}\" is no whole number, as #if needs"))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(text: &str) -> Result<String> {
        let defines = [("SET".to_owned(), "2".to_owned())];
        let mut preprocessor = Preprocessor::new("a.wgsl", ShaderLanguage::Wgsl, &[], &defines);
        let unit = preprocessor.run(text, None, &[])?;
        Ok(unit.lines.iter().map(|line| line.text.clone() + "\n").collect())
    }

    #[test]
    fn lines_stay_where_they_are() {
        let text =
            "#define PI 3.14 // half a turn\n#ifdef SET\nx = PI;\n#else\nno\n#endif\ny = api.PI2 + #{SET};\n";
        assert_eq!(run(text).unwrap(), "\n\nx = 3.14;\n\n\n\ny = api.PI2 + 2;\n");
    }

    #[test]
    fn conditions_follow_c_and_naga_oil() {
        for (condition, holds) in [
            ("#if SET == 2", true),
            ("#if SET > 2 || !defined(OTHER)", true),
            ("#if defined OTHER && SET", false),
            ("#if (1 + 2) * SET == 6", true),
            ("#if OTHER == true", false),
            ("#ifndef OTHER", true),
            ("#ifdef OTHER\n#else ifdef SET", true),
            ("#if 0\n#elif SET >= 2", true),
        ] {
            let text = run(&format!("{condition}\nyes\n#else\nno\n#endif")).unwrap();
            assert_eq!(text.contains("yes"), holds, "{condition}");
            assert_eq!(text.contains("no"), !holds, "{condition}");
        }
    }

    #[test]
    fn macros_take_arguments() {
        let text = "#define saturate(a) clamp(a, 0.0, 1.0)\n#define TWICE(x, y) \\\n (x + y)\nsaturate(max(a, b)) TWICE(1,\n SET) saturate";
        let out = run(text).unwrap();
        assert_eq!(out, "\n\n\nclamp(max(a, b), 0.0, 1.0) (1 + 2) saturate\n\n");
        assert_eq!(run("#define A B\n#define B A\nA").unwrap(), "\n\nA\n");
    }

    #[test]
    fn faults_name_their_line() {
        for (text, words) in [
            ("\n#if SET == ", "a.wgsl:2"),
            ("#else", "#else without #if"),
            ("#if 1", "no #endif"),
            ("#include \"none\"", "include folder"),
            ("#unknown", "no directive"),
            ("#error why", "#error why"),
            ("#if ((((1", "lacks a )"),
        ] {
            let error = run(text).unwrap_err().to_string();
            assert!(error.contains(words), "{text}: {error}");
        }
    }

    #[test]
    fn macros_do_not_explode() {
        let mut text = String::from("#define A0 aaaaaaaaaaaaaaaa\n");
        for k in 0..40 {
            text += &format!("#define A{} A{k} A{k}\n", k + 1);
        }
        assert!(run(&(text + "A40")).unwrap_err().to_string().contains("too much text"));
    }
}
