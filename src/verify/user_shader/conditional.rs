//! Conditional translation of WESL: `@if(FEATURE)`, `@elif(…)` and `@else` before a declaration, a statement or a member.

use super::items::closing;
use super::token::{Token, words};
use crate::base::error::Result;
use std::collections::HashMap;

/// Leaves what holds; all else becomes blank.
pub(super) fn translated(text: &str, holds: impl Fn(&str) -> Result<bool>) -> Result<String> {
    let words = words(text);
    let mut out = text.to_owned().into_bytes();
    let mut blank = |from: usize, to: usize| {
        for (k, byte) in out[from..to].iter_mut().enumerate() {
            // A character of several bytes becomes as many spaces.
            if text.as_bytes()[from + k] != b'\n' {
                *byte = b' ';
            }
        }
    };
    // Where a chain of conditions goes on, and whether one has held.
    let mut chains = HashMap::<usize, bool>::new();
    let mut k = 0;
    while k + 1 < words.len() {
        let start = k;
        k += 1;
        let word = words[start + 1].text;
        if !words[start].is("@") || !matches!(word, "if" | "elif" | "else") {
            continue;
        }
        k += 1;
        let mut condition = "";
        if word != "else" && words.get(k).is_some_and(|word| word.is("(")) {
            let close = k + closing(&words[k..]);
            condition = &text[words[k].start..words[close].end()];
            k = close + 1;
        }
        let done = word != "if" && chains.get(&start).copied().unwrap_or(false);
        let value = !done && (word == "else" || holds(condition)?);
        let end = k + extent(&words[k..]);
        chains.insert(end, done || value);
        blank(words[start].start, words[k - 1].end());
        if !value && end > k {
            blank(words[k].start, words[end - 1].end());
            k = end;
        }
    }
    Ok(String::from_utf8(out).unwrap_or_default())
}

/// How many words a declaration, a statement or a member has.
fn extent(words: &[Token]) -> usize {
    let mut k = 0;
    while words.get(k).is_some_and(|word| word.is("@")) {
        k += 2;
        if words.get(k).is_some_and(|word| word.is("(")) {
            k += closing(&words[k..]) + 1;
        }
    }
    let keyword = words.get(k).map_or("", |word| word.text);
    let is_list =
        !matches!(keyword, "let" | "var" | "const" | "override" | "fn" | "struct" | "alias" | "import");
    let (mut depth, mut template) = (0_usize, 0_usize);
    for (n, word) in words.iter().enumerate().skip(k) {
        match word.text {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" if depth == 0 => return n,
            ")" | "]" => depth -= 1,
            "}" => {
                depth -= 1;
                if depth == 0 && keyword != "import" && !words.get(n + 1).is_some_and(|next| next.is("else"))
                {
                    return n + 1;
                }
            }
            "<" if n > 0 && is_generic(words[n - 1].text) => template += 1,
            ">" => template = template.saturating_sub(1),
            ";" if depth == 0 => return n + 1,
            "," if depth == 0 && template == 0 && is_list => return n + 1,
            _ => {}
        }
    }
    words.len()
}

fn is_generic(name: &str) -> bool {
    ["array", "binding_array", "ptr", "atomic", "vec", "mat", "texture"]
        .iter()
        .any(|kind| name.starts_with(kind))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_hold_becomes_blank() {
        let run = |text: &str| {
            let text = translated(text, |condition| Ok(condition == "(A)")).unwrap();
            text.split_whitespace().collect::<Vec<_>>().join(" ")
        };
        assert_eq!(run("@if(A) const x = 1; @else const x = 2;"), "const x = 1;");
        assert_eq!(run("@if(B) const x = f(1, 2); @elif(A) const x = 2; @else const x = 3;"), "const x = 2;");
        assert_eq!(
            run(
                "struct S { @if(B) a: array<f32, 4>, @if(A) b: f32 } @if(B) @group(0) fn f() { if (x) { } } z"
            ),
            "struct S { b: f32 } z"
        );
        assert_eq!(
            run("fn f() { @if(B) if (x) { y; } else { z; } @if(A) { @if(B) w; v; } }"),
            "fn f() { { v; } }"
        );
        assert_eq!(run("@if(B) import a::{b, c}, d; e"), "e");
    }
}
