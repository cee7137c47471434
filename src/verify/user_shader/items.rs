//! The declarations of a shader, and what is left of them when only one function is wanted.
//!
//! Only what a function reaches has to be valid, to be imported and to be bound; the rest becomes blank, so that
//! lines and columns stay.

use super::source::ShaderLanguage;
use super::token::{Token, words};
use std::collections::{HashMap, HashSet};
use std::ops::Range;

/// A declaration of module scope.
#[derive(Debug, Clone)]
pub(super) struct Item {
    pub kind: ItemKind,
    /// What it declares; none where it is a directive.
    pub names: Vec<String>,
    /// The names that it mentions, other than members.
    pub uses: HashSet<String>,
    /// Bytes of the text.
    pub range: Range<usize>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ItemKind {
    Function,
    /// A stage of a pipeline.
    EntryPoint,
    /// A variable that the program fills: a binding, an input, a constant without a value.
    Bound,
    /// `enable` and the like, which stay.
    Directive,
    Other,
}

/// Splits a text, preprocessed and without comments, into its declarations.
pub(super) fn items(text: &str, language: ShaderLanguage) -> Vec<Item> {
    let words = words(text);
    let mut all = Vec::new();
    let mut first = 0;
    while first < words.len() {
        let end = end(&words[first..], language) + first;
        let item = match language {
            ShaderLanguage::Wgsl => wgsl(&words[first..end]),
            ShaderLanguage::Glsl => glsl(&words[first..end]),
        };
        let range = words[first].start..words[end - 1].end();
        let members = |k: usize| k > 0 && words[k - 1].is(".");
        let uses = (first..end).filter(|&k| words[k].is_name() && !members(k));
        let uses = uses.map(|k| words[k].text.to_owned()).collect();
        all.push(Item { kind: item.0, names: item.1, uses, range });
        first = end;
    }
    all
}

/// The number of words of the first declaration.
fn end(words: &[Token], language: ShaderLanguage) -> usize {
    let mut depth = 0_usize;
    let mut assigned = false;
    // Whether a closing brace ends it.
    let mut braced = false;
    for (k, word) in words.iter().enumerate() {
        match word.text {
            "(" | "[" | "{" => {
                if depth == 0 && word.is("{") {
                    braced = match language {
                        ShaderLanguage::Wgsl => true,
                        ShaderLanguage::Glsl => !assigned && k > 0 && words[k - 1].is(")"),
                    };
                }
                depth += 1;
            }
            ")" | "]" | "}" => {
                depth = depth.saturating_sub(1);
                if depth == 0 && word.is("}") && braced {
                    return k + 1;
                }
            }
            "=" => assigned |= depth == 0,
            ";" if depth == 0 => return k + 1,
            _ => {}
        }
    }
    words.len()
}

/// The kind and the name of a WGSL declaration.
fn wgsl(words: &[Token]) -> (ItemKind, Vec<String>) {
    let mut stage = false;
    let mut bound = false;
    let mut k = 0;
    // Attributes, with what is in their parentheses.
    while words.get(k).is_some_and(|word| word.is("@")) {
        let name = words.get(k + 1).map_or("", |word| word.text);
        stage |= matches!(name, "compute" | "vertex" | "fragment");
        bound |= name == "binding";
        k += 2;
        if words.get(k).is_some_and(|word| word.is("(")) {
            k += closing(&words[k..]) + 1;
        }
    }
    let keyword = words.get(k).map_or("", |word| word.text);
    k += 1;
    if keyword == "var" && words.get(k).is_some_and(|word| word.is("<")) {
        k += words[k..].iter().position(|word| word.is(">")).map_or(0, |n| n + 1);
    }
    let name = words.get(k).filter(|word| word.is_name()).map(|word| word.text.to_owned());
    let kind = match keyword {
        "fn" if stage => ItemKind::EntryPoint,
        "fn" => ItemKind::Function,
        "var" if bound => ItemKind::Bound,
        "override" if !words.iter().any(|word| word.is("=")) => ItemKind::Bound,
        "enable" | "requires" | "diagnostic" | "import" => return (ItemKind::Directive, Vec::new()),
        "const_assert" => return (ItemKind::Other, Vec::new()),
        _ => ItemKind::Other,
    };
    (kind, name.into_iter().collect())
}

/// The kind and the names of a GLSL declaration.
fn glsl(words: &[Token]) -> (ItemKind, Vec<String>) {
    let mut k = 0;
    if words.len() > 1 && words[0].is("layout") && words[1].is("(") {
        k = 2 + closing(&words[1..]);
    }
    let words = &words[k.min(words.len())..];
    if words.first().is_some_and(|word| word.is("precision")) {
        return (ItemKind::Other, Vec::new());
    }
    let is_bound = words.iter().take(4).any(|word| {
        matches!(word.text, "uniform" | "varying" | "attribute" | "in" | "buffer" | "out")
            && word.start < brace(words)
    });
    let kind = if is_bound { ItemKind::Bound } else { ItemKind::Other };
    let open = words.iter().position(|word| matches!(word.text, "(" | "=" | "{"));
    if let Some(open) = open.filter(|&k| words[k].is("(") && k > 0) {
        let name = words[open - 1].text;
        let kind = if name == "main" { ItemKind::EntryPoint } else { ItemKind::Function };
        return (kind, vec![name.to_owned()]);
    }
    // Variables stand before `=`, `;`, `,` or `[`, structures and blocks before `{`.
    let mut names = Vec::new();
    let mut depth = 0_usize;
    let block = is_bound && words.iter().any(|word| word.is("{"));
    let has_instance = words.len() > 1 && !words[words.len() - 2].is("}");
    let mut value = false;
    for (k, pair) in words.windows(2).enumerate() {
        let ends =
            matches!(pair[1].text, "=" | ";" | ",") || (pair[1].is("[") && k > 0 && !words[k - 1].is("="));
        // `float[2] x` begins with a type.
        let is_type = pair[1].is("[") && !(k > 0 && (words[k - 1].is_name() || words[k - 1].is(",")));
        let member = block && !has_instance && depth == 1;
        let declares = (depth == 0 && (ends || pair[1].is("{"))) || (member && ends);
        if pair[0].is_name() && declares && !is_type && !value {
            names.push(pair[0].text.to_owned());
        }
        match pair[0].text {
            "{" | "(" | "[" => depth += 1,
            "}" | ")" | "]" => depth = depth.saturating_sub(1),
            "=" => value = true,
            "," | ";" if depth == 0 => value = false,
            _ => {}
        }
    }
    (kind, names)
}

fn brace(words: &[Token]) -> usize {
    words.iter().find(|word| matches!(word.text, "{" | "(")).map_or(usize::MAX, |word| word.start)
}

/// The index of the bracket that closes the first one.
pub(super) fn closing(words: &[Token]) -> usize {
    let mut depth = 0_usize;
    for (k, word) in words.iter().enumerate() {
        match word.text {
            "(" | "{" | "[" => depth += 1,
            ")" | "}" | "]" => {
                depth = depth.saturating_sub(1);
                if depth == 0 {
                    return k;
                }
            }
            _ => {}
        }
    }
    words.len().saturating_sub(1)
}

/// Which items a function needs, itself among them.
pub(super) fn reached(items: &[Item], entry: &str) -> Vec<bool> {
    let mut declared = HashMap::<&str, Vec<usize>>::new();
    for (k, item) in items.iter().enumerate().filter(|(_, item)| item.kind != ItemKind::EntryPoint) {
        item.names.iter().for_each(|name| declared.entry(name).or_default().push(k));
    }
    let mut reached: Vec<_> = items.iter().map(|item| item.kind == ItemKind::Directive).collect();
    let mut next = vec![entry];
    while let Some(name) = next.pop() {
        for &k in declared.get(name).into_iter().flatten() {
            if !std::mem::replace(&mut reached[k], true) {
                next.extend(items[k].uses.iter().map(String::as_str));
            }
        }
    }
    reached
}

/// The function at an offset, if it is kept and another one of its name is too.
pub(super) fn overload(items: &[Item], kept: &[bool], offset: usize) -> Option<usize> {
    let at = items.iter().position(|item| item.range.contains(&offset))?;
    let same =
        |k: &usize| kept[*k] && items[*k].kind == ItemKind::Function && items[*k].names == items[at].names;
    (same(&at) && (0..items.len()).filter(same).count() > 1).then_some(at)
}

/// Takes repetitions of a declaration out, as of a chunk that both stages of a pipeline include.
pub(super) fn without_repetitions(text: &str, items: &[Item], kept: &mut [bool]) {
    let mut seen = HashSet::new();
    for (item, kept) in items.iter().zip(kept) {
        let body: Vec<_> = text[item.range.clone()].split_whitespace().collect();
        *kept &= item.kind == ItemKind::Directive || !*kept || seen.insert(body);
    }
}

/// The text with spaces in place of what is not kept.
pub(super) fn pruned(text: &str, items: &[Item], kept: &[bool]) -> String {
    let mut out = String::with_capacity(text.len());
    let mut at = 0;
    for (item, _) in items.iter().zip(kept).filter(|(_, kept)| !**kept) {
        out += &text[at..item.range.start];
        out.extend(text[item.range.clone()].chars().map(|c| if c == '\n' { '\n' } else { ' ' }));
        at = item.range.end;
    }
    out + &text[at..]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(text: &str, language: ShaderLanguage, entry: &str) -> Vec<String> {
        let items = items(text, language);
        let reached = reached(&items, entry);
        items.iter().zip(reached).filter(|(_, kept)| *kept).flat_map(|(item, _)| item.names.clone()).collect()
    }

    #[test]
    fn only_what_a_function_reaches_is_kept() {
        let wgsl = "enable f16; struct A { x: f32 } struct B { a: A }; const K = 2.0; @group(0) @binding(1) var<uniform> u: B;
            alias F = f32; fn g(b: B) -> F { return b.unused * K; } fn unused() { } @compute @workgroup_size(1) fn main() { }
            fn f(w: vec3f) -> f32 { return g(B()); }";
        assert_eq!(kept(wgsl, ShaderLanguage::Wgsl, "f"), ["A", "B", "K", "F", "g", "f"]);
        let glsl = "precision highp float; layout(binding = 1) uniform Block { float a; vec3 b[2]; }; uniform sampler2D map;
            struct S { float x; } s; const float K = 2.0, M[2] = float[2](1.0, 2.0); in vec3 normal;
            float g(float x); float g(float x) { return x * K * a; } float unused() { return 1.0; }
            float f(const in vec3 w) { return g(w.x) + g(s.unused); } void main() { }";
        assert_eq!(
            kept(glsl, ShaderLanguage::Glsl, "f"),
            ["Block", "a", "b", "S", "s", "K", "M", "g", "g", "f"]
        );
        let items = items("fn a() { }\nfn b() { }", ShaderLanguage::Wgsl);
        assert_eq!(pruned("fn a() { }\nfn b() { }", &items, &reached(&items, "b")), "          \nfn b() { }");
    }
}
