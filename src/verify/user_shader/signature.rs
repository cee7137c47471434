//! What a function takes and returns, read as a BRDF.
//!
//! Arguments are trees of scalars. Each leaf, or vector of three, is a role, such as the light's direction, or a
//! parameter, by its name.

use super::roles::{FrameVector, Role, RoleKind, cosine, vector};
use crate::base::error::{Error, Result};
use crate::verify::ParameterRange;
use naga::{AddressSpace, Function, Handle, Module, ScalarKind, Type, TypeInner, VectorSize};

/// A type of number in a shader.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NumberType {
    F32,
    F16,
    I32,
    U32,
    Bool,
}

impl NumberType {
    fn new(scalar: naga::Scalar) -> Option<Self> {
        match (scalar.kind, scalar.width) {
            (ScalarKind::Float, 4) => Some(Self::F32),
            (ScalarKind::Float, 2) => Some(Self::F16),
            (ScalarKind::Sint, 4) => Some(Self::I32),
            (ScalarKind::Uint, 4) => Some(Self::U32),
            (ScalarKind::Bool, _) => Some(Self::Bool),
            _ => None,
        }
    }

    /// Its name in WGSL.
    pub fn name(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::F16 => "f16",
            Self::I32 => "i32",
            Self::U32 => "u32",
            Self::Bool => "bool",
        }
    }

    pub fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::F16)
    }
}

/// A number that a shader takes, beside the directions.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ShaderParameter {
    /// Its path: `roughness`, `base_color.x`, `material.layers[0].roughness`.
    pub name: String,
    pub(super) number: NumberType,
}

impl ShaderParameter {
    /// Whether it has whole numbers only; those of a bool are 0 and 1.
    pub fn is_integer(&self) -> bool {
        !self.number.is_float()
    }

    /// A range of it, in whole numbers where it has no others.
    pub(super) fn fitted(&self, range: ParameterRange) -> Result<ParameterRange> {
        let (least, most) = match self.number {
            NumberType::F32 | NumberType::F16 => return Ok(range),
            NumberType::I32 => (f64::from(i32::MIN), f64::from(i32::MAX)),
            NumberType::U32 => (0.0, f64::from(u32::MAX)),
            NumberType::Bool => (0.0, 1.0),
        };
        if range.low < least || range.high > most {
            let ParameterRange { name, low, high, .. } = range;
            let number = self.number.name();
            return Err(Error::input(format!(
                "parameter {name}: {low}..{high} is not within {number}, {least}..{most}"
            )));
        }
        range.whole()
    }
}

/// How a value that the shader takes is made.
#[derive(Debug, Clone)]
pub(super) enum Input {
    Role {
        role: Role,
        number: NumberType,
    },
    /// An index of [`Signature::parameters`].
    Parameter(usize),
    /// A constructor in WGSL, and what it takes.
    Composite {
        constructor: String,
        parts: Vec<Self>,
    },
}

/// An argument.
#[derive(Debug, Clone)]
pub(super) struct Argument {
    pub input: Input,
    /// Whether it is passed by its address.
    pub pointer: bool,
}

/// Where the value of the BRDF is.
#[derive(Debug, Clone)]
pub(super) struct ShaderResult {
    /// The argument that holds it afterwards; none where it is returned.
    pub argument: Option<usize>,
    /// What follows the value: `.specular.xyz`.
    pub access: String,
    pub channels: usize,
}

/// A function that can be a BRDF.
#[derive(Debug, Clone)]
pub(super) struct Signature {
    pub arguments: Vec<Argument>,
    /// Variables of the module that are set before the call.
    pub globals: Vec<(String, Input)>,
    pub parameters: Vec<ShaderParameter>,
    pub result: ShaderResult,
    /// What was understood, in order: a name, and its role or its type.
    pub understood: Vec<(String, Understood)>,
    /// Whether the names told which directions are which, and not their places.
    pub by_name: bool,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Understood {
    Role(Role),
    /// A parameter, by its type and the indices of its numbers.
    Parameter(String, std::ops::Range<usize>),
}

/// The wish of the user about what names do not tell.
#[derive(Debug, Clone, Default)]
pub(super) struct Wishes {
    /// Roles by argument; none where it is a parameter.
    pub roles: Vec<(String, Option<Role>)>,
    /// Names of parameters, where there are such arguments.
    pub parameters: Vec<String>,
    pub result: Option<String>,
}

/// Names that a vector of a direction never has.
const COLORS: [&str; 12] = [
    "color",
    "colour",
    "albedo",
    "f0",
    "f90",
    "spec",
    "base",
    "tint",
    "diffuse",
    "reflectance",
    "edge",
    "weight",
];

/// How far a tree of types may grow.
const LARGEST: usize = 1 << 10;

struct Reader<'a> {
    module: &'a Module,
    wishes: &'a Wishes,
    used: Vec<bool>,
    /// Places of directions that names do not tell.
    positional: Vec<(String, Role)>,
    parameters: Vec<ShaderParameter>,
    understood: Vec<(String, Understood)>,
    /// Whether single letters may be tangents.
    letters: bool,
    by_name: bool,
}

impl Signature {
    /// Reads a function of a module; `globals` are its variables that have to be set, with their names.
    ///
    /// # Errors
    /// When it cannot be a BRDF, in words that follow its name.
    pub fn new(
        module: &Module,
        function: &Function,
        globals: &[(String, Handle<Type>)],
        wishes: &Wishes,
    ) -> Result<Self> {
        let mut reader = Reader {
            module,
            wishes,
            used: vec![false; wishes.roles.len()],
            positional: Vec::new(),
            parameters: Vec::new(),
            understood: Vec::new(),
            letters: true,
            by_name: true,
        };
        let name =
            |k: usize| function.arguments[k].name.clone().unwrap_or_else(|| format!("argument{}", k + 1));
        // First without the letters t and b, which are tangents only beside directions that are named.
        reader.letters = false;
        let mut roles = Vec::new();
        for (k, argument) in function.arguments.iter().enumerate() {
            reader.roles(&name(k), argument.ty, 0, &mut roles);
        }
        for (name, ty) in globals {
            reader.wished(name, *ty, 0, &mut roles);
        }
        reader.letters = true;
        if !reader.is_brdf(&roles) {
            let places: Vec<_> =
                (0..function.arguments.len()).map(|k| (name(k), function.arguments[k].ty)).collect();
            reader.positions(&places, &mut roles);
            if !reader.is_brdf(&roles) {
                return Err(unfit(&roles));
            }
        }

        let result = result(module, function, wishes.result.as_deref())?;
        let mut arguments = Vec::new();
        for (k, argument) in function.arguments.iter().enumerate() {
            let (ty, pointer) = match module.types[argument.ty].inner {
                TypeInner::Pointer { base, space: AddressSpace::Function } => (base, true),
                _ => (argument.ty, false),
            };
            // What only comes back is no parameter.
            let input = match result.argument == Some(k) {
                true => Input::Composite { constructor: type_name(module, ty)?, parts: Vec::new() },
                false => reader.input(&name(k), ty, true)?,
            };
            arguments.push(Argument { input, pointer });
        }
        let globals = globals.iter().map(|(name, ty)| Ok((name.clone(), reader.input(name, *ty, false)?)));
        let globals = globals.collect::<Result<_>>()?;
        if let Some(k) = reader.used.iter().position(|used| !used) {
            return Err(Error::input(format!(
                "has nothing named \"{}\" to give a role to",
                wishes.roles[k].0
            )));
        }
        let Reader { parameters, understood, by_name, .. } = reader;
        Ok(Self { arguments, globals, parameters, result, understood, by_name })
    }
}

impl Reader<'_> {
    /// The role that a name and a type have, if they have one.
    fn role(&mut self, path: &str, ty: Handle<Type>, named: bool) -> Option<Role> {
        let (is_vector, is_scalar) = match self.module.types[ty].inner {
            TypeInner::Vector { size: VectorSize::Tri, scalar } => (scalar.kind == ScalarKind::Float, false),
            TypeInner::Scalar(scalar) => (false, scalar.kind == ScalarKind::Float),
            _ => (false, false),
        };
        let fits = |role: &Role| match role.kind {
            RoleKind::Vector(_) => is_vector,
            RoleKind::Cosine(..) => is_scalar,
        };
        let last = path.rsplit('.').next().unwrap_or(path);
        let wished = self.wishes.roles.iter().position(|(name, _)| name == path);
        let wished = wished.or(self.wishes.roles.iter().position(|(name, _)| name == last));
        if let Some(k) = wished {
            let role = self.wishes.roles[k].1;
            self.used[k] |= role.as_ref().is_none_or(fits);
            return role.filter(fits);
        }
        if self.wishes.parameters.iter().any(|name| name == path) {
            return None;
        }
        if let Some((_, role)) = self.positional.iter().find(|(name, _)| name == path) {
            return Some(*role);
        }
        // Globals, and elements of arrays, have roles only by wish.
        if !named || last.contains('[') {
            return None;
        }
        if is_vector {
            let role = vector(last)?;
            let is_tangent =
                [FrameVector::Tangent, FrameVector::Bitangent].map(RoleKind::Vector).contains(&role.kind);
            return Some(role).filter(|_| self.letters || last.len() > 1 || !is_tangent);
        }
        let (a, b) = cosine(last).filter(|_| is_scalar)?;
        Some(RoleKind::Cosine(a, b).into())
    }

    /// Collects the roles in a tree of types.
    fn roles(&mut self, path: &str, ty: Handle<Type>, depth: usize, roles: &mut Vec<Role>) {
        self.collect(path, ty, depth, true, roles);
    }

    fn wished(&mut self, path: &str, ty: Handle<Type>, depth: usize, roles: &mut Vec<Role>) {
        self.collect(path, ty, depth, false, roles);
    }

    fn collect(&mut self, path: &str, ty: Handle<Type>, depth: usize, named: bool, roles: &mut Vec<Role>) {
        if let Some(role) = self.role(path, ty, named) {
            roles.push(role);
            return;
        }
        let module = self.module;
        match &module.types[ty].inner {
            TypeInner::Pointer { base, .. } => self.collect(path, *base, depth, named, roles),
            TypeInner::Array { base, .. } if depth < 16 => {
                self.collect(&format!("{path}[0]"), *base, depth + 1, named, roles);
            }
            TypeInner::Struct { members, .. } if depth < 16 => {
                for member in members {
                    let name = member.name.as_deref().unwrap_or("_");
                    self.collect(&format!("{path}.{name}"), member.ty, depth + 1, named, roles);
                }
            }
            _ => {}
        }
    }

    /// Whether f(ωi, ωo) can be computed from what has a role.
    fn is_brdf(&self, roles: &[Role]) -> bool {
        use FrameVector::*;
        let has = |vector| {
            roles.iter().any(|role| match role.kind {
                RoleKind::Vector(v) => v == vector,
                RoleKind::Cosine(a, b) => {
                    (a == vector && [Normal, Tangent, Bitangent].contains(&b))
                        || (b == vector && [Normal, Tangent, Bitangent].contains(&a))
                }
            })
        };
        let cosine = |x, y| {
            roles.iter().any(|role| match role.kind {
                RoleKind::Cosine(a, b) => (a, b) == (x, y) || (b, a) == (x, y),
                RoleKind::Vector(_) => false,
            })
        };
        (has(Light) && has(View)) || (cosine(Normal, Half) && (cosine(Light, Half) || cosine(View, Half)))
    }

    /// Takes the first directions that no name tells as ωi and ωo.
    fn positions(&mut self, arguments: &[(String, Handle<Type>)], roles: &mut Vec<Role>) {
        let is_cosine = |role: &Role| matches!(role.kind, RoleKind::Cosine(..));
        if roles.iter().any(is_cosine) {
            return;
        }
        let has = |vector| roles.iter().any(|role| role.kind == RoleKind::Vector(vector));
        let mut missing: Vec<_> =
            [FrameVector::Light, FrameVector::View].into_iter().filter(|&vector| !has(vector)).collect();
        missing.reverse();
        for (name, ty) in arguments {
            let is_vector = matches!(
                self.module.types[*ty].inner,
                TypeInner::Vector { size: VectorSize::Tri, scalar } if scalar.kind == ScalarKind::Float
            );
            if !is_vector {
                break;
            }
            self.letters = false;
            let known = self.role(name, *ty, true);
            self.letters = true;
            let plain = name.to_lowercase();
            if known.is_some() || self.wishes.roles.iter().any(|(wish, _)| wish == name) {
                continue;
            }
            if COLORS.iter().any(|color| plain.contains(color)) {
                break;
            }
            let Some(vector) = missing.pop() else { break };
            self.by_name = false;
            let role = Role::from(RoleKind::Vector(vector));
            self.positional.push((name.clone(), role));
            roles.push(role);
        }
    }

    /// How a value of a type is made.
    fn input(&mut self, path: &str, ty: Handle<Type>, named: bool) -> Result<Input> {
        let module = self.module;
        if let Some(role) = self.role(path, ty, named) {
            let number = match module.types[ty].inner {
                TypeInner::Scalar(scalar) | TypeInner::Vector { scalar, .. } => NumberType::new(scalar),
                _ => None,
            };
            let number = number.ok_or_else(|| untaken(module, path, ty))?;
            self.understood.push((path.into(), Understood::Role(role)));
            return Ok(Input::Role { role, number });
        }
        let start = self.parameters.len();
        let constructor = type_name(module, ty).map_err(|_| untaken(module, path, ty))?;
        let parts = match &module.types[ty].inner {
            TypeInner::Scalar(scalar) => {
                let number = NumberType::new(*scalar).ok_or_else(|| untaken(module, path, ty))?;
                self.understood.push((path.into(), Understood::Parameter(constructor, start..start + 1)));
                return self.parameter(path.into(), number);
            }
            TypeInner::Vector { size, scalar } => {
                let number = NumberType::new(*scalar).ok_or_else(|| untaken(module, path, ty))?;
                let axes = &["x", "y", "z", "w"][..*size as usize];
                let parts = axes.iter().map(|axis| self.parameter(format!("{path}.{axis}"), number));
                let parts = parts.collect::<Result<_>>()?;
                let range = start..self.parameters.len();
                self.understood.push((path.into(), Understood::Parameter(constructor.clone(), range)));
                parts
            }
            TypeInner::Matrix { columns, rows, .. } => {
                let axes = &["x", "y", "z", "w"][..*rows as usize];
                let cells = (0..*columns as usize).flat_map(|k| axes.iter().map(move |axis| (k, axis)));
                let cells =
                    cells.map(|(k, axis)| self.parameter(format!("{path}[{k}].{axis}"), NumberType::F32));
                let cells = cells.collect::<Result<_>>()?;
                let range = start..self.parameters.len();
                self.understood.push((path.into(), Understood::Parameter(constructor.clone(), range)));
                cells
            }
            TypeInner::Struct { members, .. } => {
                let name = |k: usize| members[k].name.clone().unwrap_or_else(|| format!("member{}", k + 1));
                let parts = (0..members.len())
                    .map(|k| self.input(&format!("{path}.{}", name(k)), members[k].ty, named));
                parts.collect::<Result<_>>()?
            }
            TypeInner::Array { base, size: naga::ArraySize::Constant(count), .. } => {
                let parts = (0..count.get()).map(|k| self.input(&format!("{path}[{k}]"), *base, named));
                parts.collect::<Result<_>>()?
            }
            _ => return Err(untaken(module, path, ty)),
        };
        Ok(Input::Composite { constructor, parts })
    }

    fn parameter(&mut self, name: String, number: NumberType) -> Result<Input> {
        if self.parameters.len() == LARGEST {
            return Err(Error::input(format!("has more than {LARGEST} numbers to set")));
        }
        self.parameters.push(ShaderParameter { name, number });
        Ok(Input::Parameter(self.parameters.len() - 1))
    }
}

fn untaken(module: &Module, path: &str, ty: Handle<Type>) -> Error {
    let what = match module.types[ty].inner {
        TypeInner::Image { .. } | TypeInner::Sampler { .. } => "a texture or sampler",
        TypeInner::Array { .. } => "an array without a length",
        TypeInner::Pointer { .. } => "a pointer that leaves the function",
        TypeInner::Atomic(_) => "an atomic",
        _ => "of a type",
    };
    Error::input(format!("takes \"{path}\", {what}, which cannot be set"))
}

/// Says what a function without two directions seems to be.
fn unfit(roles: &[Role]) -> Error {
    use FrameVector::*;
    let has = |vector| {
        roles.iter().any(|role| match role.kind {
            RoleKind::Vector(v) => v == vector,
            RoleKind::Cosine(a, b) => a == vector || b == vector,
        })
    };
    let seems = match (has(Normal), has(Half), has(Light), has(View)) {
        (_, false, false, false) => "takes no direction of the light nor of the view",
        (_, true, false, false) => "seems to be a distribution of normals D: it takes no light nor view",
        (false, true, ..) | (true, true, true, false) | (true, true, false, true) => {
            "seems to be a Fresnel term F, which goes by the half vector"
        }
        (true, false, true, false) | (true, false, false, true) => {
            "seems to be a masking term G1 of one direction"
        }
        (_, _, true, false) | (_, _, false, true) => "takes only one direction",
        _ => "depends on the angle between light and view alone",
    };
    Error::input(format!(
        "{seems}, so that it is no BRDF; name the function of light and view that returns the whole BRDF, or give the \
         roles of its arguments, such as a=L and b=V"
    ))
}

/// Where the value is.
fn result(module: &Module, function: &Function, wish: Option<&str>) -> Result<ShaderResult> {
    let mut candidates = Vec::new();
    if let Some(result) = &function.result {
        values(module, result.ty, None, String::new(), 0, &mut candidates);
    }
    let returns = candidates.len();
    for (k, argument) in function.arguments.iter().enumerate() {
        if let TypeInner::Pointer { base, space: AddressSpace::Function } = module.types[argument.ty].inner {
            let name = argument.name.as_deref().unwrap_or("_");
            values(module, base, Some(k), format!(".{name}"), 0, &mut candidates);
        }
    }
    let names: Vec<_> = candidates.iter().map(|(path, _)| path.trim_start_matches('.').to_owned()).collect();
    let place = match wish {
        Some(wish) => names.iter().position(|name| name == wish).ok_or_else(|| {
            let there: Vec<_> = names.iter().filter(|name| !name.is_empty()).map(String::as_str).collect();
            Error::input(match there[..] {
                [] => format!("returns no \"{wish}\", as its result has no members"),
                _ => format!("returns no \"{wish}\"; there are {}", there.join(", ")),
            })
        })?,
        None if returns == 1 => 0,
        None if returns == 0 && names.len() == 1 => 0,
        None if names.is_empty() => {
            return Err(Error::input("does not return f32 or vec3f, nor anything that has one in it"));
        }
        None => {
            return Err(Error::input(format!(
                "returns several values; say by the result which is the BRDF: {}",
                names.join(", ")
            )));
        }
    };
    Ok(candidates.swap_remove(place).1)
}

/// Collects the values of a type that could be a BRDF's: scalars, vectors of three and the rgb of four.
fn values(
    module: &Module,
    ty: Handle<Type>,
    argument: Option<usize>,
    path: String,
    depth: usize,
    out: &mut Vec<(String, ShaderResult)>,
) {
    // An argument's own name is no part of the access.
    let access = match argument {
        Some(_) => path[1..].find('.').map_or(String::new(), |dot| path[1 + dot..].to_owned()),
        None => path.clone(),
    };
    let mut push = |rgb: &str, channels| {
        let access = format!("{access}{rgb}");
        out.push((path.clone(), ShaderResult { argument, access, channels }));
    };
    match &module.types[ty].inner {
        TypeInner::Scalar(scalar) if scalar.kind == ScalarKind::Float => push("", 1),
        TypeInner::Vector { size: VectorSize::Tri, scalar } if scalar.kind == ScalarKind::Float => {
            push("", 3)
        }
        TypeInner::Vector { size: VectorSize::Quad, scalar } if scalar.kind == ScalarKind::Float => {
            push(".xyz", 3)
        }
        TypeInner::Struct { members, .. } if depth < 16 => {
            for member in members {
                let name = member.name.as_deref().unwrap_or("_");
                values(module, member.ty, argument, format!("{path}.{name}"), depth + 1, out);
            }
        }
        _ => {}
    }
}

/// A type in WGSL.
pub(super) fn type_name(module: &Module, ty: Handle<Type>) -> Result<String> {
    let scalar = |scalar| NumberType::new(scalar).map(NumberType::name);
    let unnamed = || Error::input("a type without a name");
    let ty = &module.types[ty];
    match (&ty.inner, &ty.name) {
        (TypeInner::Scalar(s), _) => scalar(*s).map(str::to_owned).ok_or_else(unnamed),
        (TypeInner::Vector { size, scalar: s }, _) => {
            scalar(*s).map(|s| format!("vec{}<{s}>", *size as u8)).ok_or_else(unnamed)
        }
        (TypeInner::Matrix { columns, rows, scalar: s }, _) => {
            let s = scalar(*s).filter(|&s| s == "f32").ok_or_else(unnamed)?;
            Ok(format!("mat{}x{}<{s}>", *columns as u8, *rows as u8))
        }
        (TypeInner::Array { base, size: naga::ArraySize::Constant(count), .. }, _) => {
            Ok(format!("array<{}, {count}>", type_name(module, *base)?))
        }
        (TypeInner::Pointer { base, .. }, _) => Ok(format!("ptr<function, {}>", type_name(module, *base)?)),
        (_, Some(name)) => Ok(name.clone()),
        _ => Err(unnamed()),
    }
}

/// A function's arguments and result, in WGSL.
pub(super) fn show(module: &Module, function: &Function) -> String {
    let name = |ty| type_name(module, ty).unwrap_or_else(|_| "…".into());
    let arguments = function.arguments.iter();
    let arguments = arguments.map(|a| format!("{}: {}", a.name.as_deref().unwrap_or("_"), name(a.ty)));
    let arguments: Vec<_> = arguments.collect();
    let result = function.result.as_ref().map_or(String::new(), |result| format!(" -> {}", name(result.ty)));
    format!("({}){result}", arguments.join(", "))
}
