//! Translates GLSL into WGSL, by naga, so that one path compiles both.

use super::text::ShaderText;
use super::token::words;
use crate::base::error::{Error, Result};
use naga::back::wgsl::{WriterFlags, write_string};
use naga::front::glsl::{Frontend, Options};
use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{Function, Module, ShaderStage, Type, TypeInner};

/// What naga needs before and after a file that has only functions.
const BEFORE: &str = "#version 450\n";
const AFTER: &str = "\nvoid main() {}\n";

/// The names of the function and of the variables in the translation. naga marks names that end with a digit.
pub(super) const ENTRY: &str = "gonio_function";

pub(super) fn global(k: usize) -> String {
    format!("gonio_global_{k}_")
}

/// Parses functions in GLSL. A fault comes with its offset.
pub(super) fn parse(text: &ShaderText) -> std::result::Result<Module, (Option<usize>, Error)> {
    let joined = without_const_in(&text.joined());
    let source = format!("{BEFORE}{joined}{AFTER}");
    let parsed = Frontend::default().parse(&Options::from(ShaderStage::Fragment), &source);
    let mut module = parsed.map_err(|errors| {
        let Some(error) = errors.errors.first() else { return (None, Error::input("it is not valid GLSL")) };
        let range = error.meta.to_range().map(|range| {
            let place = |at: usize| at.saturating_sub(BEFORE.len()).min(joined.len());
            (place(range.start)..place(range.end), String::new())
        });
        let offset = range.as_ref().map(|(range, _)| range.start);
        (offset, text.error(&error.kind.to_string(), range.into_iter().collect(), Vec::new()))
    })?;
    module.entry_points.clear();
    // The writer changes names that end with a digit, so structures get names that it keeps.
    let structures = module.types.iter().filter(|(_, ty)| matches!(ty.inner, TypeInner::Struct { .. }));
    let structures: Vec<_> = structures.map(|(handle, ty)| (handle, ty.inner.clone())).collect();
    for (k, (handle, inner)) in structures.into_iter().enumerate() {
        module.types.replace(handle, Type { name: Some(format!("gonio_type_{k}_")), inner });
    }
    Ok(module)
}

/// Takes `const` from `const in`, which naga does not read.
fn without_const_in(text: &str) -> String {
    let words = words(text);
    let mut out = String::with_capacity(text.len());
    let mut at = 0;
    for pair in words.windows(2).filter(|pair| pair[0].is("const") && pair[1].is("in")) {
        out += &text[at..pair[0].start];
        out += "     ";
        at = pair[0].end();
    }
    out + &text[at..]
}

/// Writes a module in WGSL, in which the function is [`ENTRY`] and the variables are [`global`]s.
pub(super) fn translate(
    text: &ShaderText,
    mut module: Module,
    entry: naga::Handle<Function>,
    globals: &[naga::Handle<naga::GlobalVariable>],
) -> Result<String> {
    module.functions[entry].name = Some(ENTRY.into());
    for (k, &handle) in globals.iter().enumerate() {
        module.global_variables[handle].name = Some(global(k));
    }
    let info = Validator::new(ValidationFlags::all(), Capabilities::all()).validate(&module);
    let info = info.map_err(|error| text.validation_error(&error))?;
    write_string(&module, &info, WriterFlags::empty())
        .map_err(|error| Error::input(format!("the translation to WGSL fails: {error}")))
}
