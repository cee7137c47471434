//! Writes the compute shader that calls a user's function at lists of directions.

use super::roles::{FrameVector, Role, RoleKind};
use super::signature::{Input, NumberType, ShaderParameter, Signature};
use crate::base::error::{Error, Result};
use std::fmt::Write;
use std::str::FromStr;

/// The axis of a shader's frame that is the normal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum UpAxis {
    /// +x.
    X,
    /// +y.
    Y,
    /// +z.
    #[default]
    Z,
}

impl FromStr for UpAxis {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        match text {
            "x" => Ok(Self::X),
            "y" => Ok(Self::Y),
            "z" => Ok(Self::Z),
            _ => Err(Error::input(format!("\"{text}\" is no axis; give x, y or z"))),
        }
    }
}

impl UpAxis {
    /// A vector of our frame, whose normal is +z, in the shader's. The frame is turned, not mirrored.
    pub fn turned<T>(self, [x, y, z]: [T; 3]) -> [T; 3] {
        match self {
            Self::X => [z, x, y],
            Self::Y => [y, z, x],
            Self::Z => [x, y, z],
        }
    }
}

pub(super) const WORKGROUP: usize = 64;

/// Floats for each pair: ωi and ωi · h, ωo and ωi · ωo, h and a blank.
pub(super) const STRIDE: usize = 12;

/// What a value is where the loops took more turns than every driver runs: a NaN that no arithmetic makes.
pub(super) const CUT: u32 = 0xffc0_71ee;

/// Appends the compute shader to the user's code, in which the function is called `call`. Returns the name of the variable that
/// counts turns, too: above `certain` the value is [`CUT`].
pub(super) fn compose(
    code: &str,
    call: &str,
    signature: &Signature,
    up: UpAxis,
    group: u32,
    certain: u32,
) -> (String, String) {
    // The prefix must not occur in the user's source.
    let mut prefix = String::from("gonio");
    while code.contains(&prefix) {
        prefix += "_x";
    }
    let writer = Writer { prefix: &prefix, parameters: &signature.parameters, up };
    let mut body = String::new();
    let mut line = |text: String| {
        let _ = writeln!(body, "    {text}");
    };
    for (name, input) in &signature.globals {
        line(format!("{name} = {};", writer.value(input)));
    }
    let mut arguments = Vec::new();
    for (k, argument) in signature.arguments.iter().enumerate() {
        let value = writer.value(&argument.input);
        if argument.pointer {
            line(format!("var {prefix}_argument{k} = {value};"));
            arguments.push(format!("&{prefix}_argument{k}"));
        } else {
            arguments.push(value);
        }
    }
    let result = &signature.result;
    let call = format!("{call}({})", arguments.join(", "));
    let value = match result.argument {
        Some(k) => {
            line(format!("{call};"));
            format!("{prefix}_argument{k}{}", result.access)
        }
        None => {
            line(format!("let {prefix}_result = {call};"));
            format!("{prefix}_result{}", result.access)
        }
    };
    match result.channels {
        1 => line(format!("{prefix}_values[{prefix}_k] = f32({value});")),
        _ => {
            line(format!("let {prefix}_f = vec3<f32>({value});"));
            (0..3).for_each(|c| line(format!("{prefix}_values[3u * {prefix}_k + {c}u] = {prefix}_f[{c}];")));
        }
    }
    let vectors = vectors(signature.parameters.len());
    let channels = result.channels;
    let text = format!(
        "{code}
struct {prefix}_Job {{ setting: array<vec4<u32>, {vectors}>, count: u32, cut: u32 }}
var<private> {prefix}_turns: u32;
@group({group}) @binding(0) var<uniform> {prefix}_job: {prefix}_Job;
@group({group}) @binding(1) var<storage, read> {prefix}_pairs: array<vec4<f32>>;
@group({group}) @binding(2) var<storage, read_write> {prefix}_values: array<f32>;
@compute @workgroup_size({WORKGROUP})
fn {prefix}_main(@builtin(global_invocation_id) {prefix}_id: vec3<u32>) {{
    let {prefix}_k = {prefix}_id.x;
    if ({prefix}_k >= {prefix}_job.count) {{ return; }}
    let {prefix}_wi = {prefix}_pairs[3u * {prefix}_k];
    let {prefix}_wo = {prefix}_pairs[3u * {prefix}_k + 1u];
    let {prefix}_h = {prefix}_pairs[3u * {prefix}_k + 2u];
{body}
    if ({prefix}_turns > {certain}u) {{ {prefix}_values[{channels}u * {prefix}_k] = bitcast<f32>({prefix}_job.cut); }}
}}
"
    );
    (text, format!("{prefix}_turns"))
}

/// Vectors of four that hold a setting.
fn vectors(parameters: usize) -> usize {
    parameters.div_ceil(4).max(1)
}

/// The bits of a setting and a count, as the shader reads them.
pub(super) fn job(parameters: &[ShaderParameter], setting: &[f64], count: usize) -> Vec<u8> {
    let word = |(parameter, &value): (&ShaderParameter, &f64)| match parameter.number {
        NumberType::F32 | NumberType::F16 => (value as f32).to_bits(),
        NumberType::I32 => value as i32 as u32,
        NumberType::U32 => value as u32,
        NumberType::Bool => u32::from(value != 0.0),
    };
    let mut words: Vec<u32> = parameters.iter().zip(setting).map(word).collect();
    words.resize(4 * vectors(parameters.len()), 0);
    words.extend([count as u32, CUT, 0, 0]);
    bytemuck::cast_slice(&words).to_vec()
}

struct Writer<'a> {
    prefix: &'a str,
    parameters: &'a [ShaderParameter],
    up: UpAxis,
}

impl Writer<'_> {
    /// The expression that makes a value.
    fn value(&self, input: &Input) -> String {
        match input {
            Input::Role { role, number } => self.role(*role, *number),
            Input::Parameter(k) => {
                let word = format!("{}_job.setting[{}][{}]", self.prefix, k / 4, k % 4);
                match self.parameters[*k].number {
                    NumberType::F32 => format!("bitcast<f32>({word})"),
                    NumberType::F16 => format!("f16(bitcast<f32>({word}))"),
                    NumberType::I32 => format!("bitcast<i32>({word})"),
                    NumberType::U32 => word,
                    NumberType::Bool => format!("({word} != 0u)"),
                }
            }
            Input::Composite { constructor, parts } => {
                let parts: Vec<_> = parts.iter().map(|part| self.value(part)).collect();
                format!("{constructor}({})", parts.join(", "))
            }
        }
    }

    fn role(&self, role: Role, number: NumberType) -> String {
        let sign = if role.negative { "-" } else { "" };
        let name = number.name();
        match role.kind {
            RoleKind::Vector(vector) => {
                let components = self.up.turned(self.components(vector));
                format!("({sign}vec3<{name}>({}))", components.map(|c| format!("{name}({c})")).join(", "))
            }
            RoleKind::Cosine(a, b) => format!("{name}({sign}({}))", self.cosine(a, b)),
        }
    }

    /// The components of a vector in our frame.
    fn components(&self, vector: FrameVector) -> [String; 3] {
        let of = |name: &str| ["x", "y", "z"].map(|axis| format!("{}_{name}.{axis}", self.prefix));
        let axis = |values: [&str; 3]| values.map(str::to_owned);
        match vector {
            FrameVector::Light => of("wi"),
            FrameVector::View => of("wo"),
            FrameVector::Half => of("h"),
            FrameVector::Tangent => axis(["1.0", "0.0", "0.0"]),
            FrameVector::Bitangent => axis(["0.0", "1.0", "0.0"]),
            FrameVector::Normal => axis(["0.0", "0.0", "1.0"]),
            FrameVector::Reflection => {
                let [x, y, z] = of("wo");
                [format!("-{x}"), format!("-{y}"), z]
            }
        }
    }

    /// The cosine between two vectors.
    fn cosine(&self, a: FrameVector, b: FrameVector) -> String {
        use FrameVector::*;
        let prefix = self.prefix;
        let axis = |vector| match vector {
            Tangent => Some(0),
            Bitangent => Some(1),
            Normal => Some(2),
            _ => None,
        };
        match (a, b) {
            _ if axis(a).is_some() => self.components(b)[axis(a).unwrap_or(2)].clone(),
            _ if axis(b).is_some() => self.components(a)[axis(b).unwrap_or(2)].clone(),
            (Light, View) | (View, Light) => format!("{prefix}_wo.w"),
            (Light | View, Half) | (Half, Light | View) => format!("{prefix}_wi.w"),
            _ => format!(
                "dot(vec3<f32>({}), vec3<f32>({}))",
                self.components(a).join(", "),
                self.components(b).join(", ")
            ),
        }
    }
}
