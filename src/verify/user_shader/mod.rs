//! A user's own BRDF: a function of a shader, run as it is, in the device's arithmetic.
//!
//! A file goes this way:
//!
//! 1. `source` reads it and tells WGSL from GLSL;
//! 2. `preprocess` carries out its directives, `imports` joins it with the modules that it names;
//! 3. `items` leaves what the function reaches, `bindings` turns what its program would fill into variables;
//! 4. naga parses it, `glsl` translates GLSL into WGSL;
//! 5. `signature` finds out what is a direction and what a parameter, by `roles`;
//! 6. `compose` appends a compute shader that calls the function, and `run` runs it.
//!
//! Lines stay where they are all the way, so that errors point at the user's own.

mod bindings;
mod compose;
mod conditional;
mod glsl;
mod imports;
mod items;
mod preprocess;
mod resources;
mod roles;
mod run;
mod signature;
mod source;
mod text;
mod token;

pub use compose::UpAxis;
pub use resources::{ShaderResource, ShaderTexture};
pub use run::{UserShader, directions};
pub use signature::ShaderParameter;
pub use source::is_shader;

use crate::base::error::{Error, Result};
use crate::verify::ParameterRange;
use crate::verify::limits::{self, Inlined};
use bindings::Private;
use imports::Joined;
use items::{Item, ItemKind};
use naga::valid::{Capabilities, FunctionInfo, ShaderStages, ValidationFlags, Validator};
use naga::{Handle, Module, TypeInner};
use resources::Slot;
use signature::{Signature, Understood, Wishes, show};
use source::ShaderLanguage;
use std::path::{Path, PathBuf};

/// How a shader is to be read, where its text does not tell.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct ShaderOptions {
    /// The function; none where only one of the file can be a BRDF.
    pub entry: Option<String>,
    /// Roles of arguments by name, such as `("x", "NdotL")`; `parameter` for what is none.
    pub roles: Vec<(String, String)>,
    /// What is a parameter where there is an argument of this name, whatever it is called: `nv` may be an exponent.
    pub parameters: Vec<String>,
    /// The member of the result that is the BRDF, such as `specular`.
    pub result: Option<String>,
    /// The axis that is the normal.
    pub up: UpAxis,
    /// Folders of included files and imported modules, and files to put before the shader.
    pub includes: Vec<PathBuf>,
    /// Macros, and what they stand for.
    pub defines: Vec<(String, String)>,
}

/// A function of a shader that can be a BRDF.
#[derive(Debug, Clone)]
pub struct UserFunction {
    file: String,
    entry: String,
    signature: Signature,
    /// What is compiled, in WGSL, and the function's name in it.
    code: String,
    call: String,
    up: UpAxis,
    /// Textures and samplers.
    slots: Vec<Slot>,
    /// Whether it, or what it calls, has a loop.
    loops: bool,
    /// Whether it computes in f16.
    half: bool,
    /// Whether it is nested deeper than the stack of any thread holds.
    is_deep: bool,
}

/// Functions that a message lists.
const LISTED: usize = 12;

impl UserFunction {
    /// Finds `entry` in a WGSL source; `file` is its name in messages.
    ///
    /// # Errors
    /// When what the function reaches is not valid WGSL, by its own lines; when there is no such function, or it
    /// cannot be a BRDF; when it needs what only its program could give it, such as a texture.
    pub fn parse(file: impl Into<String>, source: impl Into<String>, entry: &str) -> Result<Self> {
        let options = ShaderOptions { entry: Some(entry.into()), ..ShaderOptions::default() };
        let file = file.into();
        let source = source::clean(&file, source.into());
        Self::find(file, source, None, &options)
    }

    /// Finds a function in a file of WGSL or GLSL.
    ///
    /// # Errors
    /// As [`Self::parse`], and when the file cannot be read, or several functions could be meant.
    pub fn read(path: &Path, options: &ShaderOptions) -> Result<Self> {
        if let Some(none) = options.includes.iter().find(|path| !path.exists()) {
            return Err(Error::input(format!(
                "{}: there is no such folder or file to include",
                none.display()
            )));
        }
        let text = source::read(path)?;
        Self::find(path.display().to_string(), text, Some(path), options)
    }

    fn find(file: String, text: String, path: Option<&Path>, options: &ShaderOptions) -> Result<Self> {
        let language = source::language(&file, &text);
        let joined = imports::join(&file, &text, path, language, &options.includes, &options.defines);
        let joined = joined.map_err(|error| error.at(&file))?;
        let text = joined.text.joined();
        let is_deep = limits::check_text(&text).map_err(|error| error.at(&file))?;
        let roles = options.roles.iter().map(|(name, role)| match role.as_str() {
            "parameter" => Ok((name.clone(), None)),
            role => Ok((name.clone(), Some(role.parse()?))),
        });
        let wishes = Wishes {
            roles: roles.collect::<Result<_>>()?,
            parameters: options.parameters.clone(),
            result: options.result.clone(),
        };
        limits::with_stack(is_deep, || {
            let items = items::items(&text, language);
            let shader = Shader { file, joined, text, items, language, wishes, up: options.up, is_deep };
            match &options.entry {
                Some(entry) => shader.function(entry),
                None => shader.only_function(),
            }
        })
    }

    /// The module that runs the function, and counts the turns of its loops where a driver stops them.
    ///
    /// # Errors
    /// When the function does not stand in the module as it does in its file.
    pub(crate) fn compose(&self, loop_turns: Option<u32>) -> Result<Module> {
        let certain = loop_turns.map_or(u32::MAX, limits::certain_turns);
        let (text, counter) =
            compose::compose(&self.code, &self.call, &self.signature, self.up, run::GROUP, certain);
        let module = naga::front::wgsl::parse_str(&text);
        let mut module = module.map_err(|error| Error::input(error.emit_to_string(&text)))?;
        if loop_turns.is_some() {
            limits::count_turns(&mut module, &counter);
        }
        Ok(module)
    }

    /// The name of the function.
    pub fn entry(&self) -> &str {
        &self.entry
    }

    /// `FILE#ENTRY`.
    pub fn name(&self) -> String {
        format!("{}#{}", self.file, self.entry)
    }

    /// The numbers that it takes beside the directions, in the order of a setting.
    pub fn parameters(&self) -> &[ShaderParameter] {
        &self.signature.parameters
    }

    /// What can be set, with its type: `base_color: vec3<f32>`.
    pub fn settable(&self) -> Vec<String> {
        let parameter = |(name, what): &(String, Understood)| match what {
            Understood::Parameter(ty, _) => Some(format!("{name}: {ty}")),
            Understood::Role(_) => None,
        };
        self.signature.understood.iter().filter_map(parameter).collect()
    }

    /// Binds a texture or a sampler that it reads.
    ///
    /// # Errors
    /// When it reads none of this name, or the other kind.
    pub fn bind(&mut self, name: &str, resource: ShaderResource) -> Result<()> {
        let slot = self.slots.iter_mut().find(|slot| slot.name == name);
        slot.ok_or_else(|| Error::input(format!("fn {} reads no texture nor sampler `{name}`", self.entry)))?
            .bind(resource)
    }

    /// A texture or sampler that it reads and that is not bound yet.
    pub fn unbound(&self) -> Option<&str> {
        self.slots.iter().find(|slot| slot.bound.is_none()).map(|slot| slot.name.as_str())
    }

    /// The axis that is its normal.
    pub fn up(&self) -> UpAxis {
        self.up
    }

    /// Says what was understood: `brdf(n = normal, l = wi, v = wo, roughness = 0.1..1) → vec3f`. `parameters` are its
    /// own, in its order.
    pub fn describe(&self, parameters: &[ParameterRange]) -> String {
        let range = |parameter: &ParameterRange| match parameter.low == parameter.high {
            true => format!("{}", parameter.low),
            false => format!("{}..{}", parameter.low, parameter.high),
        };
        let say = |(name, what): &(String, Understood)| match what {
            Understood::Role(role) => format!("{name} = {role}"),
            Understood::Parameter(_, indices) => {
                let mut ranges: Vec<_> =
                    parameters.get(indices.clone()).unwrap_or_default().iter().map(range).collect();
                // One for all, as it can be given.
                ranges.dedup();
                format!("{name} = {}", ranges.join(", "))
            }
        };
        let arguments: Vec<_> = self.signature.understood.iter().map(say).collect();
        let result = if self.signature.result.channels == 1 { "f32" } else { "vec3f" };
        let up = match self.up {
            UpAxis::X => ", the normal is +x",
            UpAxis::Y => ", the normal is +y",
            UpAxis::Z => "",
        };
        format!("{}({}) → {result}{up}", self.entry, arguments.join(", "))
    }
}

/// A shader on its way.
struct Shader {
    file: String,
    joined: Joined,
    text: String,
    items: Vec<Item>,
    language: ShaderLanguage,
    wishes: Wishes,
    up: UpAxis,
    is_deep: bool,
}

impl Shader {
    fn function(&self, entry: &str) -> Result<UserFunction> {
        let declared =
            |kind| move |item: &&Item| item.kind == kind && item.names.iter().any(|name| name == entry);
        if self.items.iter().any(|item| declared(ItemKind::Function)(&item)) {
            return self.candidate(entry);
        }
        // A fault of the syntax hides functions.
        if self.language == ShaderLanguage::Wgsl {
            naga::front::wgsl::parse_str(&self.text).map_err(|error| self.joined.text.parse_error(&error))?;
        }
        Err(Error::input(match self.items.iter().find(declared(ItemKind::EntryPoint)) {
            Some(_) => format!(
                "{}: {entry} is an entry point of a pipeline; name the function that it calls: {}",
                self.file,
                self.names().join(", ")
            ),
            None => match self.names()[..] {
                [] => format!("{}: there is no function {entry}, nor any other", self.file),
                ref names => {
                    format!("{}: there is no function {entry}; there are {}", self.file, names.join(", "))
                }
            },
        }))
    }

    /// The function that can be a BRDF, if there is one alone.
    fn only_function(&self) -> Result<UserFunction> {
        let names = self.names();
        if names.is_empty() {
            self.function("brdf")?;
        }
        let mut fitting = Vec::new();
        let mut others = Vec::new();
        for name in names {
            match self.candidate(&name) {
                Ok(function) => fitting.push(function),
                Err(why) => others.push((name, why)),
            }
        }
        // A term of a BRDF is not meant, and names tell more than places.
        if fitting.iter().any(|function| !roles::is_term(&function.entry)) {
            fitting.retain(|function| !roles::is_term(&function.entry));
        }
        if fitting.iter().any(|function| function.signature.by_name) {
            fitting.retain(|function| function.signature.by_name);
        }
        let file = &self.file;
        match fitting.len() {
            1 if roles::is_term(&fitting[0].entry) => Err(Error::input(format!(
                "{file}: fn {} can be a BRDF by what it takes, and is a term of one by its name; name it to check it",
                fitting[0].entry
            ))),
            1 => Ok(fitting.remove(0)),
            0 if others.len() == 1 => Err(others.remove(0).1),
            0 => {
                let list: Vec<_> = others
                    .iter()
                    .take(LISTED)
                    .map(|(name, why)| format!("  {name}: {}", brief(why)))
                    .collect();
                Err(Error::input(format!("{file}: no function can be a BRDF:\n{}", list.join("\n"))))
            }
            count => {
                let list = fitting.iter().take(LISTED).map(|function| {
                    let arguments = function.signature.understood.iter().map(|(name, what)| match what {
                        Understood::Role(role) => format!("{name} = {role}"),
                        Understood::Parameter(ty, _) => format!("{name}: {ty}"),
                    });
                    format!("  {file}#{}   ({})", function.entry, arguments.collect::<Vec<_>>().join(", "))
                });
                Err(Error::input(format!(
                    "{file}: {count} functions can be a BRDF; name one of them:\n{}",
                    list.collect::<Vec<_>>().join("\n")
                )))
            }
        }
    }

    /// The functions of the user's own file.
    fn names(&self) -> Vec<String> {
        let own: usize = self.joined.text.lines.iter().map(|line| line.text.len() + 1).sum();
        let functions = self.items.iter().filter(|item| item.kind == ItemKind::Function);
        let mut names: Vec<String> = Vec::new();
        for item in functions.filter(|item| item.range.start < own) {
            let is_own = self.joined.text.file(item.range.start) == Some(0);
            names.extend(
                item.names.iter().filter(|name| is_own && !names.contains(name)).cloned().collect::<Vec<_>>(),
            );
        }
        names
    }

    /// Reads a function of the file as a BRDF.
    fn candidate(&self, entry: &str) -> Result<UserFunction> {
        let at = |error: Error| error.at(&self.file);
        let reached = items::reached(&self.items, entry);
        let kept = || self.items.iter().zip(&reached).filter(|(_, kept)| **kept).map(|(item, _)| item);
        let missing = kept().find_map(|item| {
            let written = item.uses.iter().find_map(|word| self.joined.missing.get(word))?;
            Some((written, self.joined.text.place(item.range.start)))
        });
        if let Some((written, place)) = missing {
            let module = written.rsplit_once("::").map_or(written.as_str(), |(module, _)| module);
            return Err(Error::input(format!(
                "{place}: fn {entry} needs {written}, and no file here is the module {module}, by its path or by \
                 #define_import_path; give its folder as an include folder"
            )));
        }
        let private = bindings::made_private(&self.text, &self.items, &reached, self.language)
            .map_err(|error| at(Error::input(format!("fn {entry} {error}"))))?;
        // The declarations lie where they lay, but for those that became variables.
        let items = items::items(&private.text, self.language);
        let mut kept = items::reached(&items, entry);
        items::without_repetitions(&private.text, &items, &mut kept);
        loop {
            let text = self.joined.text.with_text(&items::pruned(&private.text, &items, &kept));
            if self.language == ShaderLanguage::Wgsl {
                return self.wgsl(entry, &text, &private);
            }
            match glsl::parse(&text) {
                Ok(module) => return self.glsl(entry, &text, module, &private.names),
                Err((offset, error)) => {
                    // Another function of the same name may not be what is wanted.
                    let overload = offset.and_then(|offset| items::overload(&items, &kept, offset));
                    kept[overload.ok_or(error)?] = false;
                }
            }
        }
    }

    fn wgsl(&self, entry: &str, text: &text::ShaderText, private: &Private) -> Result<UserFunction> {
        let code = text.joined();
        let module = naga::front::wgsl::parse_str(&code).map_err(|error| text.parse_error(&error))?;
        let found = module.functions.iter().find(|(_, function)| function.name.as_deref() == Some(entry));
        let (handle, function) =
            found.ok_or_else(|| Error::Internal(format!("fn {entry} is lost on the way")))?;
        // What any device may lack is for the device to refuse.
        let info = Validator::new(ValidationFlags::all(), Capabilities::all()).validate(&module);
        let info = info.map_err(|error| text.validation_error(&error))?;
        let shown = show(&module, function);
        let is_compute = info[handle].available_stages.contains(ShaderStages::COMPUTE);
        let globals: Vec<_> = globals(&module, &info[handle], &private.names)
            .into_iter()
            .map(|(name, _, ty)| (name, ty))
            .collect();
        let mut slots = private.slots.clone();
        slots.retain(|slot| {
            !self::globals(&module, &info[handle], std::slice::from_ref(&slot.name)).is_empty()
        });
        let signature = Signature::new(&module, function, &globals, &self.wishes);
        let Inlined { loops, .. } = Inlined::new(&module, handle).map_err(|error| error.at(&self.file))?;
        let function = self.finish(entry, &shown, signature, is_compute, &module, code, entry);
        function.map(|function| UserFunction { slots, loops, ..function })
    }

    fn glsl(
        &self,
        entry: &str,
        text: &text::ShaderText,
        module: Module,
        names: &[String],
    ) -> Result<UserFunction> {
        let info = Validator::new(ValidationFlags::all(), Capabilities::all()).validate(&module);
        let info = info.map_err(|error| text.validation_error(&error))?;
        // Of overloads the first that fits.
        let mut best = None;
        for (handle, function) in module.functions.iter().filter(|(_, f)| f.name.as_deref() == Some(entry)) {
            let globals = globals(&module, &info[handle], names);
            let types: Vec<_> = globals.iter().map(|(name, _, ty)| (name.clone(), *ty)).collect();
            let signature = Signature::new(&module, function, &types, &self.wishes);
            if best.as_ref().is_none_or(|(.., before): &(_, _, _, Result<_>)| before.is_err()) {
                best = Some((handle, show(&module, function), globals, signature));
            }
        }
        let (handle, shown, globals, signature) =
            best.ok_or_else(|| Error::input(format!("fn {entry} has no body")).at(&self.file))?;
        let variables: Vec<_> = globals.iter().map(|(_, variable, _)| *variable).collect();
        let signature = signature.map(|mut signature| {
            signature.globals.iter_mut().enumerate().for_each(|(k, (name, _))| *name = glsl::global(k));
            signature
        });
        let code = glsl::translate(text, module.clone(), handle, &variables)?;
        let Inlined { loops, .. } = Inlined::new(&module, handle).map_err(|error| error.at(&self.file))?;
        let function = self.finish(entry, &shown, signature, true, &module, code, glsl::ENTRY);
        function.map(|function| UserFunction { loops, ..function })
    }

    #[allow(clippy::too_many_arguments)] // each is one result of the stages before
    fn finish(
        &self,
        entry: &str,
        shown: &str,
        signature: Result<Signature>,
        is_compute: bool,
        module: &Module,
        code: String,
        call: &str,
    ) -> Result<UserFunction> {
        let unfit = |what: String| Error::input(format!("{}: fn {entry}{shown} {what}", self.file));
        let signature = signature.map_err(|error| unfit(error.to_string()))?;
        if !is_compute {
            let what = "uses what only fragment shaders have, a derivative or an implicit level of detail";
            return Err(unfit(what.into()));
        }
        Ok(UserFunction {
            file: self.file.clone(),
            entry: entry.into(),
            signature,
            loops: false,
            is_deep: self.is_deep,
            half: module.types.iter().any(|(_, ty)| is_half(&ty.inner)),
            code,
            call: call.into(),
            slots: Vec::new(),
            up: self.up,
        })
    }
}

/// The line of an error that says what is wrong.
fn brief(why: &Error) -> String {
    let why = why.to_string();
    why.lines()
        .find_map(|line| line.strip_prefix("error: "))
        .or(why.lines().next())
        .unwrap_or_default()
        .to_owned()
}

/// The variables of a module with these names, of those that a function reads.
fn globals(
    module: &Module,
    info: &FunctionInfo,
    names: &[String],
) -> Vec<(String, Handle<naga::GlobalVariable>, Handle<naga::Type>)> {
    let find = |name: &String| {
        let found = module.global_variables.iter().find(|(_, v)| v.name.as_ref() == Some(name));
        let found = found.filter(|(handle, _)| !info[*handle].is_empty());
        found.map(|(handle, variable)| (name.clone(), handle, variable.ty))
    };
    names.iter().filter_map(find).collect()
}

fn is_half(inner: &TypeInner) -> bool {
    match inner {
        TypeInner::Scalar(scalar) | TypeInner::Vector { scalar, .. } | TypeInner::Matrix { scalar, .. } => {
            *scalar == naga::Scalar::F16
        }
        _ => false,
    }
}
