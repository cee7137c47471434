//! What a shader's program would fill: uniforms, inputs of a stage, constants without a value.
//!
//! Each becomes a private variable of the same name, which is set before the function is called. So it is a parameter as
//! an argument is, and needs no layout. Textures and samplers stay bindings, of a group of their own.

use super::items::{Item, ItemKind, closing};
use super::resources::{RESOURCES, Slot};
use super::source::ShaderLanguage;
use super::token::{Token, words};
use crate::base::error::{Error, Result};

/// What a text became, and what has to be set and bound for it.
pub(super) struct Private {
    pub text: String,
    /// Names of variables.
    pub names: Vec<String>,
    pub slots: Vec<Slot>,
}

/// Turns what is bound, among what is reached, into private variables.
///
/// # Errors
/// When a texture is among it that cannot be bound.
pub(super) fn made_private(
    text: &str,
    items: &[Item],
    reached: &[bool],
    language: ShaderLanguage,
) -> Result<Private> {
    let mut private =
        Private { text: String::with_capacity(text.len()), names: Vec::new(), slots: Vec::new() };
    let mut at = 0;
    for (item, _) in items.iter().zip(reached).filter(|(item, kept)| **kept && item.kind == ItemKind::Bound) {
        private.text += &text[at..item.range.start];
        let declaration = &text[item.range.clone()];
        let name = item.names.last().map_or("a binding", String::as_str);
        let kinds = ["texture", "sampler", "isampler", "usampler", "image2D"];
        let kind =
            item.uses.iter().find(|word| *word != name && kinds.iter().any(|kind| word.starts_with(kind)));
        private.text += &match (kind.map(String::as_str), language) {
            (Some(kind @ ("texture_2d" | "sampler")), ShaderLanguage::Wgsl) => {
                let binding = private.slots.len() as u32;
                private.slots.push(Slot {
                    name: name.into(),
                    is_sampler: kind == "sampler",
                    binding,
                    bound: None,
                });
                rebound(declaration, binding)
            }
            (Some(kind), _) => {
                return Err(Error::input(format!(
                    "reads `{name}`, a {kind}, which cannot be bound: textures are texture_2d<f32> and sampler, in WGSL; \
                     call it from a function that takes what it reads there as parameters"
                )));
            }
            (None, ShaderLanguage::Wgsl) => {
                private.names.extend(item.names.iter().cloned());
                wgsl(declaration)
            }
            (None, ShaderLanguage::Glsl) => glsl(declaration, item, &mut private.names),
        };
        at = item.range.end;
    }
    private.text += &text[at..];
    Ok(private)
}

/// A declaration with another binding.
fn rebound(declaration: &str, binding: u32) -> String {
    let start = words(declaration).iter().find(|word| word.is("var")).map_or(0, |word| word.start);
    let lines = "\n".repeat(declaration[..start].matches('\n').count());
    format!("{lines}@group({RESOURCES}) @binding({binding}) {}", &declaration[start..])
}

/// `@group(0) @binding(1) var<uniform> name: T;` becomes `var<private> name: T;`, at its place.
fn wgsl(declaration: &str) -> String {
    let words = words(declaration);
    let keyword = words.iter().position(|word| word.is("var") || word.is("override")).unwrap_or(0);
    let mut rest = words[keyword].end();
    if words.get(keyword + 1).is_some_and(|word| word.is("<")) {
        let close = words[keyword..].iter().find(|word| word.is(">"));
        rest = close.map_or(rest, Token::end);
    }
    format!("{}var<private>{}", blank(&declaration[..words[keyword].start]), &declaration[rest..])
}

/// `layout(…) uniform Block { … } name;` becomes `struct Block { … } name;`, and without a name its members variables.
fn glsl(declaration: &str, item: &Item, names: &mut Vec<String>) -> String {
    let words = words(declaration);
    let open = words.iter().position(|word| word.is("{"));
    let first = match words.first().is_some_and(|word| word.is("layout")) {
        true => closing(&words[1..]) + 2,
        false => 0,
    };
    let instance = words.len() > 1 && !words[words.len() - 2].is("}");
    names.extend(match (open, instance) {
        (None, _) => item.names.clone(),
        (Some(_), true) => item.names.last().cloned().into_iter().collect(),
        (Some(_), false) => item.names[1.min(item.names.len())..].to_vec(),
    });
    let mut out = String::new();
    let mut at = 0;
    for (k, word) in words.iter().enumerate() {
        let header = open.is_none_or(|open| k < open);
        let storage = matches!(
            word.text,
            "uniform"
                | "varying"
                | "attribute"
                | "in"
                | "out"
                | "buffer"
                | "flat"
                | "smooth"
                | "centroid"
                | "readonly"
        );
        let loose = open.is_some() && !instance;
        let dropped = k < first
            || (header && storage)
            || (loose && (header || word.is("{") || word.is("}") || k + 1 == words.len()));
        out += &declaration[at..word.start];
        if header && storage && !loose && open.is_some() && word.text != "flat" && !out.contains("struct") {
            out += "struct";
        }
        out += &if dropped { blank(word.text) } else { word.text.to_owned() };
        at = word.end();
    }
    out
}

fn blank(text: &str) -> String {
    text.chars().map(|c| if c == '\n' { '\n' } else { ' ' }).collect()
}

#[cfg(test)]
mod tests {
    use super::super::items::items;
    use super::*;

    fn private(text: &str, language: ShaderLanguage) -> (String, Vec<String>) {
        let items = items(text, language);
        let Private { text, names, .. } =
            made_private(text, &items, &vec![true; items.len()], language).unwrap();
        (text.split_whitespace().collect::<Vec<_>>().join(" "), names)
    }

    #[test]
    fn bindings_become_variables() {
        let (text, names) =
            private("@group(0) @binding(1) var<storage, read> a: A; override b: f32;", ShaderLanguage::Wgsl);
        assert_eq!(
            (text.as_str(), names),
            ("var<private> a: A; var<private> b: f32;", vec!["a".into(), "b".into()])
        );
        let source =
            "layout(set = 0, binding = 1) uniform Block { float a; vec3 b[2]; }; uniform float c; in vec3 d;
            layout(std140) uniform Other { float x; } e;";
        let (text, names) = private(source, ShaderLanguage::Glsl);
        assert_eq!(text, "float a; vec3 b[2]; float c; vec3 d; struct Other { float x; } e;");
        assert_eq!(names, ["a", "b", "c", "d", "e"]);
    }
}
